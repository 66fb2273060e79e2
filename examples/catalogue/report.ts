// npm run report [-- --before EARLIER.jsonl --worst N --forget]: writes results.jsonl and report.html to the output folder.
import { execFile } from 'node:child_process';
import { mkdtemp, readFile, rm, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs, promisify } from 'node:util';
import { command } from './command.ts';
import { Failure, reasons } from './failure.ts';
import type { Catalogue, CatalogueJob, Result } from './jobs.ts';
import { page, section, table, text } from './pages/html.ts';
import { patiently } from './patience.ts';
import { collectResults, readResults } from './results.ts';
import { fromCaller } from './settings.ts';
import { checkedJob, type JobData } from './shape.ts';
import { read, write } from './storage.ts';

const cli = fileURLToPath(new URL('cli.js', import.meta.resolve('cagecast')));
/** How many jobs Redis forgets at once. */
const chunk = 5000;
/** How many changes, and how many dead letters, are listed. */
const mostListed = 500;

export interface ReportOptions {
  /** How many of the worst have pictures. */
  worst?: number;
  /** Results of an earlier time: the report tells what is another since then. */
  before?: string | undefined;
  /** Whether Redis forgets what is done: the results remember it. */
  forget?: boolean | undefined;
}

/** How many jobs are done, and of how many of them the cage fits or does not; and how many have failed. */
export interface Counts {
  done: number;
  fit: number;
  unfit: number;
  failed: number;
}

export const described = ({ done, fit, unfit, failed }: Counts): string =>
  `${done} done${fit + unfit > 0 ? ` (${fit} fit, ${unfit} unfit)` : ''}, ${failed} failed`;

/** Writes the results and the report about them. */
export async function report(
  catalogue: Catalogue,
  { worst = 12, before, forget }: ReportOptions = {},
): Promise<Counts> {
  const began = Date.now();
  const earlier = new Map<string, string>();
  if (before !== undefined)
    for await (const result of readResults(before)) earlier.set(nameOf(result), outcomeOf(result));
  const [counts, failures] = [new Map<string, number>(), new Map<string, number>()];
  const [changes, dead]: [string[][], string[][]] = [[], []];
  let [worstOnes, cpuMs]: [Result[], number] = [[], 0];
  const counted: Counts = { done: 0, fit: 0, unfit: 0, failed: 0 };
  await collectResults(catalogue, (result) => {
    const outcome = outcomeOf(result);
    ++counted[result.status];
    if (result.status === 'done' && result.verdict) ++counted[result.verdict === 'unfit' ? 'unfit' : 'fit'];
    cpuMs += result.cpuMs ?? 0;
    if (result.verdict) counts.set(result.verdict, (counts.get(result.verdict) ?? 0) + 1);
    if (result.reason) failures.set(result.reason, (failures.get(result.reason) ?? 0) + 1);
    const was = earlier.get(nameOf(result)) ?? (before === undefined ? outcome : 'new');
    if (was !== outcome && changes.length < mostListed) changes.push([nameOf(result), was, outcome]);
    if (result.reason && dead.length < mostListed) dead.push([nameOf(result), result.error!]);
    if (!result.severity) return;
    worstOnes.push(result);
    if (worstOnes.length < 2 * worst + 100) return;
    worstOnes = worstFirst(worstOnes).slice(0, worst);
  });
  const shown = worstFirst(worstOnes).slice(0, worst);
  const figures: string[] = [];
  for (const result of shown)
    figures.push(
      await figure(result, (await patiently(() => catalogue.queue.getJob(result.key))) as CatalogueJob | undefined),
    );
  const sorted = (map: Map<string, number>) => [...map].sort(([, a], [, b]) => b - a);
  await write(
    'report.html',
    page([
      `<p>${counted.done + counted.failed} jobs: ${described(counted)}; ${(cpuMs / 1000).toFixed(1)} s of processor time. Each of them is a line in <a href="results.jsonl">results.jsonl</a>.</p>`,
      section(
        'Verdicts',
        table(
          ['verdict', 'jobs'],
          sorted(counts).map(([name, n]) => [name, String(n)]),
        ),
      ),
      section(
        'Dead letters',
        table(
          ['reason', 'meaning', 'jobs'],
          sorted(failures).map(([name, n]) => [name, reasons[name as keyof typeof reasons], String(n)]),
        ),
      ),
      dead.length > 0 ? table(['job', 'why'], dead) : '',
      before === undefined ? '' : section('Changes', table(['job', 'before', 'now'], changes)),
      section('The worst', figures.length > 0 ? `${legend}${figures.join('\n')}` : '<p>None has a finding.</p>'),
    ]),
  );
  // What was done since then is not in the results yet.
  const clean = () => patiently(() => catalogue.queue.clean(Date.now() - began, chunk, 'completed'));
  while (forget && (await clean()).length === chunk);
  return counted;
}

