import { writeFile } from 'node:fs/promises';
import { resultsFolder } from '../results.js';
import { table } from '../table.js';
import { missedGoals } from './goals.js';
import { largeTriangles, shift, thresholds, type Quality } from './measure.js';
import { methodNames, type MethodName } from './methods.js';
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
}

/** Writes JSON, tables and plot, over those of earlier runs. */
export async function writeQuality(results: QualityResults): Promise<void> {
  // Four digits of a percentage are more than a model is good for. What has no parts of its own is kept on one line.
  const json = JSON.stringify(results, (_, value: unknown) => (typeof value === 'number' ? Number(value.toPrecision(6)) : value), 1);
  await writeFile(`${resultsFolder}/quality.json`, `${json.replace(/\{[^{}[\]]*\}/g, (leaf) => leaf.replace(/\s+/g, ' '))}\n`);
  await writeFile(`${resultsFolder}/quality.md`, qualityReport(results));
  await writeFile(`${resultsFolder}/quality-thresholds.svg`, thresholdPlot(results.models));
}

const percent = (share: number): string => {
  // What is not all of it must not be rounded to all of it, nor something to nothing.
  const rounded = Math.min(Math.max(100 * share, share > 0 ? 0.01 : 0), share < 1 ? 99.99 : 100);
  return `${Number(rounded.toFixed(2))} %`;
};
const ms = (value: number): string => value.toFixed(value >= 10 ? 0 : 1);
const both = ({ suppressed, kept }: Score): string => `${percent(suppressed)} · ${percent(kept)}`;
const inPicture = ({ forbidden, bare }: Score): string => `${percent(forbidden)} · ${percent(bare)}`;
const worst = (scores: Iterable<Score>): Score => {
  const all = [...scores];
  const [least, most] = [Math.min, Math.max].map((pick) => (measure: keyof Score) => pick(...all.map((one) => one[measure])));
  return { suppressed: least!('suppressed'), kept: least!('kept'), forbidden: most!('forbidden'), bare: most!('bare') };
};

const rowNames: Record<MethodName, string> = {
  naive: 'naive transfer (step 1)',
  'step 2': 'without what the target occludes (2)',
  'step 3': 'nor what the cage does not cover (3)',
  paper: '**`paper`: nor segments below the threshold (5)**',
  default: '**`default`**',
};

/** The poster's table, with numbers in it: those of the samples, one after the other. */
export function posterTable({ models, times, largeTimes }: QualityResults): string {
  const samples = Object.entries(models).filter(([, { kind }]) => kind === 'sample');
  const each = (show: (quality: Quality, name: string) => string): string => samples.map(([name, quality]) => show(quality, name)).join(' / ').replaceAll(' % / ', ' / ').replaceAll(' ms / ', ' / ');
  return [
    table(
      ['method', 'type', `latency: ${samples.map(([name]) => name).join(' / ')}`, 'suppressed', 'kept', 'pixels painted where forbidden', 'pixels bare', `${largeTriangles / 1000}k triangles`],
      [
        ['manual authoring', 'artist-driven', '*60–120 min*', '*gold standard*', '', '', '', '*low*'],
        ...methodNames.map((name) => [
          rowNames[name],
          'automated',
          each((_, model) => `${ms(times[model]![name])} ms`),
          each(({ methods }) => percent(methods[name].suppressed)),
          each(({ methods }) => percent(methods[name].kept)),
          each(({ methods }) => percent(methods[name].forbidden)),
          each(({ methods }) => percent(methods[name].bare)),
          `${ms(largeTimes[name])} ms`,
        ]),
      ],
    ),
    'In italics: as the poster says. Its other rows read “< 30–60 ms, low, high” (naive) and “< 70–100 ms, high, high” (the method), for latency, suppression and scalability.',
  ].join('\n');
}

