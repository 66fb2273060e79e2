import { dirname, join } from 'node:path';
import type { Form } from '../../gltf/glb-writer.js';
import { zoneAttribute } from '../../gltf/overlay.js';
import { counted, isWorse } from '../../inspect/finding.js';
import type { Io } from '../io/io.js';
import { refuseOverwriting, writeFiles } from '../io/output.js';
import type { TransferCommand } from '../model/sources.js';
import { configLine, integer, jsonText, type Line, takenAway } from '../model/text.js';
import { allFilesReadBy } from './files-read.js';
import { inspectionReport } from './inspection.js';
import type { readModel } from './models.js';
import { compressionOf, transferRegion } from './region.js';
import { makeReport, type Report, regionReport } from './report.js';
import { choiceLines, leftOutLines, turnedLine, uvSetsLine, zoneTable } from './report-parts.js';

/**
 * Runs the transfer and writes the requested files.
 * @param readCage  How cages are read.
 * @returns a summary for people, and the report.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function transferToFile(
  command: TransferCommand,
  io: Io,
  readCage?: typeof readModel,
): Promise<{ lines: Line[]; report: Report }> {
  const { output, compress, inspects, regions = [] } = command;
  const first = await transferRegion(command, command.texture, io, { readCage, isLast: regions.length === 0 });
  // As the target was, if it is to be kept.
  const form: Form = compress === 'keep' ? (compressionOf(first.run) ?? 'keep') : compress;
  const report = makeReport(command, first);
  if (inspects || command.template !== undefined) {
    io.step('inspecting');
    const { verdict, findings } = inspectionReport(command, first.run, first.textures);
    Object.assign(report, { verdict, findings });
  }
  let last = first;
  for (const [r, { cage, texture }] of regions.entries()) {
    const own = {
      ...command,
      cage,
      template: undefined,
      isOwnCage: false,
      cageUvs: undefined,
      uvBounds: undefined,
      referenceCage: undefined,
    };
    last = await transferRegion(own, texture, io, {
      readCage,
      isLast: r === regions.length - 1,
      before: { painted: last.painted, bytes: last.written!.data, form },
      zones: `${zoneAttribute}_${r + 1}`,
    });
    report.regions.push(regionReport({ cage, texture, output }, last));
    if (!inspects) continue;
    const { verdict, findings } = inspectionReport(own, last.run, last.textures);
    if (isWorse(verdict, report.verdict!)) report.verdict = verdict;
    report.findings!.push(...findings.map((finding) => ({ ...finding, sentence: `${cage}: ${finding.sentence}` })));
  }
  const files: { path: string; data: Uint8Array | string }[] = [];
  if (output !== undefined) {
    const { data, beside } = last.written!;
    const others = beside.map(({ name, data }) => ({ path: join(dirname(output), name), data }));
    files.push({ path: output, data }, ...others);
  }
  if (command.report !== undefined) files.push({ path: command.report, data: jsonText(report, 2) });
  refuseOverwriting(
    allFilesReadBy(command, first.run),
    files.map(({ path }) => path),
  );
  writeFiles(files, io);
  return { lines: summary(command, report), report };
}

/** The report for people. */
function summary(command: TransferCommand, report: Report): Line[] {
  const { target, cage, counts, areas, triangles, cut, segments, regions, timings, output, note, verdict } = report;
  const culled = segments.filter((segment) => segment.culled).length;
  const { outOfBounds = 0 } = cut?.triangles ?? triangles;
  const cutText = cut ? `; cut along borders, ${shareOf(cut.triangles)}` : '';
  return [
    `${command.target}: ${integer(target.vertices)} vertices, ${integer(target.triangles)} triangles, ${counted(segments.length, 'segment')} (${integer(culled)} culled)`,
    ...zoneTable(counts, areas, areas.total),
    `${shareOf(triangles)} triangles may be painted${cutText}; ${timings.total.toFixed(1)} ms`,
    ...choiceLines(cage),
    verdict && `the cage is ${verdict}`,
    turnedLine(cage),
    uvSetsLine(cage),
    note,
    outOfBounds > 0 &&
      `${integer(outOfBounds)} more could be painted, but lie outside of uvBounds; zones do not depend on the bounds`,
    ...(output === null ? [] : outputLines(output, report)),
    ...regions.flatMap((one) => [
      `${one.cage}: ${shareOf(one.triangles)} triangles more may be painted, by ${one.texture}`,
      turnedLine(one),
      uvSetsLine(one, 'leave no other in its file'),
    ]),
    command.report !== undefined && `wrote ${command.report}`,
    ...leftOutLines(target),
    configLine(command.rules.config),
    output === null &&
      command.report === undefined &&
      'nothing written; to save the result, add -o OUT.glb or --report R.json',
  ];
}

const shareOf = ({ cosmetic, total }: { cosmetic: number; total: number }): string =>
  `${integer(cosmetic)} of ${integer(total)}`;

/** What was written to a file. */
function outputLines(output: string, { texture, parts, replacedOverlays }: Report): Line[] {
  const sets = [...new Set(parts.map((part) => part.uvSet))].join(', ');
  const splits = parts.reduce((sum, { splitVertices }) => sum + (splitVertices ?? 0), 0);
  const hasOverlay = parts.some(({ overlayTriangles }) => overlayTriangles > 0);
  const filled = new Set(parts.filter(({ fillsCutOuts }) => fillsCutOuts).map(({ name }) => `“${name}”`));
  const notes = [
    `wrote ${output}: ${sets}, ${zoneAttribute}`,
    texture === null
      ? ''
      : hasOverlay
        ? ', and an overlay with the texture'
        : '; no overlay, as the texture shows nowhere',
    splits === 0 ? '' : `; ${counted(splits, 'vertex', 'vertices')} split at seams of the texture`,
    replacedOverlays === 0 ? '' : `; ${takenAway(replacedOverlays)}`,
  ];
  return [
    notes.join(''),
    filled.size > 0 &&
      `the overlay fills what the material cuts out of ${[...filled].join(', ')}; cagecast bake paints only the rest`,
  ];
}
