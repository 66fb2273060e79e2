import { readdir } from 'node:fs/promises';
import { join } from 'node:path';
import type { Command } from 'commander';
import { counted, isWorse, percent } from '../../inspect/finding.js';
import { InputError, naming } from '../../scene/input-error.js';
import { isFolder, listingError } from '../io/files.js';
import type { Io } from '../io/io.js';
import { kExit } from '../model/failures.js';
import { cut, integer, short, table } from '../model/text.js';
import { kZoneNames, type PerZone } from '../model/zones.js';
import * as common from './common-flags.js';
import { type AnyReport, readReport } from './diff-report.js';
import { type Found, perform } from './perform.js';

/** The arguments of `cagecast diff`. */
interface DiffCommand {
  before: string;
  after: string;
  /** How much a share may change. */
  tolerance: number;
}

/** Adds the command that compares reports. */
export function addDiffCommand(program: Command, io: Io): void {
  const command = program
    .command('diff')
    .argument('<BEFORE>', 'a report of transfer, or of inspect --json, or a folder of reports, with its subfolders')
    .argument('<AFTER>', 'another; of folders, reports of the same names are compared')
    .description('show what changed between two reports: zones, parts, regions, stretch, distances, borders, verdict')
    .addOption(
      common
        .parsed(
          '--tolerance <SHARE>',
          'how much a share, or the stretch of the texture, may change; 0 to 1',
          common.numberWithin(0, 1),
        )
        .default(0.01),
    );
  common.addFlags(command, 'Printing');
  command
    .addHelpText(
      'after',
      `
Exit code 4: a share changed by more than the tolerance, the verdict is worse, a part or a region is new or gone, or a report is gone.

Example: cagecast diff approved build --tolerance 0.005`,
    )
    .action((before: string, after: string, flags: common.PrintFlags & { tolerance: number }) =>
      perform(io, flags, { inputs: [before, after], outputs: [] }, () =>
        diff({ before, after, tolerance: flags.tolerance }),
      ),
    );
}

/** A measure that two reports have. Shares, and ratios of lengths, are compared with the tolerance; a number is only shown. */
interface Change {
  measure: string;
  kind: 'share' | 'ratio' | 'number' | 'verdict' | 'part';
  before: number | string | null;
  after: number | string | null;
  isOver: boolean;
}

/** Two kinds of reports may round a sum differently. */
const kRounding = 1e-9;

/** What changed between two reports. */
interface Difference {
  over: number;
  changes: Change[];
}

const exitCodeOf = (over: number): number => (over > 0 ? kExit.changed : 0);

/**
 * Compares two reports, or all that two folders have by the same names.
 * @throws {InputError} that names the file that is no report.
 */
async function diff(command: DiffCommand): Promise<Found> {
  const areFolders = await Promise.all(
    [command.before, command.after].map((path) => naming(path, () => isFolder(path))),
  );
  if (areFolders[0] !== areFolders[1])
    throw new InputError('is a folder, and the other is a file; compare two files or two folders').in(
      areFolders[0] ? command.before : command.after,
    );
  if (areFolders[0]) return diffFolders(command);
  const found = await diffReports(command);
  return {
    lines: linesOf(found, command.tolerance),
    report: { ...command, ...found },
    exitCode: exitCodeOf(found.over),
  };
}

/** Compares reports of the same name. One that is gone counts as a change over the limit, a new one does not. */
async function diffFolders({ before, after, tolerance }: DiffCommand): Promise<Found> {
  const [old, now] = [await reportsIn(before), await reportsIn(after)];
  const gone = old.filter((name) => !now.includes(name));
  const added = now.filter((name) => !old.includes(name));
  const both = old.filter((name) => now.includes(name));
  const reports: (Difference & { name: string })[] = [];
  for (const name of both)
    reports.push({
      name,
      ...(await diffReports({ before: join(before, name), after: join(after, name), tolerance })),
    });
  const over = gone.length + sum(reports.map((report) => report.over))!;
  const changed = reports
    .map((report) => ({ name: report.name, lines: linesOf(report, tolerance) }))
    .filter(({ lines }) => lines[0] !== kUnchanged);
  const lines = [
    ...changed.flatMap((report) => [report.name, ...report.lines]),
    ...gone.map((name) => `gone: ${name}`),
    ...added.map((name) => `new: ${name}`),
    `${counted(both.length, 'report')} compared: ${integer(changed.length)} changed, ${integer(reports.filter((report) => report.over > 0).length)} over the limit; ${integer(gone.length)} gone, ${integer(added.length)} new`,
  ];
  return { lines, report: { before, after, tolerance, over, reports, gone, new: added }, exitCode: exitCodeOf(over) };
}

async function reportsIn(folder: string): Promise<string[]> {
  const all = await readdir(folder, { recursive: true }).catch((error) => {
    throw listingError(error);
  });
  const names = all.filter((name) => name.endsWith('.json')).sort();
  if (names.length === 0) throw new InputError('has no reports (*.json)').in(folder);
  return names;
}

async function diffReports({ before, after, tolerance }: DiffCommand): Promise<Difference> {
  const [old, now] = [await readReport(before), await readReport(after)];
  // Reports of `inspect` are about one cage.
  if (!old.regions || !now.regions) for (const report of [old, now]) delete report.regions;
  const changes = [...compare(measuresOf(old), measuresOf(now), tolerance), ...compareVerdicts(old, now)].filter(
    (change) => change.before !== change.after,
  );
  return { over: changes.filter(({ isOver }) => isOver).length, changes };
}

