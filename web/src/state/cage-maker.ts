import type { Cage, CageModel, Landmarks, MakeOptions, TemplateName } from 'cagecast/cages';
import type { Bone } from 'three';
import { cageModel, Emitter, likelyTemplate } from '#three';
import { carriedBy, type Fitting, kMaxAsked, madeOf, noteMade, readable, sampleOf } from './made-cages';
import { type Loader, type Model, originOf } from './model';
import { haveSameUvs } from './same-uvs';
import type { Session } from './session';
import { type Box, boxOf, diagonalOfBox } from './surface';
import { reasonOf } from './wording';

/** The engine that makes cages: `cagecast/cages`. It loads when it is asked for. */
export type Engine = Pick<
  typeof import('cagecast/cages'),
  'cageGlb' | 'chooseCage' | 'fitCage' | 'loadTemplate' | 'makeCage' | 'refineCage' | 'templateNames'
>;

/** What a cage maker needs of the page. */
interface Workshop {
  session: Session;
  loader: Loader;
  engine(): Promise<Engine>;
  /** Says a sentence to people. */
  announce(sentence: string): void;
}

/** How a choice goes on. */
interface ChoiceProgress {
  signal: AbortSignal;
  onProgress(share: number, step: string): void;
}

/** What the page shows of the cage on the stage. */
interface CageNotes {
  /** How it was made; empty if it was not made here. */
  note: string;
  /** Which landmarks were not found. */
  missing: string;
}

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
  inspect: 'Looking at the fit',
};

/**
 * Makes a cage for a model that has none, or fits a template to it. `fitting` says with each cage whether it is a fit, and which
 * landmarks that has; `notes` says what there is to say of the cage; `template` says which template a new target likely needs.
 */
