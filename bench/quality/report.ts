import { percent } from '../percent.js';
import { mean } from '../statistics.js';
import { table } from '../table.js';
import type { CageQuality, CageResults } from './cages.js';
import { confidenceTable } from './confidence.js';
import type { FitScore } from './fit-score.js';
import { meanError, missedCageGoals, missedGoals } from './goals.js';
import { kShift, kThresholds, type Quality } from './measure.js';
import type { Score } from './score.js';

/** Everything that one run found out. */
export interface QualityResults {
  date: string;
  machine: { processor: string; cores: number; node: string };
  /** By model. */
  models: Record<string, Quality>;
  cages: CageResults;
}

const byArea = ({ suppressed, kept }: Score): string => `${percent(suppressed)} · ${percent(kept)}`;
const worst = (scores: Record<string, Score>): string =>
  byArea({
    suppressed: Math.min(...Object.values(scores).map(({ suppressed }) => suppressed)),
    kept: Math.min(...Object.values(scores).map(({ kept }) => kept)),
  });

/** A row per entry. */
const rowsOf = <T>(
  entries: Readonly<Record<string, T>>,
  head: readonly string[],
  cells: (value: T, name: string) => string[],
): string =>
  table(
    ['', ...head],
    Object.entries(entries).map(([name, value]) => [name, ...cells(value, name)]),
  );

/** Methods with a column. */
const kShown = ['naive', 'paper', 'default'] as const;

function modelTable(models: QualityResults['models']): string {
  const range = `${kThresholds[0]} to ${kThresholds.at(-1)}`;
  const head = ['', 'triangles', ...kShown, `worst at ${range}`, 'worst when moved', 'forbidden · bare', 'smeared'];
  return rowsOf(models, head, ({ kind, triangles, methods, ...quality }) => [
    kind,
    triangles.toLocaleString('en'),
    ...kShown.map((method) => byArea(methods[method])),
    worst(quality.thresholds),
    worst(quality.shifted),
    `${percent(methods.default.forbidden)} · ${percent(methods.default.bare)}`,
    percent(Math.max(quality.smear.corner, quality.smear.cut)),
  ]);
}

/** `default` without each of its steps, where that is not the same. */
function stepTable(models: QualityResults['models']): string {
  const cellOf = ({ methods, without }: Quality, step: string): string => {
    const cell = byArea(without[step]!);
    return cell === byArea(methods.default) ? '' : cell;
  };
  const all = Object.keys(Object.values(models)[0]?.without ?? {});
  const steps = all.filter((step) => Object.values(models).some((quality) => cellOf(quality, step) !== ''));
  const idle = all.filter((step) => !steps.includes(step)).map((step) => `\`${step}\``);
  const rows = Object.entries(models).filter(([, quality]) => steps.some((step) => cellOf(quality, step) !== ''));
  return `${rowsOf(Object.fromEntries(rows), steps, (quality) => steps.map((step) => cellOf(quality, step)))}
No difference to any of these models: ${idle.join(', ') || 'none'}.`;
}

function madeTable({ made, byHand }: CageResults): string {
  const head = ['', 'made', 'by hand', 'triangles', 'charts', 'overlap', 'verdict', 'time'];
  return rowsOf(made, head, (cage, name) => [
    cage.isNamed ? cage.kind : `${cage.kind}, no part names`,
    byArea(cage),
    byHand[name] ? byArea(byHand[name]) : '',
    String(cage.triangles),
    String(cage.charts),
    percent(cage.overlap),
    cage.verdict,
    `${cage.seconds.toFixed(1)} s`,
  ]);
}