/** All tables, in Markdown. */
export function qualityReport(results: QualityResults): string {
  const { date, machine, models, times } = results;
  const entries = Object.entries(models);
  const steps = Object.keys(entries[0]![1].without);
  const missed = missedGoals(models);
  const judged = entries.flatMap(([name, q]) => (q.kind === 'spoiled' ? [] : q.segments.filter(({ coverage }) => coverage >= 0.3).map((segment) => ({ name, ...segment }))));
  return `${[
    `# Quality, measured on ${date}`,
    `${machine.processor}, ${machine.cores} cores, Node ${machine.node}. Written by \`npm run quality\`; all numbers: [quality.json](quality.json).`,
    [
      '- *suppressed*: of the area that must not be painted, the share whose vertices are not; *kept*: of the area that is to be painted, the share whose vertices are. Left out is what the truth leaves open (hidden, or a matter of taste), and of *kept* what the cage does not speak of (its nearest place is on an open border).',
      '- *painted where forbidden*: of the pixels that show the model, in 12 pictures from all around, those that show paint where none must be; *bare*: of those that show what is to be painted (in the same sense), those without.',
      '- *latency*: the package in Node, raw arrays in, answer out; CPU time, medians. The first rows are the first steps of `paper`.',
    ].join('\n'),
    posterTable(results),
    missed.length === 0 ? 'All goals are reached.' : `Goals missed:\n\n${missed.map((line) => `- ${line}`).join('\n')}`,
    '![Suppressed and kept by threshold](quality-thresholds.svg)',
    '## Every model',
    'Suppressed · kept. *Trap*: made to be difficult; *spoiled*: made to fail, as on the poster, and not held to any goal.',
    table(
      ['', '', 'triangles', ...methodNames, `\`default\`, worst of thresholds ${thresholds[0]}–${thresholds.at(-1)}`, `worst of the cage ${percent(shift)} of the diagonal aside`],
      entries.map(([name, q]) => [name, q.kind, q.triangles.toLocaleString('en'), ...methodNames.map((method) => both(q.methods[method])), both(worst(Object.values(q.thresholds.default))), both(worst(Object.values(q.shifted)))]),
    ),
    'In the picture: painted where forbidden · bare.',
    table(
      ['', ...methodNames, `\`default\`, worst of thresholds ${thresholds[0]}–${thresholds.at(-1)}`, `worst of the cage ${percent(shift)} of the diagonal aside`],
      entries.map(([name, q]) => [name, ...methodNames.map((method) => inPicture(q.methods[method])), inPicture(worst(Object.values(q.thresholds.default))), inPicture(worst(Object.values(q.shifted)))]),
    ),
    '## Where it fails',
    'As the poster says: where eyes are of one piece with the skin, and where the cage is out of place. `cagecast inspect` calls the second unfit.',
    '![A face whose eyes are of one piece with its skin, and one under a cage that is turned and moved, by every method](../../docs/pictures/failures.jpg)',
    '## Why vertices are left out, and what it takes',
    'Vertices occluded / uncovered / culled; milliseconds; most memory beyond cage and target (the poster: “~20 MB”); painted area whose texture is smeared, with UVs per vertex and per corner.',
    table(
      ['', 'vertices', '`paper`', '`default`', 'naive, ms', '`paper`, ms', '`default`, ms', '`paper`, MB', '`default`, MB', 'smeared: vertex', 'corner'],
      entries.map(([name, q]) => {
        const counts = (method: MethodName): string => [q.methods[method].vertices].map(({ occluded, uncovered, culled }) => `${occluded} / ${uncovered} / ${culled}`)[0]!;
        const vertices = Object.values(q.methods.naive.vertices).reduce((sum, count) => sum + count, 0);
        return [name, String(vertices), counts('paper'), counts('default'), ...(['naive', 'paper', 'default'] as const).map((method) => ms(times[name]![method])), ...(['paper', 'default'] as const).map((preset) => (q.peakBytes[preset] / 1e6).toFixed(1)), percent(q.smear.vertex), percent(q.smear.corner)];
      }),
    ),
    '## `default` without one step',
    'Suppressed · kept, where it differs from `default` as it is. `groups`: parts welded together; `depth`: the floor as it was at first; the others: that option as in `paper`.',
    table(
      ['', ...steps],
      entries.map(([name, q]) => [name, ...steps.map((step) => [both(q.without[step]!)].map((text) => (text === both(q.methods.default) ? '' : text))[0]!)]),
    ),
    'In the picture: painted where forbidden · bare.',
    table(
      ['', ...steps],
      entries.map(([name, q]) => [name, ...steps.map((step) => [inPicture(q.without[step]!)].map((text) => (text === inPicture(q.methods.default) ? '' : text))[0]!)]),
    ),
    '## How near the floor is',
    'How many times what the floor asks a segment reaches, of those with F of at least 0.3; the five nearest to 1 of either kind.',
    table(
      ['', 'first vertex', 'wanted', 'F', 'C / A', 'reach', ''],
      (['bare', 'painted', 'either'] as const).flatMap((wanted) =>
        judged
          .filter((segment) => segment.wanted === wanted)
          .sort((a, b) => Math.abs(Math.log(a.reach)) - Math.abs(Math.log(b.reach)))
          .slice(0, 5)
          .map((s) => [s.name, String(s.firstVertex), wanted, s.coverage.toFixed(3), s.coveredShare.toFixed(4), s.reach.toFixed(3), s.culled ? 'culled' : 'passes']),
      ),
    ),
  ]
    .join('\n\n')
    .replace(/\n{3,}/g, '\n\n')
    .trim()}\n`;
}