export class CageMaker extends Emitter<{
  fitting: Fitting | undefined;
  notes: Partial<CageNotes>;
  template: TemplateName;
}> {
  readonly #workshop: Workshop;
  readonly #session: Session;
  readonly #unmoved = new WeakSet<Model>();
  readonly #turned = new WeakSet<Model>();
  /** The user's choices for made cages: options, and parts to leave bare. */
  choices: ((model: CageModel) => { options: MakeOptions; marks?: Uint8Array }) | undefined;
  /** Lets the user mark on the model what stays bare. */
  markBare: (() => void) | undefined;
  /** What the last fit that was asked for here came to. */
  latest: Fitting | undefined;
  #opening: AbortController | undefined;

  constructor(workshop: Workshop) {
    super();
    const { session } = workshop;
    this.#workshop = workshop;
    this.#session = session;
    let shown: { target?: Model; cage?: Model } = {};
    session.on('progress', ({ state }) => void (state !== 'working' && this.#opening?.abort()));
    session.on('transfer', ({ target, cage }) => {
      if (target !== shown.target) this.emit('template', likelyTemplate(target.mesh.positions, namesIn(target)));
      shown = { target, cage };
      this.emit('notes', { note: madeOf(cage.files[0]!)?.note ?? '', missing: '' });
      this.emit('fitting', this.isOthers ? undefined : madeOf(cage.files[0]!)?.fitting);
    });
    // Of a good cage, nobody needs to know what was not found.
    session.on('inspected', ({ verdict, findings }) => {
      if (findings.some(({ code }) => code === 'cageBackward')) void this.#turnBack();
      const missing = (verdict !== 'good' && madeOf(session.shown!.cage.files[0]!)?.fitting?.missing) || [];
      const names = missing.map(readable).join(', ');
      this.emit('notes', { missing: names && `Landmarks that were not found: ${names}.` });
    });
  }

  /** Whether the current cage stayed where it was when it was to be moved into place. */
  get refusedToMove(): boolean {
    return this.#unmoved.has(this.#session.shown!.cage);
  }

  /** Whether the current cage belongs to another model. */
  get isOthers(): boolean {
    const { target, cage } = this.#session.shown!;
    if (cage.sample) return cage.sample !== target.sample;
    const own = madeOf(cage.files[0]!);
    return own !== undefined && own.target !== target.files[0];
  }

  /** Whether the current cage was made for the current target, and is no fit. */
  get isMade(): boolean {
    const own = madeOf(this.#session.shown!.cage.files[0]!);
    return own !== undefined && !own.fitting && !this.isOthers;
  }

  /** Whether the current cage is as it was made, or fitted, for the current target: it is where it belongs. */
  get isFresh(): boolean {
    return madeOf(this.#session.shown!.cage.files[0]!)?.isNew === true && !this.isOthers;
  }

  /** Makes a cage for the current target. */
  make(): Promise<void> {
    return this.#run('Making a cage', this.#make);
  }

  /**
   * Fits a template to the current target.
   * @param given    Landmarks of the target; they override those that are found.
   */
  fit(template: TemplateName, given: Landmarks = {}): Promise<void> {
    return this.#run('Fitting a template', (context) => this.#fit(context, template, given));
  }

  /** Fits the template that the current target likely needs. */
  fitLikely(): Promise<void> {
    const { target } = this.#session.shown!;
    return this.fit(likelyTemplate(target.mesh.positions, namesIn(target)));
  }

  /** The template that the current cage is a fit of; undefined for others. */
  async template(): Promise<TemplateName | undefined> {
    const { cage } = this.#session.shown!;
    const own = madeOf(cage.files[0]!);
    if (!own || own.fitting || this.isOthers) return this.isOthers ? undefined : own?.fitting?.template;
    // One that came with its model.
    const { loadTemplate, templateNames } = await this.#workshop.engine();
    const templates = await Promise.all(templateNames.map(async (name) => ({ name, mesh: await loadTemplate(name) })));
    return templates.find((one) => haveSameUvs(one, cage))?.name;
  }

  /**
   * The cage of a model that is opened alone, as `chooseCage` chooses it. Another call, or the end of the request, ends it.
   * @param template Fits this one instead.
   * @throws Error that names the model.
   */
  async cageFor(target: Model, template?: TemplateName): Promise<Model> {
    const abort = new AbortController();
    this.#opening?.abort();
    this.#opening = abort;
    const onProgress = (share: number, step: string): void =>
      this.#session.reportLoading(kStages[step] ?? 'Fitting a cage', share);
    try {
      return await this.choose(target, { signal: abort.signal, onProgress }, template);
    } catch (error) {
      throw new Error(`${target.name}: ${reasonOf(error)}`, { cause: error });
    } finally {
      if (this.#opening === abort) this.#opening = undefined;
    }
  }

  /**
   * The cage of any model: the one that it has with it, else as `chooseCage` chooses it.
   * @param target    As its file has it.
   * @param template  As of `cageFor`.
   */
  async choose(target: Model, progress: ChoiceProgress, template?: TemplateName): Promise<Model> {
    const { cage: own } = carriedBy(target.files[0]!);
    if (own) {
      noteMade(own, { target: target.files[0]!, isNew: true, note: kOwn, fitting: undefined });
      return this.#workshop.loader.load(own);
    }
    const engine = await this.#workshop.engine();
    const model = await cageModel(target.loaded);
    const { options, marks } = this.#choicesFor(model, target);
    const { cage, fit, ...chosen } = template
      ? await fitOf(engine, model, template, progress)
      : await engine.chooseCage({ ...model, marks }, { ...options, ...progress });
    const how =
      fit && chosen.template !== 'made'
        ? { note: kFitted, fitting: { ...fit, template: chosen.template, given: {} } }
        : { note: noteOfMade(cage), fitting: undefined };
    const file = new File([engine.cageGlb({ ...cage, origin: originOf(target) })], cageNameFrom(target.name));
    noteMade(file, { target: target.files[0]!, isNew: true, ...how });
    return this.#workshop.loader.load(file);
  }

  /** Moves, turns and scales the current cage onto the target, and bends it where it is inside. */
  move(): Promise<void> {
    return this.#run('Moving the cage', this.#move);
  }

  /** Reads a model again, as its file has it. */
  read({ files: [file, ...rest] }: Model): Promise<Model> {
    return this.#workshop.loader.load(file!, rest);
  }

  /** Shows a cage that was made for the current target, unless another target is being loaded. */
  show(cage: Promise<Model>): void {
    if (this.#session.keepTarget()) this.#session.request({ cage });
  }

  /** Shows the current cage with other positions or triangles. @returns It. */
  async change(change: { positions?: Float32Array; indices?: Uint32Array }): Promise<Model> {
    const { target, cage: current } = this.#session.shown!;
    const { cageGlb } = await this.#workshop.engine();
    const { positions, rest = positions, indices, uvs = new Float32Array() } = current.mesh;
    const bytes = cageGlb({
      ...extrasOf(current),
      ...({ positions: rest, indices, uvs, ...change } as Cage),
      origin: originOf(current),
    });
    const file = new File([bytes], cageNameFrom(current.name));
    const fitting = madeOf(current.files[0]!)?.fitting;
    const note = 'The cage was changed. Save it if it is right.';
    noteMade(file, { target: target.files[0]!, fitting, sample: sampleOf(current), note });
    const cage = this.#workshop.loader.load(file);
    this.show(cage);
    return cage;
  }

  /** Turns triangles of the current cage to the other side. */
  flip(triangles: readonly number[]): Promise<void> {
    return this.#run('Turning triangles', async ({ old }) => {
      const indices = old.indices.slice();
      for (const t of triangles) [indices[3 * t + 1], indices[3 * t + 2]] = [indices[3 * t + 2]!, indices[3 * t + 1]!];
      return { cage: { ...old, indices }, note: `${triangles.length} triangles of the cage were turned.` };
    });
  }

  /** Turns the current cage by half, as it faces the other way than the target; once, as it may be turned back by hand. */
  #turnBack(): Promise<void> | undefined {
    const { cage } = this.#session.shown!;
    if (this.#turned.has(cage)) return undefined;
    this.#turned.add(cage);
    return this.#run('Turning the cage', async ({ old }) => {
      const positions = old.positions.map((x, i) => (i % 3 === 1 ? x : 0 - x));
      return {
        cage: { ...old, positions },
        note: 'The cage faced the other way, so it was turned by half. Save it so.',
      };
    });
  }

  /** Does cancellable work on the current target, and shows the cage that it comes to; not while another target is being loaded. */
  async #run(title: string, work: (context: Context) => Promise<Result>): Promise<void> {
    if (!this.#session.keepTarget()) return this.#workshop.announce('Another model is being loaded.');
    const { target, cage: current } = this.#session.shown!;
    const abort = new AbortController();
    const making = { abort: () => abort.abort(), makesCage: true };
    const report = (stage: string, share: number): unknown => this.#session.work(stage, share, making);
    report(title, 0);
    try {
      const [engine, read] = await Promise.all([
        this.#workshop.engine(),
        // The model on the stage may be deformed.
        this.read(target),
      ]);
      if (abort.signal.aborted) return;
      const onProgress = (share: number, step: string): unknown => report(kStages[step] ?? title, share);
      const options = { signal: abort.signal, onProgress };
      const { positions, rest = positions, indices, uvs = new Float32Array() } = current.mesh;
      const old = {
        ...{ holes: {}, kind: 'automatic', landmarks: {}, ...extrasOf(current) },
        ...(this.isOthers && { landmarks: {} }),
        ...{ positions: rest.slice(), indices: indices.slice(), uvs: uvs.slice() },
      } as Cage;
      const model = await cageModel(read.loaded);
      if (abort.signal.aborted) return;
      const result = await work.call(this, { engine, model, old, options, target });
      if (abort.signal.aborted) return;
      const { cage, note, fitting, isNew } = result;
      const isChanged = cage.uvs === old.uvs;
      const file = new File(
        [engine.cageGlb({ ...cage, origin: originOf(target) })],
        cageNameFrom((isChanged ? current : target).name),
      );
      const sample = isChanged ? sampleOf(current) : undefined;
      noteMade(file, { target: target.files[0]!, fitting, sample, note, isNew });
      this.latest = fitting;
      this.show(this.#workshop.loader.load(file));
    } catch (error) {
      if (abort.signal.aborted) return;
      this.#session.fail(new Error(`${target.name}: ${reasonOf(error)}`, { cause: error }));
    }
  }

  async #make({ engine, model, options, target }: Omit<Context, 'old'>): Promise<Result> {
    const { options: chosen, marks } = this.#choicesFor(model, target);
    const cage = await engine.makeCage({ ...model, marks }, { ...chosen, ...options });
    return { cage, note: noteOfMade(cage), isNew: true };
  }

  /** The options of a made cage, and its marks: triangles marked on the model stay bare, whatever is chosen for their part. */
  #choicesFor(model: CageModel, target: Model): { options: MakeOptions; marks: Uint8Array | undefined } {
    const { options = {}, marks: parts } = this.choices?.(model) ?? {};
    const bare = this.#session.bareOf(target.files);
    return { options, marks: bare && parts ? parts.map((mark, t) => mark | bare[t]!) : (bare ?? parts) };
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
        `the cage ${current.name} cannot be moved into place: no place was found where it fits better. Make a cage`,
      );
    }
    return { cage: { ...cage, uvs: old.uvs }, note: 'The cage was moved into place. Save it if it is right.' };
  }

  async #fit({ engine, model, options }: Omit<Context, 'old'>, name: TemplateName, given: Landmarks): Promise<Result> {
    const { cage, ...found } = await engine.fitCage(await engine.loadTemplate(name), model, given, options);
    const note =
      found.guessed.length > 0
        ? `Too little was found to fit the template by, so it was placed by the model’s size: mark ${found.guessed.slice(0, kMaxAsked).map(readable).join(', ')}.`
        : kFitted;
    return { cage, note, fitting: { ...found, template: name, given }, isNew: true };
  }
}

