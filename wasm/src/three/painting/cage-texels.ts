import { Box3, Line3, Triangle, Vector2, Vector3 } from 'three';
import type { Rect } from '../gpu/rect.js';
import { connected, neighboursOf, roomIn, type StickerBox } from './connected.js';

/** The arrays of a cage that painting needs. @internal */
export interface CageMesh {
  /** 3 per vertex. */
  positions: Float32Array;
  /** 3 per triangle. */
  indices: Uint32Array;
  /** 2 per vertex. */
  uvs: Float32Array;
}

/** A point on the cage, and its outward normal. */
export interface SurfacePoint {
  point: Vector3;
  /** Of length 1. */
  normal: Vector3;
  /** Where it lies in the texture, if that was asked for. */
  uv?: Vector2;
}

/** What a brush touches between two points: everything within a radius of the line segment between them. @internal */
export interface Capsule {
  from: SurfacePoint;
  to: SurfacePoint;
  /** At `from`. */
  radius: number;
  /** At `to`. Default: `radius`. In between it grows evenly. */
  toRadius?: number;
}

// Width of the gutter around a UV chart, in texels, filled with the colour of its border. Bilinear filtering needs two; the
// others serve the first mipmap levels.
const kGutter = 4;
// At most this many repetitions of the texture are painted for one triangle, in either direction.
const kMaxTiles = 16;
/** The least cosine between the brush's normal and a surface it paints: below it, the surface is the far side of a thin part. */
export const kFacing = -0.25;
/** Texels of 4 numbers for each patch in `table`. */
export const kPatchTexels = 5;

/** A triangle of the cage in the texture; one for each repetition of the texture it reaches, if its UVs leave 0..1. */
interface Patch {
  points: readonly [Vector3, Vector3, Vector3];
  normal: Vector3;
  /** UVs of the first corner. */
  u: number;
  v: number;
  /** Derivatives of the barycentric weights of corners b and c by u and v. */
  shares: readonly [bu: number, bv: number, cu: number, cv: number];
  /** Gradients of u and v in the triangle's plane. */
  alongU: Vector3;
  alongV: Vector3;
  box: Rect;
}

/**
 * Maps each texel of a texture to the triangle of the cage that lies there, and so to a point of the cage. This lets a brush
 * be a ball in space: it paints both sides of a UV seam alike, and has the same size everywhere.
 * @internal
 */
export class CageTexels {
  readonly #patches: Patch[];
  #neighbours: ReturnType<typeof neighboursOf> | undefined;
  /** Per texel the patch that lies there, or in whose gutter it lies; -1 for none. Rows from v = 0. */
  readonly owners: Int32Array;
  /** x of the cage's plane of symmetry. */
  readonly middle: number;
  /** Diagonal of the cage's bounding box. */
  readonly diagonal: number;
  /** Mean distance of neighbouring texels, in the cage's space. */
  readonly pitch: number;