const kUnchanged = 'nothing changed';

/** A difference for people. */
function linesOf({ changes, over }: Difference, tolerance: number): string[] {
  const rows = changes
    .map((change) => [
      cut(change.measure, 60),
      shown(change, change.before),
      shown(change, change.after),
      change.isOver ? 'over' : '',
    ])
    // What reads the same is for programs only.
    .filter(([, was, is, isOver]) => was !== is || isOver);
  if (rows.length === 0) return [kUnchanged];
  const count = `${counted(rows.length, 'change')}, ${integer(over)} over the limit (${percent(tolerance)} of a share or of a length, a worse verdict, a part or a region more or less)`;
  return [...table([['', 'before', 'after', ''], ...rows]), count];
}

function shown({ kind }: Change, value: Change['before']): string {
  if (value === null) return '–';
  if (typeof value === 'string') return value;
  return kind === 'share' ? percent(value) : kind === 'ratio' ? short(value) : integer(value);
}

type Measures = Map<string, { kind: 'share' | 'ratio' | 'number' | 'part'; value: number }>;

/** What a report says, by name. */
function measuresOf(report: AnyReport): Measures {
  const { areas, coverage, target, triangles, stretch, segments, parts, placement, uv, holes, regions } = report;
  const all: Measures = new Map();
  const share = (name: string, value: number | undefined) => {
    if (value !== undefined && Number.isFinite(value)) all.set(name, { kind: 'share', value });
  };
  const number = (name: string, value: number | undefined) => {
    if (value !== undefined) all.set(name, { kind: 'number', value });
  };
  const zones: PerZone | undefined = areas ?? coverage;
  for (const zone of kZoneNames) share(`area ${zone}`, zones && zones[zone] / (areas?.total || 1));
  share('triangles painted', triangles && triangles.cosmetic / (triangles.total || 1));
  for (const [part, { exposed, covered, area, culled }] of perPart(segments)) {
    all.set(`part ${part}`, { kind: 'part', value: 1 });
    share(`part ${part}: covered`, exposed > 0 ? covered / exposed : undefined);
    share(`part ${part}: culled`, area > 0 ? culled / area : undefined);
  }
  for (const [r, { counts, triangles }] of (regions ?? []).entries()) {
    const region = `region ${r + 1}`;
    all.set(region, { kind: 'part', value: 1 });
    share(`${region}: triangles painted`, triangles.cosmetic / (triangles.total || 1));
    for (const zone of kZoneNames)
      share(`${region}: vertices ${zone}`, counts[zone] / (sum(kZoneNames.map((one) => counts[one])) || 1));
  }
  share('painted area stretched more than twice', stretch?.overTwice);
  // By the size of the target, which may have another unit.
  if (stretch) all.set('stretch, median', { kind: 'ratio', value: stretch.median / (target.diagonal || 1) });
  share('outside the cage', placement?.outside.area);
  share('distance to the cage, median', placement?.distances.p50);
  share('distance to the cage, 99 % within', placement?.distances.p99);
  share('texture in use', uv?.used);
  share('texture in use twice', uv?.overlap.share);
  number('holes', holes?.length);
  number('charts', uv?.charts);
  number('vertices', target.vertices);
  number('triangles', target.triangles);
  number('segments', segments.length);
  number('vertices split at seams', sum(parts?.map(({ splitVertices }) => splitVertices)));
  number('triangles added by cutting', sum(parts?.map(({ cutTriangles }) => cutTriangles)));
  return all;
}

const sum = (values: (number | null)[] | undefined): number | undefined =>
  values?.reduce<number>((total, value) => total + (value ?? 0), 0);

function perPart(segments: AnyReport['segments']) {
  const parts = new Map<string, { area: number; culled: number; exposed: number; covered: number }>();
  for (const { part, area, exposedArea, coveredArea, culled } of segments) {
    const all = parts.get(part) ?? { area: 0, culled: 0, exposed: 0, covered: 0 };
    all.area += area;
    if (culled) all.culled += area;
    all.exposed += exposedArea;
    all.covered += coveredArea;
    parts.set(part, all);
  }
  return parts;
}

function compare(before: Measures, after: Measures, tolerance: number): Change[] {
  return [...new Set([...before.keys(), ...after.keys()])].flatMap((measure): Change[] => {
    const [old, now] = [before.get(measure), after.get(measure)];
    const { kind } = (old ?? now)!;
    // Only one of the two kinds of reports has it, or the part is not there.
    if ((!old || !now) && kind !== 'part') return [];
    const change = kind === 'ratio' ? now!.value / old!.value - 1 : kind === 'share' ? now!.value - old!.value : 0;
    const isOver = kind === 'part' || Math.abs(change) > tolerance + kRounding;
    const value = (one: typeof old) => (kind === 'part' ? (one ? 'there' : null) : one!.value);
    return [{ measure, kind, before: value(old), after: value(now), isOver }];
  });
}

function compareVerdicts({ verdict: before }: AnyReport, { verdict: after }: AnyReport): Change[] {
  if (before === undefined || after === undefined) return [];
  return [{ measure: 'verdict', kind: 'verdict', before, after, isOver: isWorse(after, before) }];
}
