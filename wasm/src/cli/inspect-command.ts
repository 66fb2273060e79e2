import { diagonal } from '../gltf/write.js';
import { cageShape, perZone, quantiles, sidesOf, vertexAreas, type CageShape, type PerZone } from './analysis.js';
import type { Progress } from './progress.js';
import { run } from './run.js';
import { cut, integer, percent, short, table } from './table.js';
import type { TransferOptions } from '../index.js';

/** What `cagecast inspect` was asked for. */
export interface InspectCommand {
  target: string;
  cage: string;
  json: boolean;
  options: Required<Pick<TransferOptions, 'preset' | 'threshold' | 'weldTolerance'>>;
}

/** Shares that `distances` reports. */
const distanceShares = { p50: 0.5, p90: 0.9, p99: 0.99, max: 1 } as const;
/** How far outside the cage a vertex may lie, as a share of the diagonal, before it counts as poking through. */
const pokeThrough = 0.0025;
/** The most of the exposed area that pokes through a good cage; of bad ones it was more than 0.12. */
const mostOutside = 0.07;
/** The most that a cage stands off its target at the median, as a share of the diagonal. */
const farCage = 0.15;

/** Something about the cage that its author should know. */
export interface Finding {
  level: 'bad' | 'note';
  /** What is the matter, with its number. */
  text: string;
  /** What to do about it. */
  advice: string;
}

/** Is this cage fit for this target? Lengths are shares of the target's diagonal where not said otherwise. */
export interface Inspection {
  fit: boolean;
  findings: Finding[];
  target: { file: string; vertices: number; triangles: number; points: number; diagonal: number };
  cage: { file: string; vertices: number; triangles: number } & CageShape;
  options: InspectCommand['options'];
  counts: PerZone;
  /** Share of the target's area in each zone. */
  coverage: PerZone;
  /**
   * Share of the target that lies on the outer side of the cage: of its vertices, of its area, and, farther out than
   * `pokeThrough`, of the area that nothing occludes and that lies over the cage, not beside its open borders.
   */
  outside: { vertices: number; area: number; exposedArea: number };
  /** Distance from target to cage: quantiles over the vertices. */
  distances: { p50: number; p90: number; p99: number; max: number };
  segments: { points: number; exposedArea: number; coveredArea: number; coverage: number; culled: boolean }[];
}

/**
 * Finds out whether a cage fits a target.
 * @returns text for people, or JSON.
 * @throws {InputError} that names the file at fault.
 */
export async function inspectCommand(command: InspectCommand, progress: Progress): Promise<string> {
  const inspection = await inspect(command, progress);
  return command.json ? JSON.stringify(inspection, null, 2) : describe(inspection);
}

async function inspect(command: InspectCommand, progress: Progress): Promise<Inspection> {
  const { target, cage, result } = await run(command.target, command.cage, command.options, progress);
  const { mesh } = target;
  const vertices = mesh.positions.length / 3;
  const size = diagonal(mesh.positions) || 1;
  const areas = vertexAreas(mesh);
  const total = areas.reduce((sum, area) => sum + area, 0) || 1;
  const share = (sums: PerZone): PerZone => ({
    cosmetic: sums.cosmetic / total,
    occluded: sums.occluded / total,
    uncovered: sums.uncovered / total,
    culled: sums.culled / total,
  });

  const { signedDistances, onBorder } = sidesOf(cage.mesh, mesh, result);
  let [outsideVertices, outsideArea, exposed, exposedOutside] = [0, 0, 0, 0];
  signedDistances.forEach((distance, v) => {
    if (distance > 0) {
      ++outsideVertices;
      outsideArea += areas[v]!;
    }
    if (result.zones[v] === 1 || onBorder[v] === 1) return;
    exposed += areas[v]!;
    if (distance > pokeThrough * size) exposedOutside += areas[v]!;
  });
  const [p50 = 0, p90 = 0, p99 = 0, max = 0] = quantiles(result.distances, Object.values(distanceShares)).map((d) => d / size);

  const counts = perZone(result.zones);
  const inspection: Inspection = {
    fit: true,
    findings: [],
    target: {
      file: command.target,
      vertices,
      triangles: mesh.indices.length / 3,
      points: result.segmentStats.reduce((sum, { points }) => sum + points, 0),
      diagonal: size,
    },
    cage: { file: command.cage, vertices: cage.mesh.positions.length / 3, triangles: cage.mesh.indices.length / 3, ...cageShape(cage.mesh) },
    options: command.options,
    counts,
    coverage: share(perZone(result.zones, areas)),
    outside: { vertices: outsideVertices / vertices, area: outsideArea / total, exposedArea: exposed > 0 ? exposedOutside / exposed : 0 },
    distances: { p50, p90, p99, max },
    segments: result.segmentStats.map(({ points, exposedArea, coveredArea, coverage, culled }) => ({ points, exposedArea, coveredArea, coverage, culled })),
  };
  inspection.findings = findings(inspection);
  inspection.fit = inspection.findings.every(({ level }) => level !== 'bad');
  return inspection;
}