function fitTable({ fitted, given }: CageResults): string {
  const all = Object.entries(fitted);
  const groups: Record<string, typeof all> = {
    '**heads, mean**': all.filter(([, { kind, isNamed }]) => kind === 'head' && isNamed),
    '**bodies, mean**': all.filter(([, { kind }]) => kind === 'body'),
    '**heads, 23 given landmarks, mean**': Object.entries(given),
  };
  const rows = [...all.map((entry): [string, typeof all] => [entry[0], [entry]]), ...Object.entries(groups)].filter(
    ([, fits]) => fits.length > 0,
  );
  const head = ['error', 'landmarks', 'eye cover', 'spill', 'outside', 'suppressed · kept', 'time'];
  return rowsOf(Object.fromEntries(rows), head, (entries) => {
    const fits = entries.map(([, fit]) => fit);
    const of = (value: (fit: CageQuality & FitScore) => number): number => mean(fits.map(value));
    const ofEyes = (share: 'cover' | 'spill'): number =>
      mean(fits.flatMap(({ eyes }) => eyes.map((eye) => eye[share])));
    const { median, high } = meanError(fits);
    return [
      `${percent(median)} / ${percent(high)}`,
      percent(of((fit) => fit.landmarks)),
      percent(ofEyes('cover')),
      percent(ofEyes('spill')),
      percent(of((fit) => fit.outside)),
      byArea({ suppressed: of((fit) => fit.suppressed), kept: of((fit) => fit.kept) }),
      `${of((fit) => fit.seconds).toFixed(1)} s`,
    ];
  });
}

/** Sections about cages, in Markdown. */
export const cageSections = (cages: CageResults): string[] => [
  '## Made cages',
  `\`makeCage\` without options. Suppressed · kept with the made cage and with the one made by hand; *overlap*: share of the used
texture where charts overlap; the verdict of \`cagecast inspect\`; seconds in Node.`,
  madeTable(cages),
  '## Fitted cages',
  `\`fitCage\` without landmarks, unless the row says so, of a template whose model has the same vertices, so that the correct result is
known. *error*: distance, on the template's cage, between the spot that a vertex of the skin gets and the spot that it should get:
median / 95th percentile, in shares of the diagonal. *landmarks*: mean error at known landmarks that the fit did not use.
*eye cover*, *spill*: what is inside the holes for the eyes of their visible part, and what is beside it. *outside*: share of the skin
outside the cage.`,
  fitTable(cages),
];

/** All tables, in Markdown. */
export function qualityReport({ date, machine, models, cages }: QualityResults): string {
  const missed = [...missedGoals(models), ...missedCageGoals(cages)];
  const parts = [
    `# Quality, measured on ${date}`,
    `${machine.processor}, ${machine.cores} cores, Node ${machine.node}. Written by \`npm run quality\`; all numbers: [quality.json](quality.json).`,
    `- *suppressed* · *kept*: of the area that must not be painted, the share that is not; of the area that should be painted, the share
  that is. [How they are measured](../../docs/evaluation.md#what-is-measured).
- *naive*: everything painted.
- *worst at 0.1 to 0.9*: \`default\` at other thresholds; *worst when moved*: with the cage ${percent(kShift)} of the diagonal aside, in six directions.
- *forbidden* · *bare*: share of the model's pixels, from all sides, with paint where none must be; share of the pixels of what should be
  painted without paint. *smeared*: share of the painted area whose texture is smeared.
- A *trap* is difficult on purpose. A *spoiled* model is expected to fail, as on the poster, and has no goals.`,
    modelTable(models),
    missed.length === 0 ? 'All goals are reached.' : `Goals missed:\n\n${missed.map((line) => `- ${line}`).join('\n')}`,
    '## `default` without one step',
    'Suppressed · kept, where that differs. `groups`: all vertices in one group; the others: that option as in `paper`.',
    stepTable(models),
    '## Confidence',
    `Verdicts of \`default\` on segments that are right, by their \`confidence\`: under the model's cage, and under the same cage moved
along each axis, both ways, by a share of the target's diagonal. A segment is to be culled if most of its labelled area must not be painted.`,
    confidenceTable(Object.values(models).map(({ confidence }) => confidence)),
    ...cageSections(cages),
  ];
  return `${parts.map((part) => part.trim()).join('\n\n')}\n`;
}
