// The functions of `cagecast/cages` on the thread that calls them. Their memory is freed once the event loop turns.
import createModule from '#cages-glue';
import { checkNames, type Mesh } from '../api/mesh.js';
import { kPartLists } from '../api/option-names.js';
import { checkParts, type PartNames } from '../api/parts.js';
import { CagecastError, type Code, isRecord, show } from '../core/error.js';
import {
  failureOf,
  givenModule,
  type InitOptions,
  instantiate,
  notInitialised,
  unsupported,
} from '../core/instantiate.js';
import { type Answer, nameOf, type PartNumbers } from '../core/module.js';
import { compileFile } from '../core/read-file.js';
import type { CageAnswer, CagesModule, CoreLandmark, CoreOptions, CoreTemplate } from './cages-module.js';
import {
  checkHoles,
  checkLandmarks,
  checkModel,
  checkOptions,
  checkOrder,
  checkRegions,
  checkTemplate,
  joinedNames,
} from './check-arguments.js';
import type {
  Cage,
  CageModel,
  Fit,
  FitOptions,
  FoundLandmarks,
  Kind,
  Landmarks,
  MakeOptions,
  RefineOptions,
  Template,
} from './types.js';

/** An option of every call. */
export interface SyncOptions {
  /**
   * Gets many times a second how far the call is: a share 0..1 that never falls, and what it does. On a model of a million triangles
   * or on the finest grid, seconds may pass between two calls. If it returns `false`, the call is cancelled: it throws `aborted`.
   */
  onProgress?: ((share: number, stage: string) => unknown) | undefined;
}

let starting: Promise<void> | undefined;
let compiled: WebAssembly.Module | undefined;
/** An instance for the next call, which shows that the host can run it. */
let first: CagesModule | undefined;

/**
 * Loads the WebAssembly module, `cagecast-cages.wasm`. All calls share it, and the options of the first count.
 * @throws {CagecastError} `unsupported`, `badOption`
 */
export function init(): Promise<void>; // such as for `.then(init)`
export function init(options: InitOptions): Promise<void>;
export function init(options: InitOptions = {}): Promise<void> {
  starting ??= start(options).catch((cause: unknown) => {
    starting = undefined;
    throw unsupported(cause);
  });
  return starting;
}

async function start(options: InitOptions): Promise<void> {
  // The build inserts the file name as a literal, so that bundlers find the file.
  const module = await (givenModule(options) ?? compileFile(new URL(CAGECAST_WASM, import.meta.url)));
  first = make(module);
  compiled = module;
}

/** As `makeCage` of `cagecast/cages`. Needs `init`. */
export function makeCage(model: CageModel, options: MakeOptions & SyncOptions = {}): Cage {
  return call(options, {
    fn: 'makeCage',
    defaults: 'makeOptions',
    run: (module, core, report, parts) => module.makeCage(checkModel('makeCage', model), core, parts, report),
    names: model?.names ?? [],
    result: (answer, module, parts) => cageOf(module, answer, { holes: {}, bare: bareNames(module, model, parts) }),
  });
}

/** As `fitCage` of `cagecast/cages`. Needs `init`. */
export function fitCage(
  template: Template,
  model: CageModel,
  landmarks?: Landmarks,
  options: FitOptions & SyncOptions = {},
): Fit {
  checkOrder(landmarks);
  const kept = {
    holes: checkHoles('fitCage', 'template.holes', template?.holes),
    regions: checkRegions('fitCage', 'template.regions', template?.regions),
  };
  return call(options, {
    fn: 'fitCage',
    names: model?.names ?? [],
    run: (module, _, report, parts) =>
      module.fitCage(
        checkTemplate('fitCage', 'template', module, template),
        checkModel('fitCage', model),
        checkLandmarks('fitCage', 'landmarks', landmarks),
        parts,
        report,
      ),
    result: (answer, module, parts) => ({
      cage: cageOf(
        module,
        { ...answer, landmarks: answer.landmarks.filter(({ name }) => !answer.guessed.includes(name)) },
        {
          regions: kept.regions,
          holes: withoutClosed(kept.holes, answer.closed),
          bare: bareNames(module, model, parts, answer.bare),
        },
      ),
      used: landmarksOf(answer.landmarks),
      confidence: confidenceOf(answer.landmarks),
      missing: answer.missing,
      guessed: answer.guessed,
    }),
  });
}

