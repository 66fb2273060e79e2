import { percent } from '../percent.js';
import type { Score } from '../quality/score.js';
import { mean } from '../statistics.js';
import { table } from '../table.js';
import { kColors, kLegend } from './pictures.js';

/** What a method did with a model, or why it failed. */
export type Row =
  | (Score & { /** The median. */ seconds: number /** In bytes. */; memory?: number })
  | { failed: string };

/** Everything that one run found out. */
export interface Results {
  date: string;
  machine: { processor: string; cores: number; node: string };
  /** Runs that are timed, after one that is not. */
  runs: number;
  models: Record<string, { vertices: number; triangles: number; methods: Record<string, Row> }>;
  /** Folders that were not measured, and why. */
  skipped: string[];
}

/** A method over all models. One that it failed at counts as nothing suppressed and nothing kept. */
export interface Summary {
  suppressed: { mean: number; worst: number };
  kept: { mean: number; worst: number };
  /** The lesser of suppressed and kept: what orders the methods. */
  lesser: { mean: number; worst: number };
  seconds: number;
  memory: number;
  failed: number;
}

/** Methods by their name, the best first. */
export function summaryOf({ models }: Pick<Results, 'models'>): Record<string, Summary> {
  const all = Object.values(models);
  const names = [...new Set(all.flatMap(({ methods }) => Object.keys(methods)))];
  const entries = names.map((name): [string, Summary] => {
    const rows = all.map(({ methods }) => methods[name]!);
    const done = rows.flatMap((row) => ('failed' in row ? [] : [row]));
    const over = (measure: (score: Score) => number) => {
      const values = rows.map((row) => ('failed' in row ? 0 : measure(row)));
      return { mean: mean(values), worst: Math.min(...values) };
    };
    const summary = {
      suppressed: over(({ suppressed }) => suppressed),
      kept: over(({ kept }) => kept),
      lesser: over(({ suppressed, kept }) => Math.min(suppressed, kept)),
      seconds: mean(done.map(({ seconds }) => seconds)),
      memory: Math.max(...done.map(({ memory = NaN }) => memory)),
      failed: rows.length - done.length,
    };
    return [name, summary];
  });
  return Object.fromEntries(entries.sort(([, a], [, b]) => b.lesser.mean - a.lesser.mean));
}

const time = (seconds: number): string =>
  Number.isFinite(seconds) ? `${Number((1000 * seconds).toPrecision(3)).toLocaleString('en')} ms` : '–';
const size = (bytes = NaN): string => (Number.isFinite(bytes) ? `${(bytes / 2 ** 20).toFixed(1)} MB` : '–');

/** A table, as its head and its rows. */
type Cells = [head: string[], rows: string[][]];

function modelCells(methods: Readonly<Record<string, Row>>): Cells {
  const rows = Object.entries(methods).map(([name, row]) =>
    'failed' in row
      ? [name, 'failed', '', '', '']
      : [name, percent(row.suppressed), percent(row.kept), time(row.seconds), size(row.memory)],
  );
  return [['', 'suppressed', 'kept', 'time', 'memory'], rows];
}

function summaryCells(results: Results): Cells {
  const count = Object.keys(results.models).length;
  const rows = Object.entries(summaryOf(results)).map(
    ([name, { suppressed, kept, lesser, seconds, memory, failed }]) => [
      name,
      ...[lesser, suppressed, kept].map(({ mean, worst }) => `${percent(mean)} · ${percent(worst)}`),
      time(seconds),
      size(memory),
      `${count - failed} of ${count}`,
    ],
  );
  return [['', 'lesser of both', 'suppressed', 'kept', 'time', 'memory', 'models'], rows];
}

const failures = (methods: Readonly<Record<string, Row>>): string[] =>
  Object.entries(methods).flatMap(([name, row]) => ('failed' in row ? [`${name} failed: ${row.failed}`] : []));
const sizes = ({ vertices, triangles }: { vertices: number; triangles: number }): string =>
  `${vertices.toLocaleString('en')} vertices, ${triangles.toLocaleString('en')} triangles`;
const aboutRun = ({ date, machine, runs }: Results): string =>
  `${date} · ${machine.processor}, ${machine.cores} cores, Node ${machine.node} · median of ${runs} ${runs === 1 ? 'run' : 'runs'} after one that is not timed`;

const kMeasures: readonly string[] = [
  'suppressed: of the area that must not be painted, the share that is left out',
  'kept: of the area that should be painted, the share that is painted',
  'lesser of both: the smaller of the two; neither painting everything nor painting nothing gets more than 0',
  'time: from arrays to zones, in the method’s own process',
  'memory: by how much its resident memory rises meanwhile; – where the system does not say',
];
const kSummary =
  'Mean over models · worst model; time is the mean, memory the most. A model that a method failed at counts as 0.';

