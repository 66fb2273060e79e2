import { presetOptions, project, transfer } from 'cagecast';
import { bent, resized } from '../resize.js';
import {
  atThresholds,
  type Decision,
  decide,
  latencies,
  type MethodName,
  methodNames,
  withoutEachStep,
} from './methods.js';
import type { Model } from './models.js';
import { measureSegments, type Score, type SegmentMeasure, type Smear, score, shifted, smear } from './score.js';
import { visiblePixels } from './visible.js';

/** What is found out about one model. */
export interface Quality {
  kind: Model['kind'];
  triangles: number;
  methods: Record<MethodName, Score & { vertices: ZoneCounts }>;
  /** By threshold. */
  thresholds: Record<'paper' | 'default', Record<string, Score>>;
  /** `default` without a step, by the step's option. */
  without: Record<string, Score>;
  /** `default` with the cage moved by 1 % of the diagonal, by axis and sign. */
  shifted: Record<string, Score>;
  smear: Smear;
  /** Most memory that a transfer uses beyond cage and target, in bytes. */
  peakBytes: Record<'paper' | 'default', number>;
  segments: SegmentMeasure[];
}

/** How many vertices are of each zone. */
export type ZoneCounts = Record<'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;

export const thresholds: readonly number[] = [1, 2, 3, 4, 5, 6, 7, 8, 9].map((tenths) => tenths / 10);
/** How far the cage is moved, as a share of the target's diagonal. */
export const shift = 0.01;

/** Measures all but times. `init` the package before. */
export async function measure(model: Model): Promise<Quality> {
  const { scene } = model;
  const { cage, target } = scene;
  const pixels = visiblePixels(target);
  const scoreOf = (decision: Decision): Score => score(model, pixels, decision);
  const scores = (some: [string, Decision][]): Record<string, Score> =>
    Object.fromEntries(some.map(([name, decision]) => [name, scoreOf(decision)]));
  const decisions = decide(scene);
  const moved = [0, 1, 2].flatMap((axis) =>
    [1, -1].map((sign): [string, Decision] => {
      const there = shifted(scene, axis, sign * shift);
      return [`${sign > 0 ? '+' : '−'}${'xyz'[axis]}`, transfer(there.cage, there.target)];
    }),
  );
  const result = transfer(cage, target);
  const methods = methodNames.map((name) => [
    name,
    { ...scoreOf(decisions[name]), vertices: countZones(decisions[name]) },
  ]);
  return {
    kind: model.kind,
    triangles: target.indices.length / 3,
    methods: Object.fromEntries(methods) as Quality['methods'],
    thresholds: {
      paper: scores(atThresholds(project(cage, target, { preset: 'paper' }), thresholds)),
      default: scores(atThresholds(project(cage, target), thresholds)),
    },
    without: scores(withoutEachStep(scene)),
    shifted: scores(moved),
    smear: await smear(scene, result),
    peakBytes: { paper: transfer(cage, target, { preset: 'paper' }).peakBytes, default: result.peakBytes },
    segments: measureSegments(model, result, presetOptions('default')),
  };
}

function countZones({ zones }: Decision): ZoneCounts {
  const counts = [0, 0, 0, 0];
  for (const zone of zones) ++counts[zone]!;
  const [cosmetic = 0, occluded = 0, uncovered = 0, culled = 0] = counts;
  return { cosmetic, occluded, uncovered, culled };
}

/** Milliseconds that each method takes. @param runs  How often it is timed. */
export function measureTimes({ scene }: Model, runs: number): Record<MethodName, number> {
  return latencies(scene, runs);
}

/** About so many triangles has the model that says how the methods scale. */
export const largeTriangles = 500_000;

/** The same for a model whose target is cut into `largeTriangles` and bent a little, under its cage. */
export async function measureLargeTimes({ scene }: Model, runs: number): Promise<Record<MethodName, number>> {
  return latencies(bent({ cage: scene.cage, target: await resized(scene.target, largeTriangles) }, 0.002), runs);
}
