import type { PresetOptions, Projection, Timings, TransferOptions } from 'cagecast';
import { classify, presetOptions, project, transfer, Zone } from 'cagecast';
import type { Scene } from '../scene-file.js';
import { median } from '../statistics.js';

/** What a way to transfer paints. */
export interface Decision {
  /** 1 per vertex, a `Zone`. */
  zones: Uint8Array;
  /** 1 per triangle: 1 if it is painted. */
  cosmeticTriangles: Uint8Array;
}

/** The ways that are compared, each with the steps of the one before it. */
export const methodNames = ['naive', 'step 2', 'step 3', 'paper', 'default'] as const;
export type MethodName = (typeof methodNames)[number];

/**
 * Transfers in each of the ways: everything painted (`naive`), without what the target occludes (`step 2`), without what the
 * cage does not cover either (`step 3`), and by the two presets.
 */
export function decide({ cage, target }: Scene): Record<MethodName, Decision> {
  const { zones } = project(cage, target, { preset: 'paper' });
  const only = (...ncz: number[]): Decision =>
    wholeTriangles(
      zones.map((zone) => (ncz.includes(zone) ? zone : Zone.Cosmetic)),
      target.indices,
    );
  return {
    naive: only(),
    'step 2': only(Zone.Occluded),
    'step 3': only(Zone.Occluded, Zone.Uncovered),
    paper: transfer(cage, target, { preset: 'paper' }),
    default: transfer(cage, target),
  };
}

/** As the poster has it: a triangle is painted if its three corners are. */
function wholeTriangles(zones: Uint8Array, indices: Uint32Array): Decision {
  const isPainted = (t: number): boolean => [0, 1, 2].every((k) => zones[indices[3 * t + k]!] === Zone.Cosmetic);
  return { zones, cosmeticTriangles: Uint8Array.from({ length: indices.length / 3 }, (_, t) => +isPainted(t)) };
}

/** Decides anew by other thresholds. */
export function atThresholds(projection: Projection, thresholds: readonly number[]): [threshold: string, Decision][] {
  return thresholds.map((threshold) => [threshold.toFixed(1), classify(projection, { threshold })]);
}

/**
 * The preset `default` with each of its steps left out: `groups` welds across parts, `depth` measures the floor as it was at
 * first, and every option in which the presets differ is as in `paper`.
 */
export function withoutEachStep({ cage, target }: Scene): [step: string, Decision][] {
  const { groups: _, ...whole } = target;
  const [paper, ours] = [presetOptions('paper'), presetOptions('default')];
  type Single = Exclude<keyof PresetOptions, 'steps'>;
  // `seams` is about UVs, not zones.
  const names = (Object.keys(ours) as (keyof PresetOptions)[]).filter(
    (name): name is Single => name !== 'steps' && name !== 'seams' && paper[name] !== ours[name],
  );
  const steps = (Object.keys(ours.steps) as (keyof PresetOptions['steps'])[]).filter(
    (name) => paper.steps[name] !== ours.steps[name],
  );
  return [
    ['groups', transfer(cage, whole)],
    ['depth', transfer(cage, target, { steps: { floor: 'area' } })],
    ...names.map((name): [string, Decision] => [
      name,
      transfer(cage, target, { [name]: paper[name] } as TransferOptions),
    ]),
    ...steps.map((name): [string, Decision] => [
      name,
      transfer(cage, target, { steps: { [name]: paper.steps[name] } }),
    ]),
  ];
}

/**
 * Milliseconds that each way takes with the package in this process: CPU time, on which other work on the machine does not
 * tell, the median of runs in turns, after warming up. The first three are the first steps of `paper`, by their shares of its
 * time: weld, trees and nearest points; with the self rays; with the cage rays as well.
 */
export function latencies({ cage, target }: Scene, runs: number): Record<MethodName, number> {
  const warmUp = Math.ceil(runs / 2); // until the engine has optimised the WebAssembly
  const times: Record<'paper' | 'default', number[]> = { paper: [], default: [] };
  const timings: Timings[] = [];
  for (let run = -warmUp; run < runs; ++run) {
    for (const preset of ['paper', 'default'] as const) {
      const began = process.cpuUsage();
      const result = transfer(cage, target, { preset });
      const { user, system } = process.cpuUsage(began);
      if (run < 0) continue;
      times[preset].push((user + system) / 1e3);
      if (preset === 'paper') timings.push(result.timings);
    }
  }
  const paper = median(times.paper);
  // By step, because a short one is seldom interrupted.
  const wall = (...steps: (keyof Timings)[]): number =>
    steps.reduce((sum, step) => sum + median(timings.map((one) => one[step])), 0);
  const until = [['weld', 'build', 'project'], ['occluded'], ['covered'], ['segments', 'classify']] as const;
  const spent = until.map((steps) => wall(...steps));
  const share = (count: number): number =>
    spent.slice(0, count).reduce((sum, ms) => sum + ms, 0) / spent.reduce((sum, ms) => sum + ms, 0);
  return {
    naive: paper * share(1),
    'step 2': paper * share(2),
    'step 3': paper * share(3),
    paper,
    default: median(times.default),
  };
}
