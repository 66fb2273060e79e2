import { kBrow, kEye, kLids, kLips, kMiddle, kMouth, kRight, type Uv } from './face-mesh-uvs.js';
import type { CageExtras, TemplateMesh } from './template.js';

/** Of MediaPipe's canonical face: its points, and its triangles with filled eyes and mouth. */
const kPoints = 468;
const kMaxTriangles = 898;

/** Points are at least 0.0029 apart, and at most 0.0012 off the mirror images of others. */
const kMaxOff = 0.0014;

/** The centre of an eye lies this far behind the middle of its corners, in widths between them. */
const kEyeDepth = 0.4;

const mirrored = ([u, v]: Uv): Uv => [1 - u, v];

/**
 * MediaPipe's canonical face, in which face paint for augmented reality is drawn: recognised by its UVs and the count of its points,
 * in any order, place and size, with or without vertices split at seams.
 * @returns its landmarks, holes and regions, and its triangles without those that fill eyes and mouth; undefined for other meshes.
 */
export function faceMesh({
  positions,
  uvs,
  indices,
}: TemplateMesh): (CageExtras & Pick<TemplateMesh, 'indices'>) | undefined {
  if (indices.length > 3 * kMaxTriangles) return;
  const used = [...new Set(indices)];
  const placeOf = (v: number) => positions.subarray(3 * v, 3 * v + 3).join();
  if (new Set(used.map(placeOf)).size !== kPoints) return;

  let isFace = true;
  /** The vertices at a spot: several if they are split. */
  const verticesAt = ([u, v]: Uv): number[] => {
    const distance = (i: number) => Math.hypot(uvs[2 * i]! - u, uvs[2 * i + 1]! - v);
    const nearest = used.reduce((best, i) => (distance(i) < distance(best) ? i : best));
    isFace &&= distance(nearest) < kMaxOff;
    return used.filter((i) => placeOf(i) === placeOf(nearest));
  };
  const positionAt = (spot: Uv) => {
    const [x, y, z] = positions.subarray(3 * verticesAt(spot)[0]!);
    return [x!, y!, z!] as [number, number, number];
  };

  const landmarks: CageExtras['landmarks'] = {};
  for (const [name, spot] of Object.entries(kMiddle)) landmarks[name] = positionAt(spot);
  for (const [name, spot] of Object.entries(kRight)) {
    landmarks[`${name}_left`] = positionAt(mirrored(spot));
    landmarks[`${name}_right`] = positionAt(spot);
  }
  const holes = {
    eye_left: kEye.map(mirrored).flatMap(verticesAt),
    eye_right: kEye.flatMap(verticesAt),
    mouth: [...kMouth, ...kMouth.map(mirrored)].flatMap(verticesAt),
  };
  if (!isFace) return;
  addEyeCentres(landmarks);
  const regions = {
    lips: [[...kLips, ...kLips.slice(1, -1).reverse().map(mirrored)]],
    eyelids: [kLids, kLids.map(mirrored)],
    brows: [kBrow, kBrow.map(mirrored)],
  };
  return { landmarks, holes, kind: 'head', regions, indices: withoutFills(indices, Object.values(holes)) };
}

/** Adds the centres of the eyes, which are behind the face: against the direction that it looks in. */
function addEyeCentres(landmarks: CageExtras['landmarks']): void {
  const at = (name: string) => landmarks[name]!;
  const minus = (a: readonly number[], b: readonly number[]) => a.map((x, k) => x - b[k]!);
  const [lx, ly, lz] = minus(at('eye_outer_left'), at('eye_outer_right'));
  const [ux, uy, uz] = minus(at('nasion'), at('chin'));
  const front = [ly! * uz! - lz! * uy!, lz! * ux! - lx! * uz!, lx! * uy! - ly! * ux!];
  for (const side of ['left', 'right']) {
    const inner = at(`eye_inner_${side}`);
    const outer = at(`eye_outer_${side}`);
    const depth = (kEyeDepth * Math.hypot(...minus(outer, inner))) / Math.hypot(...front);
    landmarks[`eye_centre_${side}`] = inner.map((x, k) => (x + outer[k]!) / 2 - depth * front[k]!) as [
      number,
      number,
      number,
    ];
  }
}

/** The triangles that do not have all corners on the border of one hole. */
function withoutFills(indices: Uint32Array, holes: readonly number[][]): Uint32Array {
  const borders = holes.map((border) => new Set(border));
  const kept: number[] = [];
  for (let i = 0; i < indices.length; i += 3) {
    const corners = indices.subarray(i, i + 3);
    if (!borders.some((border) => corners.every((v) => border.has(v)))) kept.push(...corners);
  }
  return Uint32Array.from(kept);
}