/** A fit as `chooseCage` returns one. */
async function fitOf(engine: Engine, model: CageModel, template: TemplateName, progress: ChoiceProgress) {
  const fit = await engine.fitCage(await engine.loadTemplate(template), model, {}, progress);
  return { cage: fit.cage, fit, template };
}

const kOwn = 'The model came with this cage, and its paint.';
/** What is said of a fit. */
const kFitted = 'The template was fitted: a paint for it fits every model that it was fitted to.';

const noteOfMade = (cage: Cage): string =>
  `A cage of ${cage.indices.length / 3} triangles was made. Save it with the paint that you draw for it.`;

/** The names in a model: those of its bones, its meshes and their materials. */
function namesIn({ scene, mesh }: Model): { joints: string[]; parts: string[] } {
  const joints: string[] = [];
  scene.traverse((object) => void ((object as Bone).isBone && joints.push(object.name)));
  const parts = mesh.primitives.flatMap(({ name, mesh }) => [name, ...[mesh.material].flat().map(({ name }) => name)]);
  return { joints, parts };
}

/** The name of a cage's file, from that of a model or of an earlier cage. */
const cageNameFrom = (name: string): string =>
  name.replace(/(^cage|-cage|)(\.\w+)?$/, (_, ending: string) => `${ending || '-cage'}.glb`);

