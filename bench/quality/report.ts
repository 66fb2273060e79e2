import { writeFile } from 'node:fs/promises';
import { resultsFolder } from '../results.js';
import { table } from '../table.js';
import { cageSections } from './cage-report.js';
import type { CageQuality } from './cages.js';
import { missedCageGoals, missedGoals } from './goals.js';
import { largeTriangles, type Quality, shift, thresholds, type ZoneCounts } from './measure.js';
import { type MethodName, methodNames } from './methods.js';
import { thresholdPlot } from './plot.js';
import type { Score } from './score.js';

/** Everything that one run found out. */
export interface QualityResults {
  date: string;
  machine: { processor: string; cores: number; node: string };
  /** By model. */
  models: Record<string, Quality>;
  /** Milliseconds, by model and method. */
  times: Record<string, Record<MethodName, number>>;
  /** Milliseconds on the large model, by method. */
  largeTimes: Record<MethodName, number>;
  cages: CageQuality;
}

/** Writes JSON, tables and plot, over those of earlier runs. */
export async function writeQuality(results: QualityResults): Promise<void> {
  // Six digits are more than a model is good for. What has no parts of its own is kept on one line.
  const json = JSON.stringify(
    results,
    (_, value: unknown) => (typeof value === 'number' ? Number(value.toPrecision(6)) : value),
    1,
  );
  await writeFile(
    `${resultsFolder}/quality.json`,
    `${json.replace(/\{[^{}[\]]*\}/g, (leaf) => leaf.replace(/\s+/g, ' '))}\n`,
  );
  await writeFile(`${resultsFolder}/quality.md`, qualityReport(results));
  await writeFile(`${resultsFolder}/quality-thresholds.svg`, thresholdPlot(results.models));
}

const percent = (share: number): string => {
  // What is not all of it must not be rounded to all of it, nor something to nothing.
  const rounded = Math.min(Math.max(100 * share, share > 0 ? 0.01 : 0), share < 1 ? 99.99 : 100);
  return `${Number(rounded.toFixed(2))} %`;
};
const ms = (value: number): string => value.toFixed(value >= 10 ? 0 : 1);
const byArea = ({ suppressed, kept }: Score): string => `${percent(suppressed)} · ${percent(kept)}`;
const byPixel = ({ forbidden, bare }: Score): string => `${percent(forbidden)} · ${percent(bare)}`;
const worst = (scores: Iterable<Score>): Score => {
  const all = [...scores];
  const [least, most] = [Math.min, Math.max].map(
    (pick) => (measure: keyof Score) => pick(...all.map((one) => one[measure])),
  );
  return { suppressed: least!('suppressed'), kept: least!('kept'), forbidden: most!('forbidden'), bare: most!('bare') };
};

const rowNames: Record<MethodName, string> = {
  naive: 'naive transfer (step 1)',
  'step 2': 'without occluded vertices (2)',
  'step 3': 'nor uncovered vertices (3)',
  paper: '**`paper`: nor segments below the threshold (5)**',
  default: '**`default`**',
};

const quotes = `In italics: as the poster says. Its other rows read “< 30–60 ms, low, high” (naive) and “< 70–100 ms, high, high” (the
method), for latency, suppression and scalability.`;

/** The poster's table, with numbers in it: those of the samples, one after the other. */
function posterTable({ models, times, largeTimes }: QualityResults): string {
  const samples = Object.entries(models).filter(([, { kind }]) => kind === 'sample');
  const each = (unit: string, show: (quality: Quality, name: string) => string): string =>
    `${samples.map(([name, quality]) => show(quality, name).replace(` ${unit}`, '')).join(' / ')} ${unit}`;
  const names = samples.map(([name]) => name).join(' / ');
  const shares = ['suppressed', 'kept', 'forbidden', 'bare'] as const;
  return table(
    [
      'method',
      'type',
      `latency: ${names}`,
      'suppressed',
      'kept',
      'pixels painted where forbidden',
      'pixels bare',
      `${largeTriangles / 1000}k triangles`,
    ],
    [
      ['manual authoring', 'artist-driven', '*60–120 min*', '*gold standard*', '', '', '', '*low*'],
      ...methodNames.map((name) => [
        rowNames[name],
        'automated',
        each('ms', (_, model) => `${ms(times[model]![name])} ms`),
        ...shares.map((share) => each('%', ({ methods }) => percent(methods[name][share]))),
        `${ms(largeTimes[name])} ms`,
      ]),
    ],
  );
}