function findings({ outside, coverage, distances, cage, counts }: Inspection): Finding[] {
  const found: Finding[] = [];
  const add = (level: Finding['level'], text: string, advice: string) => found.push({ level, text, advice });
  if (outside.area > 0.8) {
    add('bad', `${percent(outside.area)} of the target lies on the outer side of the cage: it is inside out, or somewhere else`, 'turn its triangles round, so that they are counter-clockwise seen from outside; check its place and unit');
  } else if (outside.exposedArea > mostOutside) {
    add('bad', `${percent(outside.exposedArea)} of the exposed target pokes out of the cage by more than ${percent(pokeThrough)} of its diagonal`, 'move the cage onto the target, or grow it along its normals');
  }
  if (distances.p50 > farCage) add('bad', `half of the target is farther than ${percent(distances.p50)} of its diagonal from the cage`, 'check that both have the same place and unit; fit the cage more closely');
  if (counts.cosmetic === 0) add('bad', 'nothing of the target may be painted', 'see the zones above for the reason');
  else if (coverage.culled > 0.3) add('note', `${percent(coverage.culled)} of the target is culled, as too little of its segments is covered`, 'if some of it should be painted, close holes of the cage over it, or lower --threshold');
  if (cage.degenerateTriangles > 0) add('note', `${integer(cage.degenerateTriangles)} of the cage's triangles have no area and take no part`, 'remove them');
  if (cage.nonManifoldEdges > 0) add('note', `${integer(cage.nonManifoldEdges)} edges of the cage belong to more than two triangles`, 'remove inner faces');
  if (cage.uvsOutside > 0) add('note', `${integer(cage.uvsOutside)} of the cage's UVs lie outside 0..1`, 'fine with a repeating texture; otherwise move them in');
  return found;
}

function describe({ fit, findings, target, cage, counts, coverage, outside, distances, segments }: Inspection): string {
  const most = 20;
  const listed = segments
    .map((segment, s) => ({ ...segment, s }))
    .sort((a, b) => b.exposedArea - a.exposedArea || a.s - b.s)
    .slice(0, most);
  const zones = ['cosmetic', 'occluded', 'uncovered', 'culled'] as const;
  return [
    `target  ${target.file}: ${integer(target.vertices)} vertices (${integer(target.points)} points), ${integer(target.triangles)} triangles, diagonal ${short(target.diagonal)}`,
    `cage    ${cage.file}: ${integer(cage.vertices)} vertices, ${integer(cage.triangles)} triangles, ${integer(cage.openLoops)} holes or open rims`,
    '',
    'zones',
    table([['', 'vertices', 'area'], ...zones.map((zone) => [zone, integer(counts[zone]), percent(coverage[zone])])]),
    '',
    `outside the cage: ${percent(outside.vertices)} of the vertices, ${percent(outside.area)} of the area, ${percent(outside.exposedArea)} of the exposed area by more than ${percent(pokeThrough)} of the diagonal`,
    `distance to the cage, as a share of the diagonal: median ${percent(distances.p50)}, 90 % within ${percent(distances.p90)}, 99 % within ${percent(distances.p99)}, most ${percent(distances.max)}`,
    '',
    `segments: ${integer(segments.length)}${segments.length > most ? `, the ${most} with the most exposed area` : ''}`,
    table([
      ['segment', 'points', 'exposed E', 'covered C', 'F = C/E', ''],
      ...listed.map(({ s, points, exposedArea, coveredArea, coverage: f, culled }) => [cut(String(s), 12), integer(points), short(exposedArea), short(coveredArea), f.toFixed(3), culled ? 'culled' : '']),
    ]),
    '',
    ...findings.flatMap(({ level, text, advice }) => [`${level === 'bad' ? 'BAD' : 'note'}: ${text}`, `  → ${advice}`]),
    fit ? 'The cage fits.' : 'The cage does not fit.',
  ].join('\n');
}
