import type { Cage, Fit, TemplateName } from 'cagecast/cages';
import type { WebGLRenderer } from 'three';
import { download } from '../platform/download';
import { element } from '../platform/page';
import { loadModel, type Model } from './load-model';
import type { Session } from './session';

/** What the steps of the engine are called for people. */
const kStages: Record<string, string> = {
  hull: 'Wrapping the model',
  simplify: 'Simplifying the cage',
  holes: 'Cutting holes',
  unwrap: 'Unwrapping the cage',
  landmarks: 'Finding landmarks',
  fit: 'Fitting the template',
  enclose: 'Enclosing the model',
  align: 'Moving the cage',
  bend: 'Bending the cage',
};

/** The files of cages that were made here, and the landmarks that were not found for them. */
const made = new WeakMap<File, readonly string[]>();

/** A landmark's name for people: "ear_lobe_left" is the left ear lobe. */
const readable = (landmark: string): string =>
  landmark
    .replace(/^(.*)_(left|right)$/, '$2 $1')
    .replace(/^(.*?)joint_(.*)$/, '$1$2 joint')
    .replaceAll('_', ' ');

/**
 * Makes a cage for a model that has none, or fits a template to it, and saves the result. The engine and the templates load when
 * they are asked for.
 */
export class CageMaker {
  readonly #session: Session;
  readonly #renderer: WebGLRenderer | undefined;
  readonly #template = element('template-select', HTMLSelectElement);
  readonly #note = element('cage-note', HTMLElement);
  readonly #missing = element('cage-missing', HTMLElement);
  readonly #save = element('save-cage', HTMLButtonElement);
  readonly #unmoved = new WeakSet<Model>();

  /** @param renderer Undefined without WebGL. */
  constructor(session: Session, renderer: WebGLRenderer | undefined) {
    this.#session = session;
    this.#renderer = renderer;
    element('make-cage', HTMLButtonElement).addEventListener('click', () => this.make());
    element('fit-cage', HTMLButtonElement).addEventListener('click', () => this.#run('Fitting a template', this.#fit));
    this.#save.addEventListener('click', () => {
      const [file] = session.shown!.cage.files;
      download(file!, file!.name);
    });
    session.on('transfer', ({ target, cage }) => {
      element('no-cage', HTMLElement).hidden = target.sample !== undefined;
      const isMade = made.has(cage.files[0]!);
      this.#save.hidden = !isMade;
      if (!isMade) this.#note.textContent = '';
      this.#missing.textContent = '';
    });
    // Of a good cage, nobody needs to know what was not found.
    session.on('inspected', ({ verdict }) => {
      const file = session.shown!.cage.files[0]!;
      const missing = (verdict !== 'good' && made.get(file)) || [];
      this.#missing.textContent =
        missing.length > 0 ? `Landmarks that were not found: ${missing.map(readable).join(', ')}.` : '';
    });
  }

  /** Whether the current cage stayed where it was when it was to be moved into place. */
  get refusedToMove(): boolean {
    return this.#unmoved.has(this.#session.shown!.cage);
  }

  /** Makes a cage for the current target. */
  make(): Promise<void> {
    return this.#run('Making a cage', this.#make);
  }

  /** Moves, turns and scales the current cage onto the target, and bends it where it is inside. */
  move(): Promise<void> {
    return this.#run('Moving the cage', this.#move);
  }

  /** Turns triangles of the current cage to the other side. */
  flip(triangles: readonly number[]): Promise<void> {
    return this.#run('Turning triangles', async ({ old }) => {
      const indices = old.indices.slice();
      for (const t of triangles) [indices[3 * t + 1], indices[3 * t + 2]] = [indices[3 * t + 2]!, indices[3 * t + 1]!];
      return { cage: { ...old, indices }, note: `${triangles.length} triangles of the cage were turned.` };
    });
  }

  /** Does cancellable work on the current target, and shows the cage that it comes to. */
  async #run(title: string, work: (context: Context) => Promise<Result>): Promise<void> {
    const { target, cage: current } = this.#session.shown!;
    const abort = new AbortController();
    const giveUp = (): void => abort.abort();
    const tell = (stage: string, share: number): unknown => this.#session.work(stage, share, giveUp);
    const done = this.#session.work(title, 0, giveUp);
    try {
      const [engine, { cageModel }, read] = await Promise.all([
        import('cagecast/cages'),
        import('cagecast/three'),
        // The model on the stage may be deformed.
        loadModel(target.files[0]!, this.#renderer, target.files.slice(1)),
      ]);
      if (abort.signal.aborted) return;
      const onProgress = (share: number, step: string): unknown => tell(kStages[step] ?? title, share);
      const options = { signal: abort.signal, onProgress };
      const { positions, rest = positions, indices, uvs = new Float32Array() } = current.mesh;
      const old = { ...kNoName, positions: rest.slice(), indices: indices.slice(), uvs: uvs.slice() } as Cage;
      const {
        cage,
        note,
        missing = [],
      } = await work.call(this, { engine, model: cageModel(read.loaded), old, options });
      if (abort.signal.aborted) return;
      const name = cage.uvs === old.uvs ? current.name : target.name;
      const file = new File([engine.cageGlb(cage)], name.replace(/(-cage)?(\.\w+)?$/, '-cage.glb'));
      made.set(file, missing);
      this.#note.textContent = note;
      done();
      this.#session.want({ cage: loadModel(file, this.#renderer) });
    } catch (error) {
      if (abort.signal.aborted) return;
      const message = (error as Error).message.replace(/^\w+: /, '');
      this.#session.fail(new Error(`${target.name}: ${message}`, { cause: error }));
    }
  }

  async #make({ engine, model, options }: Context): Promise<Result> {
    const cage = await engine.makeCage(model, options);
    return {
      cage,
      note: `A cage of ${cage.indices.length / 3} triangles was made. Save it with the paint that you draw for it.`,
    };
  }

  async #move({ engine, model, old, options }: Context): Promise<Result> {
    const current = this.#session.shown!.cage;
    const placed = placeAround(old, model.positions);
    const cage = await engine.refineCage(placed, model, { ...options, reach: 0.2 }).catch((error: Error) => {
      if (options.signal.aborted) throw error;
      return placed;
    });
    if (cage.positions.every((value, i) => value === old.positions[i])) {
      this.#unmoved.add(current);
      this.#session.setRules({}); // its remedies are no longer offered
      throw new Error(
        `the cage ${current.name} cannot be moved into place: it was made for another model. Make a cage`,
      );
    }
    return { cage: { ...cage, uvs: old.uvs }, note: 'The cage was moved into place. Save it if it is right.' };
  }

  async #fit({ engine, model, options }: Context): Promise<Result> {
    const template = await engine.loadTemplate(this.#template.value as TemplateName);
    const { cage, missing }: Fit = await engine.fitCage(template, model, undefined, options);
    return { cage, note: 'The template was fitted: a paint for it fits every model that it was fitted to.', missing };
  }
}