/** A row per model. */
const byModel = (
  models: Readonly<Record<string, Quality>>,
  head: readonly string[],
  cells: (quality: Quality, name: string) => string[],
): string =>
  table(
    ['', ...head],
    Object.entries(models).map(([name, quality]) => [name, ...cells(quality, name)]),
  );

const worstOfThresholds = `\`default\`, worst of thresholds ${thresholds[0]}–${thresholds.at(-1)}`;
const worstOfShifts = `worst of the cage ${percent(shift)} of the diagonal aside`;

/** Each method's score, and the worst that `default` can be brought to. */
function methodScores({ methods, thresholds: by, shifted }: Quality, show: (score: Score) => string): string[] {
  return [
    ...methodNames.map((method) => methods[method]),
    worst(Object.values(by.default)),
    worst(Object.values(shifted)),
  ].map(show);
}

/** `default` without each of its steps, where that is not the same; steps that make no difference to any model are named below. */
function stepTable(models: Readonly<Record<string, Quality>>, show: (score: Score) => string): string {
  const cellOf = ({ methods, without }: Quality, step: string): string => {
    const cell = show(without[step]!);
    return cell === show(methods.default) ? '' : cell;
  };
  const all = Object.keys(Object.values(models)[0]!.without);
  const steps = all.filter((step) => Object.values(models).some((quality) => cellOf(quality, step) !== ''));
  const idle = all.filter((step) => !steps.includes(step)).map((step) => `\`${step}\``);
  return `${byModel(models, steps, (quality) => steps.map((step) => cellOf(quality, step)))}
No difference to any of these models: ${idle.length > 0 ? idle.join(', ') : 'none'}.`;
}

/** Why vertices are left out, and what a transfer takes. */
function costTable({ models, times }: QualityResults): string {
  const head = [
    'vertices',
    '`paper`',
    '`default`',
    'naive, ms',
    '`paper`, ms',
    '`default`, ms',
    '`paper`, MB',
    '`default`, MB',
    'smeared: vertex',
    'corner',
    'cut',
  ];
  return byModel(models, head, ({ methods, peakBytes, smear }, name) => {
    const zones = ({ occluded, uncovered, culled }: ZoneCounts): string => `${occluded} / ${uncovered} / ${culled}`;
    const vertices = Object.values(methods.naive.vertices).reduce((sum, count) => sum + count, 0);
    const { naive, paper, default: ours } = times[name]!;
    return [
      String(vertices),
      ...[methods.paper, methods.default].map((method) => zones(method.vertices)),
      ...[naive, paper, ours].map(ms),
      ...[peakBytes.paper, peakBytes.default].map((bytes) => (bytes / 1e6).toFixed(1)),
      ...[smear.vertex, smear.corner, smear.cut].map(percent),
    ];
  });
}

