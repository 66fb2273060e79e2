import { classify, type PresetOptions, presetOptions, project, type TransferOptions, transfer, Zone } from 'cagecast';
import { type ConfidenceClass, confidenceOf } from './confidence.js';
import type { Model } from './models.js';
import {
  type Decision,
  type PictureScore,
  pictureScore,
  type Score,
  type Smear,
  score,
  shifted,
  smear,
} from './score.js';
import { visiblePixels } from './visible.js';

/** The ways that are compared, each with the steps of the one before it. */
export const kMethodNames = ['naive', 'step 2', 'step 3', 'paper', 'default'] as const;
export type MethodName = (typeof kMethodNames)[number];

/** What is found out about one model. */
export interface Quality {
  kind: Model['kind'];
  triangles: number;
  methods: Record<MethodName, Score & PictureScore>;
  /** `default`, by threshold. */
  thresholds: Record<string, Score>;
  /** `default` without a step, by the step's option. */
  without: Record<string, Score>;
  /** `default` with the cage moved by 1 % of the diagonal, by axis and sign. */
  shifted: Record<string, Score>;
  smear: Smear;
  /** Verdicts by their confidence, for each distance by which the cage is moved. */
  confidence: ConfidenceClass[][];
}

export const kThresholds: readonly number[] = [1, 2, 3, 4, 5, 6, 7, 8, 9].map((tenths) => tenths / 10);
/** How far the cage is moved, as a share of the target's diagonal. */
export const kShift = 0.01;

/** Measures a model. `init` the package before. */
export function measure(model: Model): Quality {
  const { scene, truth } = model;
  const { cage, target } = scene;
  const pixels = visiblePixels(target);
  const scoreOf = ({ zones }: Decision): Score => score(target, truth, zones);
  const decisions = decide(scene);
  const projection = project(cage, target);
  const named = <T>(entries: [string, T][]): Record<string, T> => Object.fromEntries(entries);
  return {
    kind: model.kind,
    triangles: target.indices.length / 3,
    methods: named(
      kMethodNames.map((name) => [
        name,
        { ...scoreOf(decisions[name]), ...pictureScore(model, pixels, decisions[name]) },
      ]),
    ) as Quality['methods'],
    thresholds: named(
      kThresholds.map((threshold) => [threshold.toFixed(1), scoreOf(classify(projection, { threshold }))]),
    ),
    without: named(withoutEachStep(scene).map(([step, decision]) => [step, scoreOf(decision)])),
    shifted: named(
      [0, 1, 2].flatMap((axis) =>
        [1, -1].map((sign): [string, Score] => {
          const there = shifted(scene, axis, sign * kShift);
          return [`${sign > 0 ? '+' : '−'}${'xyz'[axis]}`, scoreOf(transfer(there.cage, there.target))];
        }),
      ),
    ),
    smear: smear(scene, transfer(cage, target)),
    confidence: confidenceOf(model),
  };
}

/**
 * Transfers in each of the ways: everything painted (`naive`), without what the target occludes (`step 2`), without what the
 * cage does not cover either (`step 3`), and by the two presets.
 */
function decide({ cage, target }: Model['scene']): Record<MethodName, Decision> {
  const { visibility } = project(cage, target, { preset: 'paper' });
  // As the poster has it: a triangle is painted if its three corners are.
  const only = (...ncz: number[]): Decision => {
    const isPainted = (t: number): boolean =>
      [0, 1, 2].every((k) => !ncz.includes(visibility[target.indices[3 * t + k]!]!));
    return {
      zones: visibility.map((found) => (ncz.includes(found) ? found : Zone.Cosmetic)),
      cosmeticTriangles: Uint8Array.from({ length: target.indices.length / 3 }, (_, t) => +isPainted(t)),
    };
  };
  return {
    naive: only(),
    'step 2': only(Zone.Occluded),
    'step 3': only(Zone.Occluded, Zone.Uncovered),
    paper: transfer(cage, target, { preset: 'paper' }),
    default: transfer(cage, target),
  };
}

/** `default` with each of its steps left out: `groups` welds across parts, and every option in which the presets differ is as in `paper`. */
function withoutEachStep({ cage, target }: Model['scene']): [step: string, Decision][] {
  const { groups: _, ...whole } = target;
  const [paper, ours] = [presetOptions('paper'), presetOptions('default')];
  const differing = <O extends object>(a: O, b: O): (keyof O)[] =>
    (Object.keys(b) as (keyof O)[]).filter((name) => typeof b[name] !== 'object' && a[name] !== b[name]);
  // `seams` is about UVs, not zones.
  const names = differing<PresetOptions>(paper, ours).filter((name) => name !== 'seams');
  const variants: [string, TransferOptions][] = [
    ...names.map((name): [string, TransferOptions] => [name, { [name]: paper[name] }]),
    ...differing(paper.steps, ours.steps).map((name): [string, TransferOptions] => [
      name,
      { steps: { [name]: paper.steps[name] } },
    ]),
  ];
  return [
    ['groups', transfer(cage, whole)],
    ...variants.map(([name, options]): [string, Decision] => [name, transfer(cage, target, options)]),
  ];
}
