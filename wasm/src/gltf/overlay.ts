import { firstInPlace } from '../inspect/geometry.js';
import { imageIsWhole, imageType } from './image.js';
import { InputError } from './input-error.js';
import { determinant } from './matrix.js';
import type { Piece } from './pieces.js';

/** The attribute with the `Zone` of each vertex, a byte: 0 may be painted, other values are Non-Cosmetic Zones. */
export const zoneAttribute = '_NCZ';

/**
 * The distance of the overlay from the surface, as a share of the target's diagonal. With distance 0, most viewers would draw the
 * overlay on top, but path tracers and strict depth tests would show noise. Half a millimetre per metre is invisible, and above the
 * resolution of a 24-bit depth buffer.
 */
export const overlayOffset = 5e-4;

/**
 * Marks overlays in their `extras`, so that they are skipped when the model is read again. `cagecast/three` uses the same name.
 */
export const overlayMark = { cagecastOverlay: true } as const;

/** Whether a primitive with these extras is an overlay. */
export const isOverlay = (extras: object | undefined): boolean =>
  (extras as Partial<typeof overlayMark> | undefined)?.cagecastOverlay === true;

/** The texture to show: a PNG, JPEG or WebP file's bytes, in the cage's UVs. */
export interface Paint {
  name: string;
  mimeType: string;
  bytes: Uint8Array;
}

const imageNames: Record<string, string> = { 'image/png': 'PNG', 'image/jpeg': 'JPEG', 'image/webp': 'WebP' };

/**
 * Checks an image and finds its type.
 * @param types  Those that can be used.
 * @throws {InputError} if it is not a whole file of one of these types.
 */
export function paintOf(
  bytes: Uint8Array,
  name = 'paint',
  types: readonly string[] = ['image/png', 'image/jpeg'],
): Paint {
  const mimeType = imageType(bytes);
  if (mimeType === undefined || !types.includes(mimeType)) {
    const [last, ...others] = types.map((type) => imageNames[type]).reverse();
    throw new InputError(
      others.length === 1
        ? `is neither a ${others[0]} nor a ${last} image`
        : `is not a ${others.reverse().join(', ')} or ${last} image`,
    );
  }
  if (!imageIsWhole(bytes)) throw new InputError(`is truncated: the ${imageNames[mimeType]} image is incomplete`);
  return { name, mimeType, bytes };
}

/** The first free UV set, as the numbers of sets must not have gaps. */
export function freeUvSet(has: (semantic: string) => boolean): string {
  let set = 0;
  while (has(`TEXCOORD_${set}`)) ++set;
  return `TEXCOORD_${set}`;
}

/** The corners of those triangles that may be painted; `cosmetic` is 1 per triangle. */
export function cosmeticCorners(indices: Uint32Array, cosmetic: Uint8Array): Uint32Array {
  return indices.filter((_, corner) => cosmetic[Math.floor(corner / 3)] === 1);
}

/**
 * Whether an overlay copies an attribute of its base: those for lighting and deformation. Not colours, which would tint the texture,
 * nor tangents, which its material does not use.
 */
export const isOverlaid = (semantic: string): boolean =>
  semantic === 'NORMAL' || /^(JOINTS|WEIGHTS)_\d+$/.test(semantic);

/** Whether an overlay copies the deltas of an attribute from its base: if it has the attribute, but not for UVs, which differ. */
export const isMorphed = (semantic: string, hasNormals: boolean): boolean =>
  semantic === 'POSITION' || (semantic === 'NORMAL' && hasNormals);

/** A length in the units of a piece. @param offset  It in units of the scene. */
export const localOffset = ({ matrix }: Pick<Piece, 'matrix'>, offset: number): number =>
  offset / Math.cbrt(Math.abs(determinant(matrix)) || 1);

type Shape = Pick<Piece, 'matrix' | 'localPositions' | 'localIndices'>;

/** The positions of an overlay: those of the piece, moved along their normals by `offset` units of the scene. */
export function overlayPositions(piece: Shape, offset: number): Float32Array {
  const step = localOffset(piece, offset);
  const normals = weldedNormals(piece);
  return piece.localPositions.map((value, i) => value + step * normals[i]!);
}

const integers = { 5120: Int8Array, 5121: Uint8Array, 5122: Int16Array, 5123: Uint16Array };

/** How many steps of integers the offset must be at least. */
const leastSteps = 2;

/**
 * The positions of an overlay as integers of the type that those beneath it have, which takes fewer bytes; as they are if the type
 * is not of integers, or too coarse for the offset. At the ends of the type's range they stay on the surface.
 * @param step  The offset, in units of the piece.
 */
export function inFormOf(
  { componentType, normalized = false }: { componentType: number; normalized?: boolean },
  positions: Float32Array,
  step: number,
): Float32Array | Int8Array | Uint8Array | Int16Array | Uint16Array {
  const type = integers[componentType as keyof typeof integers];
  if (type === undefined) return positions;
  const isSigned = type === Int8Array || type === Int16Array;
  const most = 2 ** (8 * type.BYTES_PER_ELEMENT - (isSigned ? 1 : 0)) - 1;
  const scale = normalized ? most : 1;
  if (step * scale < leastSteps) return positions;
  return (type as typeof Int16Array).from(positions, (x) =>
    Math.max(isSigned ? -most : 0, Math.min(most, Math.round(scale * x))),
  );
}

/**
 * Unit normals, area-weighted, 3 numbers per vertex, the same for all vertices in one place: an overlay that is moved
 * along them does not open at seams. Zero where triangles cancel out.
 */
function weldedNormals({ localPositions: p, localIndices }: Shape): Float64Array {
  const place = firstInPlace(p);
  const sums = new Float64Array(p.length);
  for (let t = 0; t < localIndices.length; t += 3) {
    const [a, b, c] = [3 * localIndices[t]!, 3 * localIndices[t + 1]!, 3 * localIndices[t + 2]!];
    const u = [0, 1, 2].map((k) => p[b + k]! - p[a + k]!) as [number, number, number];
    const v = [0, 1, 2].map((k) => p[c + k]! - p[a + k]!) as [number, number, number];
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    for (const corner of [a, b, c]) for (let k = 0; k < 3; ++k) sums[3 * place[corner / 3]! + k]! += normal[k]!;
  }
  const out = new Float64Array(p.length);
  for (let v = 0; v < place.length; ++v) {
    const from = 3 * place[v]!;
    const length = Math.hypot(sums[from]!, sums[from + 1]!, sums[from + 2]!);
    if (length > 0) for (let k = 0; k < 3; ++k) out[3 * v + k] = sums[from + k]! / length;
  }
  return out;
}

/** The diagonal of the points' box. */
export function diagonal(positions: Float32Array): number {
  const min = [Infinity, Infinity, Infinity];
  const max = [-Infinity, -Infinity, -Infinity];
  positions.forEach((value, i) => {
    min[i % 3] = Math.min(min[i % 3]!, value);
    max[i % 3] = Math.max(max[i % 3]!, value);
  });
  return positions.length > 0 ? Math.hypot(max[0]! - min[0]!, max[1]! - min[1]!, max[2]! - min[2]!) : 0;
}