/** As Markdown. */
export function markdown(results: Results): string {
  const parts = [
    '# Which zones methods find',
    aboutRun(results),
    kMeasures.map((line) => `- ${line.replace(/^[^:]+/, '*$&*')}`).join('\n'),
    '## Summary',
    kSummary,
    table(...summaryCells(results)),
    ...Object.entries(results.models).flatMap(([name, model]) => [
      `## ${name}`,
      sizes(model),
      table(...modelCells(model.methods)),
      ...failures(model.methods).map((line) => `- ${line}`),
    ]),
    ...(results.skipped.length > 0 ? ['## Not measured', results.skipped.map((line) => `- ${line}`).join('\n')] : []),
  ];
  return `${parts.map((part) => part.trim()).join('\n\n')}\n`;
}

const escaped = (text: string): string => text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

const tableHtml = ([head, rows]: Cells): string => `<div class="wide" tabindex="0"><table>
<tr>${head.map((cell) => `<th scope="col">${escaped(cell)}</th>`).join('')}</tr>
${rows.map(([name, ...cells]) => `<tr><th scope="row">${escaped(name!)}</th>${cells.map((cell) => `<td>${escaped(cell)}</td>`).join('')}</tr>`).join('\n')}
</table></div>`;

const listHtml = (lines: readonly string[]): string =>
  lines.length > 0 ? `<ul>${lines.map((line) => `<li>${escaped(line)}</li>`).join('')}</ul>` : '';

const kStyle = `:root { color-scheme: light dark; --line: color-mix(in srgb, currentColor 20%, transparent); }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 0 auto; padding: 1rem; }
h2 { margin: 2.5rem 0 0.25rem; }
p, ul { max-width: 46rem; }
ul { padding-left: 1.2rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: 0.35rem 0.8rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th:first-child { text-align: left; padding-left: 0; }
th:last-child, td:last-child { padding-right: 0; }
@media (max-width: 30rem) { th, td { padding: 0.35rem 0.3rem; font-size: 0.85rem; } }
.pictures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 18rem), 1fr)); gap: 1rem; margin-top: 1rem; }
figure { margin: 0; }
figure img { width: 100%; height: auto; border-radius: 6px; background: color-mix(in srgb, currentColor 8%, transparent); }
.legend { display: flex; flex-wrap: wrap; gap: 0.25rem 1.2rem; padding: 0; list-style: none; max-width: none; }
.legend i { display: inline-block; width: 1em; height: 1em; margin-right: 0.4em; border-radius: 3px; vertical-align: -0.12em; }
small { opacity: 0.75; }`;

/** As a page that needs nothing else. @param pictures  PNGs: by model, then by method, and its `truth`. */
export function page(results: Results, pictures: Readonly<Record<string, Record<string, Buffer>>>): string {
  const legend = Object.entries(kLegend).map(
    ([what, words]) =>
      `<li><i style="background: #${kColors[what as keyof typeof kColors].toString(16)}"></i>${words}</li>`,
  );
  const figure = (model: string, name: string, png: Buffer): string => {
    const shows = `${model}, ${name}`;
    return `<figure><img src="data:image/png;base64,${png.toString('base64')}" width="480" height="240" alt="${escaped(shows)}: from the front and the side"><figcaption>${escaped(name)}</figcaption></figure>`;
  };
  const models = Object.entries(results.models).map(
    ([name, model]) => `<h2>${escaped(name)}</h2>
<small>${sizes(model)}</small>
${tableHtml(modelCells(model.methods))}
${listHtml(failures(model.methods))}
<div class="pictures">${Object.entries(pictures[name] ?? {})
      .map(([method, png]) => figure(name, method, png))
      .join('\n')}</div>`,
  );
  return `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Which zones methods find</title>
<style>
${kStyle}
</style>
<h1>Which zones methods find</h1>
<p>A texture is drawn for a simple mesh around a model, its cage, and transferred to the model. Each method says which vertices of the model must not be painted.</p>
<small>${escaped(aboutRun(results))}</small>
<h2>Summary</h2>
<p>${kSummary}</p>
${tableHtml(summaryCells(results))}
${listHtml(kMeasures).replace(/<li>([^:]+)/g, '<li><strong>$1</strong>')}
<p>In the pictures:</p>
<ul class="legend">${legend.join('')}</ul>
${models.join('\n')}
${results.skipped.length > 0 ? `<h2>Not measured</h2>${listHtml(results.skipped)}` : ''}
</html>
`;
}
