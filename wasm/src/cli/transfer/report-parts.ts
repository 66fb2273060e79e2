// What the reports of `transfer` and `inspect` have in common.
import { type Preset, type PresetOptions, presetOptions, type TransferResult } from '../../index.js';
import { percent } from '../../inspect/finding.js';
import { boxOf } from '../../inspect/geometry.js';
import { integer, type Line, listed, table } from '../model/text.js';
import type { Sources } from '../model/transfer-command.js';
import { kZoneNames, type PerZone } from '../model/zones.js';
import type { ReadModel } from './models.js';
import type { Run } from './run.js';

export const versions = (): { cagecast: string; node: string } => ({
  cagecast: CAGECAST_VERSION,
  node: process.versions.node,
});

/** What a report says of a target. */
export interface TargetReport {
  file: string;
  vertices: number;
  triangles: number;
  diagonal: number;
}

export const targetReport = (file: string, { extracted: { mesh } }: ReadModel): TargetReport => ({
  file,
  vertices: mesh.positions.length / 3,
  triangles: mesh.indices.length / 3,
  diagonal: boxOf(mesh.positions).diagonal,
});

/** What a report says of a cage. */
export interface CageReport {
  file: string;
  vertices: number;
  triangles: number;
  /** Of a cage that was made on the way: the names of the parts that are not painted because of them. */
  excluded?: readonly string[];
}

export const cageReport = (file: string, { extracted: { mesh } }: ReadModel, { excluded }: Run): CageReport => ({
  file,
  vertices: mesh.positions.length / 3,
  triangles: mesh.indices.length / 3,
  ...(excluded && { excluded }),
});

/** Vertices and shares of the area in each zone, for people. */
export const zoneTable = (counts: PerZone, areas: PerZone, total = 1): string[] =>
  table([
    ['', 'vertices', 'area'],
    ...kZoneNames.map((zone) => [zone, integer(counts[zone]), percent(areas[zone] / (total || 1))]),
  ]);

/** How many names a line has at most. */
const kMaxNames = 12;

/** Says which parts a cage was made without, if there are any. */
export const excludedLine = ({ excluded = [] }: CageReport): Line =>
  excluded.length > 0 && `excluded from the cage by their names: ${listed(excluded, kMaxNames)}`;

/** All options that a transfer was made with. */
export interface EffectiveOptions
  extends Omit<PresetOptions, 'occlusionReach'>,
    Pick<Sources, 'uvBounds' | 'referenceCage'> {
  preset: Preset;
  /** JSON has no infinite numbers. */
  occlusionReach: number | 'Infinity';
  keep: string[];
  exclude: string[];
  /** If there are any. */
  masks?: { never?: string | undefined; always?: string | undefined; colors?: string | undefined } | undefined;
  /** The configuration file that some of them come from. */
  config: string | null;
}

/** The options in full; needs `init`. */
export function effectiveOptions({
  rules: { preset, single, names, masks, config },
  uvBounds,
  referenceCage,
}: Pick<Sources, 'rules' | 'uvBounds' | 'referenceCage'>): EffectiveOptions {
  const all = { ...presetOptions(preset), ...single };
  const patterns = (lock: string) => [
    ...new Set(names.filter((rule) => rule.lock === lock).map(({ pattern }) => pattern)),
  ];
  const { never, always, colors } = masks;
  // JSON leaves out what is undefined.
  return {
    preset,
    ...all,
    occlusionReach: Number.isFinite(all.occlusionReach) ? all.occlusionReach : 'Infinity',
    keep: patterns('keep'),
    exclude: patterns('exclude'),
    masks: (never ?? always ?? colors) ? { never: never?.path, always: always?.path, colors } : undefined,
    uvBounds,
    referenceCage,
    config: config ?? null,
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
