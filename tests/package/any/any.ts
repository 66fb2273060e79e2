// Any scenes and options: what several tests of properties draw from.
import type { CagecastError, project, transfer } from 'cagecast';
import fc from 'fast-check';

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
  });
});

export const share = fc.double({ min: 0, max: 1, noNaN: true });
export const validOptions = fc.record(
  {
    preset: fc.constantFrom('default' as const, 'paper' as const),
    threshold: share,
    minCovered: share,
    seams: fc.constantFrom('vertex' as const, 'corner' as const),
    weldTolerance: share.map((value) => value / 100),
    pokeThrough: share.map((value) => value / 100),
    steps: fc.record(
      {
        interiorSamples: fc.boolean(),
        recheck: fc.boolean(),
        holes: fc.boolean(),
        floor: fc.boolean(),
      },
      { requiredKeys: [] },
    ),
  },
  { requiredKeys: [] },
);

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