const kNoName = { landmarks: {}, holes: {}, kind: 'automatic' } as const;

/** A cage that is nowhere near the model is put around it first, as large as the model. */
function placeAround(cage: Cage, model: ArrayLike<number>): Cage {
  const [from, to] = [boxOf(cage.positions), boxOf(model)];
  const apart = from.low.some((low, axis) => low > to.high[axis]! || from.high[axis]! < to.low[axis]!);
  const scale = diagonal(to) / diagonal(from);
  if (!apart && scale > 0.5 && scale < 2) return cage;
  const middle = ({ low, high }: Box, axis: number): number => (low[axis]! + high[axis]!) / 2;
  const positions = cage.positions.map((value, i) => middle(to, i % 3) + 1.05 * scale * (value - middle(from, i % 3)));
  return { ...cage, positions };
}

interface Box {
  low: number[];
  high: number[];
}

function boxOf(positions: ArrayLike<number>): Box {
  const box: Box = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  for (let i = 0; i < positions.length; i++) {
    box.low[i % 3] = Math.min(box.low[i % 3]!, positions[i]!);
    box.high[i % 3] = Math.max(box.high[i % 3]!, positions[i]!);
  }
  return box;
}

const diagonal = ({ low, high }: Box): number => Math.hypot(...high.map((value, axis) => value - low[axis]!));

interface Context {
  engine: typeof import('cagecast/cages');
  model: ReturnType<typeof import('cagecast/three').cageModel>;
  /** The current cage, undeformed. */
  old: Cage;
  options: { signal: AbortSignal; onProgress(share: number, step: string): void };
}

interface Result {
  cage: Cage;
  /** What was made, for people. */
  note: string;
  /** Landmarks of the template that were not found. */
  missing?: readonly string[];
}