  /**
   * @param size Texels per side.
   * Cost: tens of milliseconds at 1024, and 4 bytes per texel.
   */
  constructor(
    cage: CageMesh,
    readonly size: number,
  ) {
    this.#patches = patchesOf(cage);
    this.owners = new Int32Array(size * size).fill(-1);
    this.#patches.forEach((patch, index) => this.#fill(patch, index));
    this.#widen();
    const { min, max } = new Box3().setFromArray(cage.positions);
    this.middle = (min.x + max.x) / 2;
    this.diagonal = min.distanceTo(max);
    this.pitch = pitchOf(this.#patches) / size;
  }

  /** The point of the cage at a UV, which is repeated outside 0..1; undefined between charts. */
  at(u: number, v: number): SurfacePoint | undefined {
    const [insideU, insideV] = [u - Math.floor(u), v - Math.floor(v)];
    const uv = new Vector2(insideU, insideV);
    const patch = this.#patches[this.#ownerAt(uv)];
    if (!patch) return undefined;
    return { point: pointOf(patch, insideU, insideV), normal: patch.normal.clone(), uv };
  }

  /** The closest point of the triangles that face `outside`. Cost: visits all triangles. */
  nearest(point: Vector3, outside: Vector3): SurfacePoint | undefined {
    const triangle = new Triangle();
    const found = new Vector3();
    let nearest: SurfacePoint | undefined;
    let least = Infinity;
    for (const { points, normal, u, v, alongU, alongV } of this.#patches) {
      // The distance to the plane bounds the distance to the triangle.
      if (normal.dot(outside) <= 0 || Math.abs(found.subVectors(point, points[0]).dot(normal)) >= least) continue;
      triangle.set(...points).closestPointToPoint(point, found);
      const distance = found.distanceTo(point);
      if (distance >= least) continue;
      const from = found.clone().sub(points[0]);
      const uv = new Vector2(u + from.dot(alongU), v + from.dot(alongV));
      [least, nearest] = [distance, { point: found.clone(), normal, uv }];
    }
    return nearest;
  }

  /** The point mirrored at the plane of symmetry. */
  mirrored({ point, normal }: SurfacePoint): SurfacePoint {
    return {
      point: new Vector3(2 * this.middle - point.x, point.y, point.z),
      normal: new Vector3(-normal.x, normal.y, normal.z),
    };
  }

  /** The patches for a shader, `kPatchTexels` × 4 numbers each: a, u; b, v; c, 0; shares; normal, 0. */
  table(): Float32Array {
    return Float32Array.from(
      this.#patches.flatMap(({ points: [a, b, c], normal, u, v, shares }) => [
        ...a,
        u,
        ...b,
        v,
        ...c,
        0,
        ...shares,
        ...normal,
        0,
      ]),
    );
  }

  /**
   * The parts of the texture that a brush touches, in shares; conservative, and they may overlap.
   * @param without Indices of patches to leave out.
   */
  touched({ from, to, ...radii }: Capsule, without: ReadonlySet<number>): Rect[] {
    const radius = Math.max(radii.radius, radii.toRadius ?? 0);
    const rects: Rect[] = [];
    const margin = (kGutter + 1) / this.size;
    const [a, b] = [new Vector3(), new Vector3()];
    const middle = from.point.clone().lerp(to.point, 0.5);
    const reach = radius + from.point.distanceTo(to.point) / 2;
    const [triangle, found] = [new Triangle(), new Vector3()];
    for (const [index, { points, normal, u, v, alongU, alongV, box }] of this.#patches.entries()) {
      if (without.has(index)) continue;
      if (Math.max(normal.dot(from.normal), normal.dot(to.normal)) < kFacing) continue;
      a.subVectors(from.point, points[0]);
      b.subVectors(to.point, points[0]);
      const [heightA, heightB] = [a.dot(normal), b.dot(normal)];
      if (Math.min(heightA, heightB) > radius || Math.max(heightA, heightB) < -radius) continue;
      // u and v are linear in the triangle's plane: the ball's projection bounds them.
      const [reachU, reachV] = [radius * alongU.length(), radius * alongV.length()];
      const [uA, uB, vA, vB] = [u + a.dot(alongU), u + b.dot(alongU), v + a.dot(alongV), v + b.dot(alongV)];
      const left = Math.max(box.left, Math.min(uA, uB) - reachU);
      const top = Math.max(box.top, Math.min(vA, vB) - reachV);
      const right = Math.min(box.right, Math.max(uA, uB) + reachU);
      const bottom = Math.min(box.bottom, Math.max(vA, vB) + reachV);
      if (left > right || top > bottom) continue;
      if (
        triangle
          .set(...points)
          .closestPointToPoint(middle, found)
          .distanceTo(middle) > reach
      )
        continue;
      rects.push({
        left: Math.max(0, left - margin),
        top: Math.max(0, top - margin),
        right: Math.min(1, right + margin),
        bottom: Math.min(1, bottom + margin),
      });
    }
    return rects;
  }

  /** Indices of the patches that lie entirely within a capsule, where that is thinnest, and face it along its whole length. */
  enclosed({ from, to, ...radii }: Capsule): number[] {
    const radius = Math.min(radii.radius, radii.toRadius ?? radii.radius);
    const way = new Line3(from.point, to.point);
    const found = new Vector3();
    // A capsule is convex: it contains a triangle if it contains the corners.
    const isNear = (point: Vector3): boolean => way.closestPointToPoint(point, true, found).distanceTo(point) <= radius;
    return this.#patches.flatMap(({ points, normal }, index) =>
      Math.min(normal.dot(from.normal), normal.dot(to.normal)) >= kFacing && points.every(isNear) ? index : [],
    );
  }

  /** 255 for each patch that a sticker gets to from where it is placed, 0 for the others. */
  reached(place: SurfacePoint, box: Omit<StickerBox, 'center'>): Uint8Array {
    const found = this.#connected(place, box);
    const flags = new Uint8Array(this.#patches.length).fill(found ? 0 : 255);
    for (const index of found ?? []) flags[index] = 255;
    return flags;
  }

  /** How much of the width of a sticker, or of its height if that is less, what it gets to takes: 0..1. */
  room(place: SurfacePoint, box: Omit<StickerBox, 'center'>): number {
    const found = this.#connected(place, box);
    return found ? roomIn(this.#patches, found, { center: place.point, ...box }) : 1;
  }

  /** Undefined between charts. */
  #connected({ point, normal, uv }: SurfacePoint, box: Omit<StickerBox, 'center'>): Set<number> | undefined {
    this.#neighbours ??= neighboursOf(this.#patches);
    const from = this.#ownerAt(uv ?? this.nearest(point, normal)?.uv);
    return from < 0 ? undefined : connected(this.#patches, this.#neighbours, from, { center: point, ...box });
  }

  /** The patch at a UV; -1 for none. */
  #ownerAt(uv: Vector2 | undefined): number {
    if (!uv) return -1;
    const texelOf = (share: number): number =>
      Math.min(this.size - 1, Math.floor((share - Math.floor(share)) * this.size));
    return this.owners[texelOf(uv.y) * this.size + texelOf(uv.x)]!;
  }

  /** Assigns the texels whose centres lie in a patch. */
  #fill({ u, v, shares: [bu, bv, cu, cv], box }: Patch, index: number): void {
    const { size, owners } = this;
    const first = (share: number): number => Math.max(0, Math.ceil(share * size - 0.5));
    const last = (share: number): number => Math.min(size - 1, Math.floor(share * size - 0.5));
    const [left, right, top, bottom] = [first(box.left), last(box.right), first(box.top), last(box.bottom)];
    for (let row = top; row <= bottom; row++) {
      const dv = (row + 0.5) / size - v;
      for (let column = left; column <= right; column++) {
        const du = (column + 0.5) / size - u;
        const b = du * bu + dv * bv;
        const c = du * cu + dv * cv;
        if (b >= 0 && c >= 0 && b + c <= 1) owners[row * size + column] = index;
      }
    }
  }

  /** Fills the gutters: assigns texels around a chart to the patches at its border, ring by ring. */
  #widen(): void {
    const { size, owners } = this;
    let ring: number[] = [];
    for (let texel = 0; texel < owners.length; texel++) {
      if (owners[texel]! < 0) continue;
      const enclosed =
        owners[texel - 1]! >= 0 && owners[texel + 1]! >= 0 && owners[texel - size]! >= 0 && owners[texel + size]! >= 0;
      if (!enclosed) ring.push(texel);
    }
    for (let step = 0; step < kGutter; step++) {
      const next: number[] = [];
      for (const texel of ring) {
        const [column, row] = [texel % size, Math.floor(texel / size)];
        for (let y = Math.max(0, row - 1); y <= Math.min(size - 1, row + 1); y++) {
          for (let x = Math.max(0, column - 1); x <= Math.min(size - 1, column + 1); x++) {
            const other = y * size + x;
            if (owners[other] !== -1) continue;
            owners[other] = owners[texel]!;
            next.push(other);
          }
        }
      }
      ring = next;
    }
  }
}

