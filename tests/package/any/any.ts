// Any scenes and options: what several tests of properties draw from.
import type { CagecastError, project, TransferOptions, transfer } from 'cagecast';
import fc from 'fast-check';
import { readOptions } from '../../../wasm/tools/options-list.mjs';

const { CAGECAST_RUNS = 150, CAGECAST_SEED = 1 } = process.env;
/** CAGECAST_SEED and CAGECAST_RUNS try others, and more of them. */
export const runs = { numRuns: Number(CAGECAST_RUNS), seed: Number(CAGECAST_SEED) };

/** Mostly on a grid, where coincidences are frequent. */
const coordinate = fc.oneof(
  { weight: 8, arbitrary: fc.integer({ min: -32, max: 32 }).map((value) => value / 16) },
  { weight: 1, arbitrary: fc.float({ noNaN: true, min: -1000, max: 1000 }) },
);

/** A mesh with nothing wrong in it. */
export const mesh = fc.integer({ min: 3, max: 14 }).chain((vertices) => {
  const numbers = (count: number) => fc.array(coordinate, { minLength: count, maxLength: count });
  return fc.record({
    positions: numbers(3 * vertices).map((all) => Float32Array.from(all)),
    uvs: numbers(2 * vertices).map((all) => Float32Array.from(all)),
    indices: fc
      .array(fc.integer({ min: 0, max: vertices - 1 }), { minLength: 3, maxLength: 60 })
      .map((all) => Uint32Array.from(all.slice(0, all.length - (all.length % 3)))),
    groups: fc.option(
      fc
        .array(fc.integer({ min: 0, max: 2 }), { minLength: vertices, maxLength: vertices })
        .map((all) => Uint32Array.from(all)),
      { nil: undefined },
    ),
    poses: fc.option(
      fc
        .integer({ min: 1, max: 2 })
        .chain((poses) => numbers(3 * vertices * poses).map((all) => Float32Array.from(all))),
      { nil: undefined },
    ),
  });
});

const share = fc.double({ min: 0, max: 1, noNaN: true });

/** Any value of an option's range. Lengths are mostly short. */
function anyValueOf({ kind, range }: ReturnType<typeof readOptions>[number]): fc.Arbitrary<unknown> {
  if (kind === 'toggle' || kind === 'choice') return fc.constantFrom(...range);
  const [low, high] = range as [number, number];
  const most = kind === 'length' ? Math.min(0.1, high) : high;
  const some = share.map((part) => low + part * (most - low));
  return fc.oneof({ weight: 8, arbitrary: some }, { weight: 1, arbitrary: fc.constant(high) });
}

/** Any values of some of the options of options.def that are, or are not, in `steps`, and of some stages. */
const anyValues = (isStep: boolean, stages = ['project', 'classify']): Record<string, fc.Arbitrary<unknown>> =>
  Object.fromEntries(
    readOptions('.')
      .filter((option) => option.isStep === isStep && stages.includes(option.stage))
      .map((option) => [option.name, anyValueOf(option)]),
  );
const some = <T>(values: Record<string, fc.Arbitrary<unknown>>) =>
  fc.record(values, { requiredKeys: [] }) as fc.Arbitrary<T>;

/** Options of `transfer`, each of which may be left out. */
export const validOptions = some<TransferOptions>({
  preset: fc.constantFrom('default', 'paper'),
  ...anyValues(false),
  steps: some(anyValues(true)),
});

/** The options of one stage: of `project`, or of `classify`. */
export function ofStage(stage: 'project' | 'classify', { steps = {}, ...options }: TransferOptions): object {
  const pick = (isStep: boolean, values: object) => {
    const names = Object.keys(anyValues(isStep, [stage]));
    return Object.fromEntries(Object.entries(values).filter(([name]) => names.includes(name)));
  };
  return { ...(options.preset && { preset: options.preset }), ...pick(false, options), steps: pick(true, steps) };
}

/** The result of a call in which nothing can be wrong but a cage that is flat. */
export function resultOf<T>(call: () => T): T | undefined {
  try {
    return call();
  } catch (error) {
    if ((error as CagecastError).code !== 'noUsableCageTriangle') throw error;
    return undefined;
  }
}

/** All of an answer that does not depend on the clock, or on what calls before it left of memory. */
export const plain = ({
  timings: _,
  peakBytes: __,
  ...rest
}: ReturnType<typeof transfer> | ReturnType<typeof project>) => rest;
