// What the reports of `transfer` and `inspect` have in common.

import { presetOptions, type TransferResult } from '../../api/index.js';
import type { ReadModel } from '../../gltf/read-model.js';
import { type Bare, bareOf, bareText } from '../../inspect/bare.js';
import { percent } from '../../inspect/finding.js';
import { boxOf } from '../../inspect/geometry.js';
import { leftOutText } from '../../parts/drawn.js';
import type { Sources } from '../model/sources.js';
import { integer, type Line, listed, quoted, table } from '../model/text.js';
import { kZoneNames, type PerZone } from '../model/zones.js';
import type { Chosen } from './made-cage.js';
import type { Run } from './run-transfer.js';

export const versions = () => ({ cagecast: CAGECAST_VERSION, node: process.versions.node });

/** A target in a report; with missing files, left-out parts, and parts that stay bare by name. */
export const targetReport = (
  file: string,
  {
    target: {
      extracted,
      file: { missing },
    },
    diagonal,
    bare = [],
  }: Run,
) => ({
  file,
  vertices: extracted.mesh.positions.length / 3,
  triangles: extracted.mesh.indices.length / 3,
  diagonal: diagonal ?? boxOf(extracted.mesh.positions).diagonal,
  leftOut: extracted.leftOut,
  ...(missing && { missing }),
  bare,
});

export type TargetReport = ReturnType<typeof targetReport>;

/** What a report says of a cage, and whether it was turned. */
export const cageReport = (file: string, { extracted: { mesh } }: ReadModel, { isTurned, choice }: Run) => ({
  file,
  ...choice,
  vertices: mesh.positions.length / 3,
  triangles: mesh.indices.length / 3,
  ...(isTurned && { isTurned }),
  ...(mesh.otherUvSets && { otherUvSets: mesh.otherUvSets }),
});

export type CageReport = ReturnType<typeof cageReport>;

/** What was chosen, and why nothing before it, for people. */
export function choiceLines({ template, tried = [] }: Partial<Chosen> = {}): Line[] {
  if (template === undefined) return [];
  const others = tried.filter((one) => one.template !== template);
  return [
    template === 'made' ? 'a cage was made for this model' : `the template ${template} was fitted`,
    ...others.map(({ template, verdict, reason }) => `  ${template}${verdict ? ` is ${verdict}` : ''}: ${reason}`),
  ];
}

/** Why next to nothing may be painted, if so, and what helps. */
export function bareNote({ target: { extracted }, wholeCage, result }: Run): string | undefined {
  const bare = bareOf(extracted.mesh, result, extracted.parts, wholeCage.extracted.mesh);
  if (!bare) return undefined;
  const keep = `--keep ${quoted(bare.part)}`;
  const advice: Record<Bare['cause'], string> = {
    units: 'give both in the same unit',
    exchanged: 'exchange them',
    elsewhere: 'put both in the same place and unit; cagecast inspect says more',
    uncovered: 'fit the cage around it; cagecast inspect says more',
    hidden: `${bare.hider ? `try --ignore ${quoted(bare.hider)}` : 'leave out what hides it by --ignore'}, or --set occlusionReach=0 if that lies outside the cage`,
    threshold: `try ${keep} or a lower --threshold`,
    floor: `try ${keep} or a lower minCovered by --set`,
    depth: `fit the cage more closely, or try ${keep}`,
    hole: `try ${keep}`,
    lock: 'leave out --exclude',
    mask: 'change the masks',
  };
  return bareText(bare, advice[bare.cause]);
}

/** Vertices and shares of the area in each zone, for people. */
export const zoneTable = (counts: PerZone, areas: PerZone, total = 1): string[] =>
  table([
    ['', 'vertices', 'area'],
    ...kZoneNames.map((zone) => [zone, integer(counts[zone]), percent(areas[zone] / (total || 1))]),
  ]);

/** Says that a cage was turned, if it was. */
export const turnedLine = ({ isTurned }: { isTurned?: boolean }): Line =>
  isTurned && 'the cage faced the other way; turned by half about the vertical axis, it fits clearly better, so it was';

/** Says that nothing tells which UV set of a cage is meant, if so. */
export const uvSetsLine = (
  { otherUvSets = [] }: { otherUvSets?: readonly number[] | undefined },
  advice = `--set cageUvs=${otherUvSets[0]} takes it`,
): Line =>
  otherUvSets.length > 0 &&
  `nothing tells in which UV set of the cage the texture was drawn; with other UVs than the one that was taken: ${otherUvSets.join(', ')}; ${advice}`;

/** How many names a line has at most. */
const kMaxNames = 12;

/** Says which files are missing that a model names, if there are any. */
export const missingLine = (missing: readonly string[] = []): Line =>
  missing.length > 0 && `missing: ${listed(missing, kMaxNames)}`;

/** Names the missing files, and the parts that are left out or stay bare without a flag. */
export const leftOutLines = ({ missing, leftOut, bare }: TargetReport): Line[] => [
  missingLine(missing),
  leftOut.length > 0 && `left out: ${leftOutText(leftOut)}`,
  bare.length > 0 && `bare by their names, unless --keep names them: ${listed(bare, kMaxNames)}`,
];

/** All options that a transfer was made with; needs `init`. */
export function effectiveOptions({
  rules: { preset, single, names, ignored, masks, config },
  cageUvs,
  uvBounds,
  referenceCage,
}: Pick<Sources, 'rules' | 'cageUvs' | 'uvBounds' | 'referenceCage'>) {
  const all = { ...presetOptions(preset), ...single };
  // JSON leaves out what is undefined, and has no infinite numbers.
  const infinite = Object.entries(all).flatMap(([name, value]) => (value === Infinity ? [[name, 'Infinity']] : []));
  const patterns = (lock: string) => [
    ...new Set(names.filter((rule) => rule.lock === lock).map(({ pattern }) => pattern)),
  ];
  const { never, always, colors } = masks;
  return {
    preset,
    ...all,
    ...Object.fromEntries(infinite),
    keep: patterns('keep'),
    exclude: patterns('exclude'),
    ignore: ignored.map(({ pattern }) => pattern),
    masks: (never ?? always ?? colors) ? { never: never?.path, always: always?.path, colors } : undefined,
    cageUvs,
    uvBounds,
    referenceCage,
    config: config ?? null, // the configuration file that some of them come from
  };
}

/** Adds up a weight per vertex (1 by default) for each zone, over a range of vertices. */
export function perZone(
  zones: TransferResult['zones'],
  weights?: Float64Array,
  first = 0,
  end = zones.length,
): PerZone {
  const sums: PerZone = { cosmetic: 0, occluded: 0, uncovered: 0, culled: 0 };
  for (let v = first; v < end; ++v) sums[kZoneNames[zones[v]!]!] += weights ? weights[v]! : 1;
  return sums;
}