/** The segments that are nearest to the floor, of each kind. */
function floorTable(models: Readonly<Record<string, Quality>>): string {
  const segments = Object.entries(models)
    .filter(([, { kind }]) => kind !== 'spoiled')
    .flatMap(([name, quality]) => quality.segments.map((segment) => ({ name, ...segment })))
    .filter(({ coverage }) => coverage >= 0.3) // whoever fails the lowest threshold needs no floor
    .sort((a, b) => Math.abs(Math.log(a.reach)) - Math.abs(Math.log(b.reach)));
  const nearest = (['bare', 'painted', 'either'] as const).flatMap((wanted) =>
    segments.filter((segment) => segment.wanted === wanted).slice(0, 5),
  );
  return table(
    ['', 'first vertex', 'wanted', 'F', 'C / A', 'reach', ''],
    nearest.map(({ name, firstVertex, wanted, coverage, coveredShare, reach, culled }) => [
      name,
      String(firstVertex),
      wanted,
      coverage.toFixed(3),
      coveredShare.toFixed(4),
      reach.toFixed(3),
      culled ? 'culled' : 'passes',
    ]),
  );
}

/** All tables, in Markdown. */
export function qualityReport(results: QualityResults): string {
  const { date, machine, models } = results;
  const missed = [...missedGoals(models), ...missedCageGoals(results.cages)];
  const scoresHead = [...methodNames, worstOfThresholds, worstOfShifts];
  const parts = [
    `# Quality, measured on ${date}`,
    `${machine.processor}, ${machine.cores} cores, Node ${machine.node}. Written by \`npm run quality\`; all numbers: [quality.json](quality.json).`,
    `- *suppressed*: share of the area that must not be painted whose vertices are not cosmetic; *kept*: share of the area that should
  be painted whose vertices are cosmetic. Vertices that are hidden, or acceptable either way, are not scored; nor are, for *kept*,
  those whose closest point is on a boundary loop of the cage, because the cage says nothing about them.
- *painted where forbidden*: share of the model's pixels, in 12 pictures from all sides, that show paint on a surface that must not
  be painted; *bare*: share of the pixels of surfaces that should be painted that show no paint.
- *latency*: the package in Node, from raw arrays to the result; CPU time, medians. The first rows are the first steps of \`paper\`.`,
    ...(Object.values(models).some(({ kind }) => kind === 'sample') ? [posterTable(results), quotes] : []),
    missed.length === 0 ? 'All goals are reached.' : `Goals missed:\n\n${missed.map((line) => `- ${line}`).join('\n')}`,
    '![Suppressed and kept by threshold](quality-thresholds.svg)',
    '## Every model',
    'Suppressed · kept. A *trap* is difficult on purpose. A *spoiled* model is expected to fail, as on the poster, and has no goals.',
    byModel(models, ['', 'triangles', ...scoresHead], (quality) => [
      quality.kind,
      quality.triangles.toLocaleString('en'),
      ...methodScores(quality, byArea),
    ]),
    'In the picture: painted where forbidden · bare.',
    byModel(models, scoresHead, (quality) => methodScores(quality, byPixel)),
    '## Where it fails',
    'Eyes fused to the skin, and a misplaced cage, as the poster says. `cagecast inspect` reports such a cage as unfit. [More](../../docs/evaluation.md#where-it-fails).',
    '![A face with eyes fused to the skin, and one under a cage that is rotated and moved, by every method](../../docs/pictures/failures.jpg)',
    ...cageSections(results.cages),
    '## Why vertices are left out, and the cost',
    `Vertices occluded / uncovered / culled; milliseconds; peak memory beyond cage and target (the poster: “~20 MB”); share of the
painted area whose texture is smeared, with UVs per vertex, with UVs per corner, and with cut borders.`,
    costTable(results),
    '## `default` without one step',
    `Suppressed · kept, where that differs from \`default\`. \`groups\`: all vertices in one group; \`depth\`: \`floor: 'area'\`; the
others: that option as in \`paper\`.`,
    stepTable(models, byArea),
    'In the picture: painted where forbidden · bare.',
    stepTable(models, byPixel),
    '## Segments close to the floor',
    '*Reach* is the score without the threshold: a segment with at least 1 passes the floor. Listed are, of the segments with F of at least 0.3, the five of each kind that are nearest to 1.',
    floorTable(models),
  ];
  return `${parts.map((part) => part.trim()).join('\n\n')}\n`;
}
