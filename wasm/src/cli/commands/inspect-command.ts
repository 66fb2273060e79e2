import type { Command } from 'commander';
import { counted, percent } from '../../inspect/finding.js';
import type { Io } from '../io/io.js';
import { writeFiles } from '../io/output.js';
import { kExit } from '../model/failures.js';
import { resolveSettings } from '../model/settings.js';
import { configLine, cut, integer, type Line, short, table } from '../model/text.js';
import {
  conclusionOf,
  holeTable,
  type InspectionReport,
  inspectionReport,
  segmentTable,
} from '../transfer/inspection.js';
import { reportFiles } from '../transfer/inspection-page.js';
import { choiceLines, leftOutLines, turnedLine, zoneTable } from '../transfer/report-parts.js';
import { runTransfer } from '../transfer/run-transfer.js';
import * as common from './common-flags.js';
import { type Found, perform } from './perform.js';
import { addTarget, type TargetFlags } from './transfer-command.js';

interface InspectFlags extends TargetFlags {
  report?: string;
}

/** Adds the command that judges a cage. */
export function addInspectCommand(program: Command, io: Io): void {
  const command = addTarget(program.command('inspect'))
    .description('check whether the cage fits TARGET; print a verdict, reasons and advice')
    .addOption(common.reportFlag());
  common.addFlags(command, ...common.transferGroups.slice(1));
  command
    .addHelpText(
      'after',
      `
The verdict is good, usable (fits, with reservations) or unfit, with exit code 3. The most important reasons come first.

Example: cagecast inspect head.glb --cage cage.glb --report report.html`,
    )
    .action((target: string, flags: InspectFlags) => {
      const files = { inputs: [target, ...common.inputsOf(flags)], outputs: [flags.report] };
      return perform(io, flags, files, () => inspectTarget(target, flags, io));
    });
}

/** Checks whether a cage fits a target. @throws {InputError} that names the file at fault. */
async function inspectTarget(target: string, flags: InspectFlags, io: Io): Promise<Found> {
  const { cageUvs, uvBounds, referenceCage } = flags.set ?? {};
  const { rules } = resolveSettings(await common.layersFor(flags)(target));
  const sources = {
    target,
    ...common.aroundOf(flags, target),
    cageUvs,
    uvBounds,
    referenceCage,
    rules,
    reading: common.readingOf(flags),
  };
  const run = await runTransfer(sources, io);
  io.step('inspecting');
  const report = inspectionReport(sources, run, uvBounds ? [uvBounds] : []);
  writeFiles(reportFiles(flags.report, report, run), io);
  const exitCode = report.verdict === 'unfit' ? kExit.unfit : 0;
  return { lines: describe(report, flags.report), report, exitCode };
}

/** How many rows a table has at most. */
const kMaxRows = 15;

function describe(report: InspectionReport, written: string | undefined): Line[] {
  const { target, cage, counts, coverage, placement, inside, inward, topology, uv, holes, segments } = report;
  const { outside, distances } = placement;
  const cutNames = (rows: string[][]) => table(rows.map(([name, ...cells]) => [cut(name!, 50), ...cells]));
  const more = (n: number) => (n > kMaxRows ? `, the ${kMaxRows} largest` : '');
  return [
    `target  ${target.file}: ${integer(target.vertices)} vertices (${integer(target.points)} points), ${integer(target.triangles)} triangles, diagonal ${short(target.diagonal)}`,
    `cage    ${cage.file}: ${integer(cage.vertices)} vertices, ${integer(cage.triangles)} triangles`,
    '',
    'zones',
    ...zoneTable(counts, coverage),
    '',
    'fit (lengths as shares of the diagonal)',
    `  outside the cage: ${percent(outside.vertices)} of the vertices, ${percent(outside.area)} of the area; ${percent(outside.exposedArea)} of the exposed area by more than 0.25 %`,
    `  distance to the cage: median ${percent(distances.p50)}, 90 % within ${percent(distances.p90)}, 99 % within ${percent(distances.p99)}, most ${percent(distances.max)}`,
    `  cage vertices inside the target: ${integer(inside.vertices)} (${percent(inside.area)} by area)`,
    '',
    'cage',
    `  facing inward: ${counted(inward.triangles.length, 'triangle')}; without area: ${integer(topology.degenerateTriangles)}; doubled: ${integer(topology.doubledTriangles)}; edges of more than two triangles: ${integer(topology.nonManifoldEdges)}; cracks: ${integer(topology.crackEdges + topology.slits)}; pieces: ${integer(topology.pieces)}`,
    `  UVs: ${counted(uv.charts, 'chart')}, ${counted(uv.seams.edges, 'seam edge')}, ${percent(uv.used)} of the texture in use, ${percent(uv.overlap.share)} of that twice; ${counted(uv.outside.vertices, 'vertex', 'vertices')} outside 0..1; ${counted(uv.withoutArea.triangles, 'triangle')} without area`,
    '',
    `holes: ${integer(holes.length)}${more(holes.length)}`,
    ...(holes.length === 0 ? [] : cutNames(holeTable(holes, kMaxRows))),
    '',
    `segments: ${integer(segments.length)}${more(segments.length)}`,
    ...cutNames(segmentTable(segments, kMaxRows)),
    '',
    ...choiceLines(cage),
    ...conclusionOf(report),
    written && `wrote ${written}`,
    turnedLine(cage),
    ...leftOutLines(target),
    configLine(report.options.config),
  ];
}
