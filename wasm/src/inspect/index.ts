// Checks whether a cage fits a target: verdict, reasons and advice.

import { type Mesh, type TransferOptions, type TransferResult, transfer } from '../api/index.js';
import { numbersNamed, type PartOf, type Parts } from '../api/parts.js';
import { CagecastError, show } from '../core/error.js';
import { checkBackward } from './backward.js';
import { checkEyes, checkWindows } from './eyes.js';
import { checkFace, type Spots } from './face.js';
import { type Finding, type FindingCode, type Place, type Verdict, verdictOf } from './finding.js';
import { joined } from './geometry.js';
import { checkHiding } from './hiding.js';
import { checkHoles, type Hole, holesOf, spanPoints } from './holes.js';
import { withoutIgnored } from './ignored.js';
import { checkInside, type Inside, insideOf } from './inside.js';
import { checkLimbs } from './limbs.js';
import { checkNormals, facingOutward, orientationOf } from './normals.js';
import { checkPatches } from './patch.js';
import { checkPieces } from './pieces.js';
import { checkPlacement, type Placement, placementOf } from './placement.js';
import { reverse } from './reverse.js';
import { type PartName, sceneOf } from './scene.js';
import { checkSeam } from './seam.js';
import { checkSegments, hasArea, type Segment, segmentsOf } from './segments.js';
import { surestThreshold } from './surest-threshold.js';
import { checkTopology, type Topology, topologyOf } from './topology.js';
import { checkUvs, type UvLayout, uvLayoutOf } from './uv.js';

export type { Finding, FindingCode, Hole, Inside, Place, Placement, Segment, Spots, Topology, UvLayout, Verdict };
export { verdictOf };

/** Options of `inspect`: those of the transfer, and its result if there is one. */
export interface InspectOptions extends TransferOptions {
  /** The result of `transfer` for the same arguments, if it was called already. */
  result?: TransferResult | undefined;
  /** Spots of the target, as its made or fitted cage has them. By them face, eyes, hands and ears are looked at. */
  landmarks?: Spots | undefined;
}

/** The result of `inspect`: plain data. */
export interface Inspection {
  verdict: Verdict;
  /** The problems found, the most severe first. */
  findings: Finding[];
  placement: Placement;
  /** The share of the cage's area that faces inward, and the numbers of the triangles. */
  inward: { share: number; triangles: number[] };
  inside: Inside;
  topology: Topology;
  uv: UvLayout;
  /** The cage's holes, the largest first. */
  holes: Hole[];
  /** Those that have an area, in the order of their numbers. */
  segments: Segment[];
  /**
   * The `threshold` that is farthest from the coverage of every segment: in the middle, by ratio, of the widest gap between coverages,
   * of which those below 0.05 count as 0.05. In 0.05..1; 0.5 if nothing of the target is exposed.
   */
  surestThreshold: number;
}

/**
 * Checks whether a cage fits a target, and if not, why, and what to do about it.
 *
 * Cost: 3 to 15 times that of a transfer, and another transfer if triangles face inward.
 * @throws {CagecastError} as `transfer` does.
 *
 * @example
 * await init();
 * const { verdict, findings } = inspect(cage, target);
 * if (verdict === 'unfit') console.warn(findings[0].sentence, findings[0].advice);
 */
export function inspect(cage: Mesh, target: Mesh, options?: InspectOptions): Inspection {
  const { scene, orientation, findings: outcome, ...outcomes } = outcomeOf(cage, target, options);
  const topology = topologyOf(scene);
  const uv = uvLayoutOf(scene);
  const findings = heaviestFirst([...outcome, ...checkTopology(scene, topology), ...checkUvs(scene, uv)]);
  return {
    verdict: verdictOf(findings),
    findings,
    inward: {
      share: orientation.share,
      triangles: [...orientation.inward.keys()].filter((t) => orientation.inward[t] === 1),
    },
    ...outcomes,
    topology,
    uv,
  };
}

const heaviestFirst = (findings: readonly Finding[]): Finding[] => [...findings].sort((a, b) => b.weight - a.weight);

const fn = 'inspect';