function patchesOf({ positions, indices, uvs }: CageMesh): Patch[] {
  const patches: Patch[] = [];
  for (let corner = 0; corner < indices.length; corner += 3) {
    const [a, b, c] = [indices[corner]!, indices[corner + 1]!, indices[corner + 2]!];
    const pointAt = (vertex: number): Vector3 => new Vector3().fromArray(positions, 3 * vertex);
    const points = [pointAt(a), pointAt(b), pointAt(c)] as const;
    const [u, v] = [uvs[2 * a]!, uvs[2 * a + 1]!];
    const [ub, vb, uc, vc] = [uvs[2 * b]! - u, uvs[2 * b + 1]! - v, uvs[2 * c]! - u, uvs[2 * c + 1]! - v];
    const area = ub * vc - uc * vb;
    const [alongB, alongC] = [points[1].clone().sub(points[0]), points[2].clone().sub(points[0])];
    const normal = alongB.clone().cross(alongC);
    // Triangles without area in space or in the texture cannot be painted.
    if (normal.lengthSq() === 0 || area === 0) continue;
    const [bb, bc, cc, scale] = [alongB.lengthSq(), alongB.dot(alongC), alongC.lengthSq(), 1 / normal.lengthSq()];
    /** The direction g of the plane with g·alongB = atB and g·alongC = atC. */
    const growing = (atB: number, atC: number): Vector3 =>
      alongB
        .clone()
        .multiplyScalar((atB * cc - atC * bc) * scale)
        .addScaledVector(alongC, (atC * bb - atB * bc) * scale);
    const [alongU, alongV] = [growing(ub, uc), growing(vb, vc)];
    const shares = [vc / area, -uc / area, -vb / area, ub / area] as const;
    const box = {
      left: u + Math.min(0, ub, uc),
      top: v + Math.min(0, vb, vc),
      right: u + Math.max(0, ub, uc),
      bottom: v + Math.max(0, vb, vc),
    };
    normal.normalize();
    for (const dv of tilesOf(box.top, box.bottom)) {
      for (const du of tilesOf(box.left, box.right)) {
        const moved = { left: box.left - du, top: box.top - dv, right: box.right - du, bottom: box.bottom - dv };
        patches.push({ points, normal, u: u - du, v: v - dv, shares, alongU, alongV, box: moved });
      }
    }
  }
  return patches;
}