/** What the file of a cage says of it besides its mesh. */
function extrasOf({ scene }: Model): Partial<Cage> {
  const extras: Partial<Cage> = {};
  scene.traverse(({ userData }) => void (userData.landmarks && Object.assign(extras, userData)));
  return extras;
}

/** A cage that is nowhere near the model is put around it first, as large as the model. */
export function placeAround(cage: Cage, model: ArrayLike<number>): Cage {
  const [from, to] = [boxOf(cage.positions), boxOf(model)];
  const apart = from.low.some((low, axis) => low > to.high[axis]! || from.high[axis]! < to.low[axis]!);
  const scale = diagonalOfBox(to) / diagonalOfBox(from);
  if (!apart && scale > 0.5 && scale < 2) return cage;
  const middle = ({ low, high }: Box, axis: number): number => (low[axis]! + high[axis]!) / 2;
  const positions = cage.positions.map((value, i) => middle(to, i % 3) + 1.05 * scale * (value - middle(from, i % 3)));
  return { ...cage, positions };
}

interface Context {
  engine: Engine;
  model: CageModel;
  /** What the model was read from. */
  target: Model;
  /** The current cage, undeformed. */
  old: Cage;
  options: { signal: AbortSignal; onProgress(share: number, step: string): void };
}

interface Result {
  cage: Cage;
  /** What was made, for people. */
  note: string;
  /** If it is a fit. */
  fitting?: Fitting;
  /** Whether it was made from the model alone. */
  isNew?: boolean;
}