/** The placement of the cage, and the findings about it and about the result. */
function outcomeOf(cage: Mesh, whole: Mesh, given: InspectOptions = {}) {
  if (typeof given !== 'object' || given === null)
    throw new CagecastError('badOption', fn, `options is ${show(given)}, not an object`);
  const { result: known, landmarks, parts, ...others } = given;
  if (known !== undefined) {
    checkArrays('cage', cage, ['positions', 'indices', 'uvs']);
    checkArrays('target', whole, ['positions', 'indices']);
    checkResult(known, whole);
  }
  const { target, result } = withoutIgnored(whole, known ?? transfer(cage, whole, { ...others, parts }));
  const options = { ...others, parts: numbered(whole, parts) };
  const scene = sceneOf(cage, target, result, options, partsByGroup(target));
  const orientation = orientationOf(scene);
  const upright = orientation.share > 0 ? uprightScene() : scene;
  const placement = placementOf(upright);
  const reversed = reverse(upright, joined(cage.positions, spanPoints(upright)));
  const inside = insideOf(upright, reversed);
  const holes = holesOf(upright, reversed, cage.positions.length / 3);
  const segments = segmentsOf(scene);
  const findings = [
    ...checkNormals(orientation),
    ...checkBackward(upright.cage, target, upright.result),
    ...checkPlacement(upright, placement),
    ...checkInside(inside),
    ...checkHoles(holes, segments),
    ...checkFace(scene, landmarks),
    ...checkEyes(scene, segments, landmarks),
    ...checkWindows(target),
    ...checkSeam(scene, segments, landmarks),
    ...checkPatches(scene, segments, landmarks),
    ...checkLimbs(scene, segments, landmarks),
    ...checkSegments(scene, segments, options),
    ...checkHiding(scene, options),
    ...checkPieces(scene, options),
  ];
  return {
    scene,
    orientation,
    findings,
    placement,
    inside,
    holes,
    segments: segments.filter(hasArea),
    surestThreshold: surestThreshold(result.segmentStats),
  };

  // One cause, one finding: everything else is judged as if inward-facing triangles were flipped.
  function uprightScene() {
    const outward = facingOutward(cage, orientation);
    return sceneOf(outward, target, transfer(outward, target, options), options, scene.parts);
  }
}

/** Checks that a mesh has arrays: without a transfer, nothing else does. */
function checkArrays(name: string, mesh: Mesh, fields: (keyof Mesh)[]): void {
  for (const field of fields)
    if (!ArrayBuffer.isView(mesh?.[field]))
      throw new CagecastError('badArgument', fn, `${name}.${field} is ${show(mesh?.[field])}, not a typed array`, {
        argument: name,
      });
}

/** Checks that a result is complete and belongs to this target. */
function checkResult(result: TransferResult, { positions }: Mesh): void {
  const wrong = (text: string) =>
    new CagecastError('badArgument', fn, `result${text}; pass what transfer() returned`, { argument: 'result' });
  if (typeof result !== 'object' || result === null) throw wrong(` is ${show(result)}`);
  const { zones, segments, triangles, distances, segmentStats, cosmeticTriangles } = result;
  if (!Array.isArray(segmentStats)) throw wrong(`.segmentStats is ${show(segmentStats)}, not an array`);
  if (!ArrayBuffer.isView(cosmeticTriangles))
    throw wrong(`.cosmeticTriangles is ${show(cosmeticTriangles)}, as in a projection that was not classified`);
  for (const [name, array] of Object.entries({ zones, segments, triangles, distances })) {
    if (!ArrayBuffer.isView(array)) throw wrong(`.${name} is ${show(array)}, not a typed array`);
    if (array.length !== positions.length / 3)
      throw new CagecastError(
        'resultMismatch',
        fn,
        `result.${name} has ${array.length} entries, not 1 for each of the ${positions.length / 3} vertices of target`,
        { argument: 'result', at: array.length },
      );
  }
  const stray = segments.findIndex((segment) => segment >= segmentStats.length);
  if (stray >= 0)
    throw new CagecastError(
      'resultMismatch',
      fn,
      `result.segments[${stray}] = ${segments[stray]} is out of range (${segmentStats.length} segments)`,
      { argument: 'result', at: stray },
    );
}

/** The groups that are kept or excluded. @param parts  Checked by the transfer. */
function numbered({ names = [] }: Mesh, parts: Parts = {}) {
  const all = names.map((own) => ({ names: [own].flat() }));
  const groupsOf = (list: readonly PartOf[] = []) =>
    list.flatMap((part) => (typeof part === 'number' ? part : numbersNamed(part, all)));
  return { keep: groupsOf(parts.keep), exclude: groupsOf(parts.exclude) };
}

/** The ranges of vertices of one group. */
function partsByGroup({ positions, groups, names = [] }: Mesh): PartName[] {
  const vertices = positions.length / 3;
  const parts: PartName[] = [];
  for (let v = 0; v < vertices; ++v) {
    const last = parts.at(-1);
    if (last && (!groups || groups[v] === groups[v - 1])) ++last.vertexCount;
    else parts.push({ name: nameOf(groups?.[v]), firstVertex: v, vertexCount: 1 });
  }
  return parts;

  function nameOf(group: number | undefined): string {
    const [name] = [names[group ?? 0] ?? []].flat();
    return name ?? (group === undefined ? 'target' : `group ${group}`);
  }
}