const legend = '<p>Grey may be painted; blue is occluded, orange uncovered, pink culled.</p>';

const worstFirst = (results: Result[]) =>
  [...results].sort((a, b) => b.severity! - a.severity! || (a.key < b.key ? -1 : 1));

/** What a job is about, in the same words every night: by names, not by content. */
const nameOf = ({ kind, inputs, settings }: Result): string =>
  [kind, ...Object.values(inputs), ...(Object.keys(settings).length > 0 ? [JSON.stringify(settings)] : [])].join(' ');

const outcomeOf = ({ reason, verdict = 'done' }: Result): string => (reason ? `failed: ${reason}` : verdict);

/** A finding with the pictures that `cagecast inspect --report` draws; its page is beside the report. */
async function figure(result: Result, job: CatalogueJob | undefined): Promise<string> {
  const { key, inputs, verdict, findings = [], why = findings.join(', ') } = result;
  const title = text(`${verdict}: ${inputs['target']} in ${inputs['cage']}`);
  const drawn = job && (await inspection(job).catch(() => undefined));
  if (!drawn) return `<article><h3>${title}</h3><p>${text(why)}</p></article>`;
  await write(`worst/${key}.html`, drawn);
  const pictures = drawn.match(/<img [^>]*src="data:image\/png;base64,[^"]*"[^>]*>/g) ?? [];
  return `<article><h3><a href="worst/${key}.html">${title}</a></h3><p>${text(why)}</p>${pictures.slice(0, 4).join('')}</article>`;
}

/** The page of `cagecast inspect --report` for a job. */
async function inspection(job: CatalogueJob): Promise<string> {
  const { inputs, settings }: JobData = checkedJob(job).data;
  const folder = await mkdtemp(join(tmpdir(), 'catalogue-'));
  try {
    for (const name of ['target', 'cage'])
      await writeFile(join(folder, `${name}.glb`), await read(inputs[name]!.place));
    const { locks, steps, ...config } = settings;
    await writeFile(join(folder, 'cagecast.config.json'), JSON.stringify(config));
    const args = [cli, 'inspect', 'target.glb', '--cage', 'cage.glb', '--report', 'page.html', '--quiet'];
    // It exits with 3 for a cage that does not fit, and has written the page then.
    await promisify(execFile)(process.execPath, args, { cwd: folder, timeout: 60_000 }).catch(() => {});
    return await readFile(join(folder, 'page.html'), 'utf8');
  } finally {
    await rm(folder, { recursive: true, force: true });
  }
}

if (import.meta.filename === process.argv[1])
  await command(async (catalogue) => {
    const { values } = parseArgs({
      options: { before: { type: 'string' }, worst: { type: 'string' }, forget: { type: 'boolean' } },
    });
    const worst = Number(values.worst ?? 12);
    if (!(worst >= 0)) throw new Failure('broken', `--worst is "${values.worst}", not a number ≥ 0`);
    const before = values.before && fromCaller(values.before);
    const counts = await report(catalogue, { forget: values.forget, before, worst });
    console.log(`wrote report.html and results.jsonl: ${described(counts)}`);
    return 0;
  });
