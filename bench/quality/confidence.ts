import { type Mesh, transfer } from 'cagecast';
import { vertexAreas } from '../../wasm/src/inspect/geometry.js';
import { percent } from '../percent.js';
import { table } from '../table.js';
import type { Model, Truth } from './models.js';
import { shifted } from './score.js';

/** Verdicts on segments whose confidence is in a range, and how many of them are wrong. */
export interface ConfidenceClass {
  /** The range begins here, and ends where that of the next class begins. */
  from: number;
  verdicts: number;
  wrong: number;
}

/** How far cages are moved, as shares of the target's diagonal, along each axis, both ways. */
export const kShifts: readonly number[] = [0, 0.005, 0.01, 0.02];
const kClasses: readonly number[] = [0.5, 0.7, 0.8, 0.9, 0.99, 0.999];

/** Counts, for each of `kShifts`, the verdicts of `default` on the segments of a model. */
export function confidenceOf({ scene, truth }: Model): ConfidenceClass[][] {
  return kShifts.map((shift) => {
    const classes = kClasses.map((from) => ({ from, verdicts: 0, wrong: 0 }));
    const ways =
      shift === 0 ? [scene] : [0, 1, 2].flatMap((axis) => [1, -1].map((s) => shifted(scene, axis, s * shift)));
    for (const { cage, target } of ways) {
      const { segments, segmentStats } = transfer(cage, target);
      const labels = labelsOf(target, truth, segments, segmentStats.length);
      segmentStats.forEach(({ confidence, culled }, s) => {
        const label = labels[s];
        if (label === undefined) return;
        const found = classes.filter(({ from }) => confidence >= from).at(-1)!;
        found.verdicts += 1;
        if (label !== culled) found.wrong += 1;
      });
    }
    return classes;
  });
}

/** Whether most of the labelled area of a segment must not be painted; undefined where nothing of it is labelled. */
function labelsOf(target: Mesh, truth: Truth, segments: Uint32Array, count: number): (boolean | undefined)[] {
  const [ncz, skin] = [new Float64Array(count), new Float64Array(count)];
  vertexAreas(target).forEach((area, v) => {
    if (truth.ignore[v] === 1) return;
    if (truth.ncz[v] === 1) ncz[segments[v]!]! += area;
    else if (truth.offCage[v] !== 1) skin[segments[v]!]! += area;
  });
  return Array.from(ncz, (area, s) => (area + skin[s]! > 0 ? area > skin[s]! : undefined));
}

/** How many verdicts of some classes are right, over all models, for each of `kShifts`. */
export function rightVerdicts(models: readonly ConfidenceClass[][][], isIn: (from: number) => boolean) {
  return kShifts.map((_, i) => {
    const classes = models.flatMap((model) => model[i]!.filter(({ from }) => isIn(from)));
    const sum = (of: (one: ConfidenceClass) => number): number => classes.reduce((total, one) => total + of(one), 0);
    const verdicts = sum((one) => one.verdicts);
    return { verdicts, right: verdicts - sum((one) => one.wrong) };
  });
}

/** A row for each class. */
export function confidenceTable(models: readonly ConfidenceClass[][][]): string {
  const row = (name: string, isIn: (from: number) => boolean): string[] => [
    name,
    ...rightVerdicts(models, isIn).map(({ verdicts, right }) =>
      verdicts === 0 ? '–' : `${right} of ${verdicts}: ${percent(right / verdicts)}`,
    ),
  ];
  return table(
    ['confidence', ...kShifts.map((shift) => (shift === 0 ? 'own cage' : `moved by ${percent(shift)}`))],
    [
      ...kClasses.map((from, i) => row(`${from} to ${kClasses[i + 1] ?? 1}`, (other) => other === from)),
      row('**0.9 and more**', (from) => from >= 0.9),
    ],
  );
}