/** As `findLandmarks` of `cagecast/cages`. Needs `init`. */
export function findLandmarks(model: CageModel, options: SyncOptions = {}): FoundLandmarks {
  return call(options, {
    fn: 'findLandmarks',
    run: (module, _, report) => module.findLandmarks(checkModel('findLandmarks', model), report),
    result: (answer, module) => ({
      landmarks: landmarksOf(answer.landmarks),
      confidence: confidenceOf(answer.landmarks),
      missing: answer.missing,
      rig: answer.rig,
      kind: kindOf(module, answer.kind),
    }),
  });
}

/** As `refineCage` of `cagecast/cages`. Needs `init`. */
export function refineCage(
  cage: Mesh | Cage | Template,
  model: CageModel,
  options: RefineOptions & SyncOptions = {},
): Cage {
  const from = cage as Partial<Template> | undefined;
  const kept = {
    holes: checkHoles('refineCage', 'cage.holes', from?.holes),
    regions: checkRegions('refineCage', 'cage.regions', from?.regions),
    bare: (cage as Partial<Cage> | undefined)?.bare,
  };
  let given: CoreTemplate;
  return call(options, {
    fn: 'refineCage',
    defaults: 'refineOptions',
    run: (module, core, report) => {
      given = checkTemplate('refineCage', 'cage', module, cage);
      return module.refineCage(given.mesh, checkModel('refineCage', model), core, report);
    },
    // Landmarks are spots of the model, which does not move.
    result: (answer, module) => ({
      ...cageOf(module, answer, kept),
      landmarks: landmarksOf(given.landmarks),
      kind: kindOf(module, given.kind),
    }),
  });
}

/**
 * Whether parts of these names are excluded if nothing is said of them: eyes, teeth, tongues, hair and glasses; of vehicles windows, wheels,
 * lights and the interior. Needs `init`.
 * @param names  As those of a `Mesh`.
 * @throws {CagecastError} `badArgument`
 */
export function excludedByName(names: PartNames): boolean[] {
  const fn = 'excludedByName';
  checkNames(fn, 'names', names);
  return freshModule(fn).excludedByName(joinedNames(names));
}

function freshModule(fn: string): CagesModule {
  if (compiled === undefined) throw notInitialised(fn);
  try {
    return first ?? make(compiled);
  } catch (cause) {
    throw failureOf(fn, cause);
  } finally {
    first = undefined;
  }
}

const make = (module: WebAssembly.Module): CagesModule => instantiate<CagesModule>(createModule, module, 'makeCage');

interface Call<Of extends Answer, Result> {
  fn: string;
  /** The function that returns the options of this one. */
  defaults?: 'makeOptions' | 'refineOptions';
  /** The names of the model's parts, if the function takes `parts`. */
  names?: PartNames;
  run(module: CagesModule, options: CoreOptions, report: Report, parts: PartNumbers): Of;
  result(answer: Of, module: CagesModule, parts: PartNumbers): Result;
}

/** The code of an error that is about an argument. */
const kCodes: Record<string, Code> = {
  model: 'badModel',
  template: 'badTemplate',
  cage: 'badTemplate',
  landmarks: 'badLandmarks',
  options: 'badOption',
};

/**
 * Calls a function in an instance of the module that is not used again: its memory may grow by hundreds of megabytes, and never
 * shrinks.
 */