/** The repetitions of the texture between two coordinates, in one direction. */
function tilesOf(from: number, to: number): number[] {
  const first = Math.floor(from);
  return Array.from({ length: Math.max(1, Math.min(kMaxTiles, Math.ceil(to) - first)) }, (_, step) => first + step);
}

/** The point of a patch at a UV; outside the patch, a point on its border. */
function pointOf({ points, u, v, shares: [bu, bv, cu, cv] }: Patch, atU: number, atV: number): Vector3 {
  const [du, dv] = [atU - u, atV - v];
  const [shareB, shareC] = [du * bu + dv * bv, du * cu + dv * cv];
  const [a, b, c] = [Math.max(0, 1 - shareB - shareC), Math.max(0, shareB), Math.max(0, shareC)];
  const point = new Vector3();
  [a, b, c].forEach((share, corner) => point.addScaledVector(points[corner]!, share / (a + b + c)));
  return point;
}

/** The mean ratio of lengths in space to lengths in the texture. */
function pitchOf(patches: readonly Patch[]): number {
  let [inSpace, inTexture] = [0, 0];
  const normal = new Vector3();
  for (const {
    points: [a, b, c],
    shares: [bu, bv, cu, cv],
  } of patches) {
    inSpace += normal.subVectors(b, a).cross(c.clone().sub(a)).length();
    inTexture += 1 / Math.abs(bu * cv - bv * cu);
  }
  return inTexture > 0 ? Math.sqrt(inSpace / inTexture) : 0;
}
