import type { LinkedShape } from '../export/link';
import { announce, element } from '../platform/page';
import type { ExtractedMesh } from '../scene/extract';
import type { Session, Shown } from '../scene/session';
import { Superseded, TransferClient } from '../scene/transfer-client';
import type { Viewer } from '../view/viewer';
import { Animations } from './animations';
import { type Deform, kDeforms } from './deform';
import { Morphs } from './morphs';
import { isAtRest, Pose, type Shape } from './pose';

const kSeconds = 4; // there and back, of what moves by itself

/**
 * Moves the model and transfers it again for every frame: the paint follows, whatever becomes of the shape. A new frame
 * is begun when the one before is on show, so that a slow device shows fewer of them, and none too late.
 */
export class Live {
  readonly #session: Session;
  /** Busy while frames are under way. */
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
  /** Whether what is on show, or went before it, is not as its file has it. */
  #moved = false;
  #stale = false;
  #started: number | undefined;

  constructor(session: Session, viewer: Viewer | undefined) {
    this.#session = session;
    this.#deform.replaceChildren(...kDeforms.map((name) => new Option(name[0]!.toUpperCase() + name.slice(1), name)));
    this.#amount.addEventListener('input', () => {
      this.#stop();
      this.#next();
    });
    for (const input of [this.#deform, this.#along]) input.addEventListener('change', () => this.#next());
    this.#moves.addEventListener('change', () => (this.#moves.checked ? this.#start() : this.#stop()));
    // An animation may move the same morphs: it is the one or the other.
    this.#morphs = new Morphs(() => {
      this.#animations?.stop();
      this.#next();
    });
    this.#animations = viewer && new Animations(viewer, () => this.#leaveMorphs());
    session.on('transfer', (shown) => this.#onTransfer(shown));
  }

  /** The shape the visitor moved the model into; undefined while it is as its file has it. */
  get shape(): LinkedShape | undefined {
    const [amount, morphs] = [Number(this.#amount.value), this.#morphs.weights];
    if (amount === 0 && !morphs) return undefined;
    return { deform: this.#deform.value as Deform, amount, cage: this.#along.checked, morphs: this.#morphs.moved };
  }

  /** Moves the model into a shape. */
  move({ deform, amount, cage, morphs }: LinkedShape): void {
    this.#stop();
    this.#deform.value = deform;
    this.#amount.value = String(amount);
    this.#along.checked = cage;
    if (morphs.size > 0) {
      this.#animations?.stop();
      this.#morphs.move(morphs);
    }
    this.#next();
  }

  #onTransfer(shown: Shown): void {
    const before = this.#shown;
    this.#shown = shown;
    if (shown.target === before?.target && shown.cage === before.cage) return; // another preset, of what is moved as it is
    if (shown.target !== before?.target) {
      this.#stop();
      this.#amount.value = '0';
      this.#showFrame(0);
      this.#morphs.offer(shown.target.mesh);
      this.#animations?.offer(shown.target.animations);
    }
    // The one that stays is to go where the other is.
    if (this.#moved) this.#next();
  }

  #leaveMorphs(): void {
    if (!this.#morphs.weights) return;
    this.#morphs.reset();
    this.#next();
  }

  #start(): void {
    this.#started = performance.now();
    announce('The model moves, and is transferred anew for every frame.');
    this.#next();
  }

  #stop(): void {
    this.#started = undefined;
    this.#moves.checked = false;
  }

  /** Asks for another frame; while one is under way, for one more after it. */
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
        // A page in the background has no frames, and needs none.
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
    const shape: Shape = { how: this.#deform.value as Deform, amount, room: target.room, morphs: this.#morphs.weights };
    const cageShape: Shape = { ...shape, amount: this.#along.checked ? amount : 0, morphs: undefined };
    const [targetPositions, cagePositions] = [target.positions(shape), cage.positions(cageShape)];
    const moved = <T extends Shown['target']>(model: T, positions: Float32Array): T => ({
      ...model,
      mesh: { ...model.mesh, positions },
    });
    this.#client ??= new TransferClient();
    const { preset } = this.#session.rules;
    const projection = await this.#client.ask(
      'project',
      moved(shown.cage, cagePositions),
      moved(shown.target, targetPositions),
      { preset },
    );
    // Something else may be on show by now.
    if (this.#shown !== shown || preset !== this.#session.rules.preset) return;
    target.set(targetPositions, shape);
    cage.set(cagePositions, cageShape);
    this.#moved = !isAtRest(shape);
    this.#session.showFrame(projection, this.#moved);
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