function call<Of extends Answer, Result>(given: SyncOptions, of: Call<Of, Result>): Result {
  const { fn } = of;
  if (!isRecord(given)) throw new CagecastError('badOption', fn, `options is ${show(given)}, not an object`);
  const { onProgress, ...rest } = given;
  const { parts: lists, ...numbers } = rest as { parts?: unknown };
  const parts = of.names
    ? checkParts(fn, lists, kPartLists, of.names, (reason) => new CagecastError('badOption', fn, reason))
    : {};
  const module = freshModule(fn);
  const options = checkOptions(
    fn,
    module,
    of.defaults ? module[of.defaults]() : {},
    of.names ? numbers : rest,
    of.names ? ['parts'] : [],
  );
  const reporter = new Reporter(onProgress);
  let answer: Of;
  try {
    answer = of.run(module, options, reporter.report, parts);
  } catch (cause) {
    if (cause instanceof CagecastError) throw cause;
    throw failureOf(fn, cause);
  }
  if (reporter.failure !== undefined) throw reporter.failure;
  const { code, message, argument, at } = answer.status;
  if (code !== 'ok')
    throw new CagecastError(
      kCodes[argument] ?? (code as Code),
      fn,
      code === 'aborted' ? 'cancelled by onProgress' : message,
      { argument, at },
    );
  reporter.end();
  return of.result(answer, module, parts);
}

type Report = (share: number, stage: string) => boolean;

/** Tells a caller how far a call is. */
class Reporter {
  /** What the caller's function threw: it must not be thrown through C++. */
  failure: unknown;
  readonly #tell: SyncOptions['onProgress'];
  #most = 0;
  #stage = '';

  constructor(tell: SyncOptions['onProgress']) {
    this.#tell = tell;
  }

  readonly report: Report = (share, stage) => {
    this.#most = Math.min(1, Math.max(this.#most, share));
    this.#stage = stage;
    try {
      return this.#tell?.(this.#most, stage) !== false;
    } catch (error) {
      this.failure = error;
      return false;
    }
  };

  /** The call has succeeded. */
  end(): void {
    if (this.#most < 1) this.#tell?.(1, this.#stage);
  }
}

const kindOf = (module: CagesModule, kind: unknown): Kind => nameOf({ module: module as never }, 'Kind', kind) as Kind;

const landmarksOf = (landmarks: readonly CoreLandmark[]): Landmarks =>
  Object.fromEntries(landmarks.map(({ name, position }) => [name, position]));
const confidenceOf = (landmarks: readonly CoreLandmark[]): Record<string, number> =>
  Object.fromEntries(landmarks.map(({ name, confidence }) => [name, confidence]));

/**
 * The names that only excluded parts of a model have; nothing if there are none.
 * @param beside  Further parts that stay bare unless they are kept.
 */
function bareNames(
  module: CagesModule,
  { names = [] }: CageModel,
  { keep, exclude }: PartNumbers,
  beside: readonly number[] = [],
): string[] | undefined {
  const isExcluded = module
    .excludedByName(joinedNames(names))
    .map((is, p) => !keep?.includes(p) && (is || exclude?.includes(p) === true || beside.includes(p)));
  const those = (fits: boolean) => names.flatMap((own, p) => (isExcluded[p] === fits ? own : []));
  const others = new Set(those(false));
  const bare = [...new Set(those(true))].filter((name) => name !== '' && !others.has(name));
  return bare.length > 0 ? bare : undefined;
}

/** @param closed  Vertices on borders of holes that were closed. */
const withoutClosed = (holes: Cage['holes'], closed: readonly number[]): Cage['holes'] =>
  Object.fromEntries(Object.entries(holes).filter(([, loop]) => !loop.every((v) => closed.includes(v))));

/** @param kept  Of the cage that was moved, if one was: vertices keep their numbers and UVs. */
function cageOf(module: CagesModule, answer: CageAnswer, kept: Pick<Cage, 'holes' | 'regions' | 'bare'>): Cage {
  const { positions, uvs, indices, landmarks, kind } = answer;
  const { holes, regions, bare } = kept;
  return {
    ...{ positions, uvs, indices, landmarks: landmarksOf(landmarks), holes, kind: kindOf(module, kind) },
    ...(regions && { regions }),
    ...(bare && { bare }),
  };
}
