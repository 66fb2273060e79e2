import { TransferClient } from '../../loading/transfer-client';
import { announce, element } from '../../platform/page';
import { type ChosenShape, type Deform, kDeforms } from '../../state/deform';
import { withoutParts } from '../../state/left-out';
import type { ExtractedMesh } from '../../state/model';
import type { Shown } from '../../state/scene';
import type { Session } from '../../state/session';
import { Superseded } from '../../state/transfers';
import type { Viewer } from '../../view/viewer';
import { Animations } from './animations';
import { expressionsOf } from './expressions';
import { Morphs } from './morphs';
import { isAtRest, Pose, type Shape } from './pose';

const kSeconds = 4; // period of “Animate”

/**
 * Deforms the model and repeats the transfer for every frame, so that the paint follows. A frame starts when the previous one
 * is shown: a slow device shows fewer frames, but no outdated ones.
 */
export class Live {
  readonly #session: Session;
  /** `aria-busy` while frames are computed. */
  readonly #section = element('live', HTMLElement);
  readonly #deform = element('deform', HTMLSelectElement);
  readonly #amount = element('amount', HTMLInputElement);
  readonly #moves = element('deform-moves', HTMLInputElement);
  readonly #along = element('deform-cage', HTMLInputElement);
  readonly #morphs: Morphs;
  readonly #animations: Animations | undefined;
  #client: TransferClient | undefined;
  #shown: Shown | undefined;
  readonly #poses = new WeakMap<ExtractedMesh, Pose>();
  /** Whether the current model, or the one before it, is not in its rest shape. */
  #moved = false;
  #stale = false;
  #started: number | undefined;
  /** The amount when “Animate” started. */
  #still = 0;

  constructor(session: Session, viewer: Viewer | undefined) {
    this.#session = session;
    this.#deform.replaceChildren(...kDeforms.map((name) => new Option(name[0]!.toUpperCase() + name.slice(1), name)));
    this.#amount.addEventListener('input', () => {
      this.#stop();
      this.#next();
    });
    for (const input of [this.#deform, this.#along]) input.addEventListener('change', () => this.#next());
    this.#moves.addEventListener('change', () => (this.#moves.checked ? this.#start() : this.#stop()));
    // An animation may drive morphs, too: they exclude each other.
    this.#morphs = new Morphs(() => {
      this.#animations?.leaveMorphs();
      this.#next();
    });
    this.#animations = viewer && new Animations(viewer.stage, () => this.#leaveMorphs());
    session.on('transfer', (shown) => this.#onTransfer(shown));
  }

  /** The shape chosen by the user; while “Animate” moves it, the one before. */
  get shape(): ChosenShape {
    const amount = this.#started === undefined ? Number(this.#amount.value) : this.#still;
    return { deform: this.#deform.value as Deform, amount, cage: this.#along.checked, morphs: this.#morphs.moved };
  }

  /** Sets the shape. */
  move({ deform, amount, cage, morphs }: ChosenShape): void {
    this.#stop();
    this.#deform.value = deform;
    this.#amount.value = String(amount);
    this.#along.checked = cage;
    this.#morphs.reset();
    if (morphs.size > 0) {
      this.#animations?.leaveMorphs();
      this.#morphs.move(morphs);
    }
    this.#next();
  }

  #onTransfer(shown: Shown): void {
    const before = this.#shown;
    this.#shown = shown;
    if (shown.target === before?.target && shown.cage === before.cage) return; // only the rules changed
    if (shown.target !== before?.target) {
      this.#stop();
      this.#amount.value = '0';
      this.#showFrame(0);
      this.#morphs.offer(shown.target.mesh, expressionsOf(shown.target.loaded, shown.target.mesh));
      this.#animations?.offer(shown.target.animations);
    }
    // Deform the new one like the old.
    if (this.#moved) this.#next();
  }

  #leaveMorphs(): void {
    if (!this.#morphs.weights) return;
    this.#morphs.reset();
    this.#next();
  }

  #start(): void {
    this.#still = Number(this.#amount.value);
    this.#started = performance.now();
    announce('The model moves; the transfer is repeated for every frame.');
    this.#next();
  }

  #stop(): void {
    this.#started = undefined;
    this.#moves.checked = false;
  }

  /** Requests a frame; if one is being computed, another one follows it. */
  #next(): void {
    this.#stale = true;
    if (this.#section.ariaBusy !== 'true') void this.#run();
  }

  async #run(): Promise<void> {
    this.#section.ariaBusy = 'true';
    try {
      while (this.#stale && this.#shown) {
        this.#stale = this.#started !== undefined;
        await this.#frame(this.#shown);
        // Pauses while the page is in the background.
        await new Promise(requestAnimationFrame);
      }
    } catch (error) {
      if (!(error instanceof Superseded)) this.#session.fail(error);
      this.#stop();
    } finally {
      this.#section.ariaBusy = 'false';
    }
  }

  async #frame(shown: Shown): Promise<void> {
    if (this.#started !== undefined) {
      const phase = Math.sin(((performance.now() - this.#started) / 1000) * ((2 * Math.PI) / kSeconds));
      this.#amount.value = phase.toFixed(2);
    }
    const [target, cage] = [this.#poseOf(shown.target), this.#poseOf(shown.cage)];
    const amount = Number(this.#amount.value);
    const shape: Shape = {
      how: this.#deform.value as Deform,
      amount,
      extent: target.extent,
      morphs: this.#morphs.weights,
    };
    const cageShape: Shape = { ...shape, amount: this.#along.checked ? amount : 0, morphs: undefined };
    const [targetPositions, cagePositions] = [target.positions(shape), cage.positions(cageShape)];
    const moved = <T extends Shown['target']>(model: T, positions: Float32Array): T => ({
      ...model,
      mesh: { ...model.mesh, positions },
    });
    this.#client ??= new TransferClient();
    const { preset, weldTolerance } = this.#session.rules;
    const { leftOut } = shown.projection;
    const projection = await this.#client.ask(
      'project',
      moved(shown.cage, cagePositions),
      withoutParts(moved(shown.target, targetPositions), shown.projection),
      { preset, weldTolerance },
    );
    // Another model or other rules may have been chosen meanwhile.
    const { rules } = this.#session;
    if (this.#shown !== shown || preset !== rules.preset || weldTolerance !== rules.weldTolerance) return;
    target.set(targetPositions, shape);
    cage.set(cagePositions, cageShape);
    this.#moved = !isAtRest(shape);
    this.#session.showFrame({ ...projection, weldTolerance, leftOut }, this.#moved);
    this.#showFrame(amount, projection.timings.total);
  }

  #poseOf({ mesh }: Shown['target']): Pose {
    const pose = this.#poses.get(mesh) ?? new Pose(mesh);
    this.#poses.set(mesh, pose);
    return pose;
  }

  #showFrame(amount: number, milliseconds?: number): void {
    element('frame-time', HTMLElement).textContent =
      milliseconds === undefined ? '–' : milliseconds.toFixed(milliseconds < 10 ? 2 : 1);
    element('amount-value', HTMLOutputElement).value = amount.toFixed(2);
  }
}
