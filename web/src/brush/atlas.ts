import { Line3, Triangle, Vector3 } from 'three';
import type { Rect } from '../layers/rect';

/** A cage, as far as painting on it wants to know it. */
export interface CageMesh {
  /** 3 per vertex. */
  positions: Float32Array;
  /** 3 per triangle. */
  indices: Uint32Array;
  /** 2 per vertex. */
  uvs: Float32Array;
}

/** A place on the cage, and the side of it that is outside. */
export interface Place {
  point: Vector3;
  /** Of length 1. */
  normal: Vector3;
}

/** What a brush touches as it moves from one place to another: all within `radius` of the line between them. */
export interface Capsule {
  from: Place;
  to: Place;
  radius: number;
}

// Texels around an island that hold what its border holds. With two, bilinear filtering never reaches past them; the
// others serve the first smaller levels of the texture.
const kGutter = 4;
// A triangle that lies in more tiles than that, in either direction, has UVs that mean something else.
const kMostTiles = 16;
/** The least cosine between a brush's normal and that of what it paints: beyond lies the other side of something thin. */
export const kFacing = -0.25;
/** Numbers for each patch in `table`, four by four. */
export const kPatchTexels = 5;

/** A triangle of the cage as it lies in the texture; once for each tile, where its UVs leave 0..1. */
interface Patch {
  points: readonly [Vector3, Vector3, Vector3];
  normal: Vector3;
  /** Where the first corner lies. */
  u: number;
  v: number;
  /** How the shares of the second and third corner grow with u and v. */
  shares: readonly [bu: number, bv: number, cu: number, cv: number];
  /** How u and v grow in the triangle's plane. */
  alongU: Vector3;
  alongV: Vector3;
  box: Rect;
}

/**
 * The cage, unrolled: for each texel of a texture, which triangle of the cage lies there, and so which place. With it a
 * brush can be a ball in space: what it touches is the same on both sides of a seam, and of one size everywhere.
 */
export class CageAtlas {
  readonly #patches: Patch[];
  /** Per texel the patch that lies there, or around whose border it lies; -1 for none. Row by row from v = 0. */
  readonly owners: Int32Array;
  /** The cage's x where left meets right. */
  readonly middle: number;
  /** The diagonal of the cage's box. */
  readonly diagonal: number;
  /** How far apart neighbouring texels are, in the cage's space and on the whole. */
  readonly pitch: number;

  /**
   * @param size Texels a side.
   * Cost: some tens of milliseconds at 1024, and 4 bytes a texel.
   */
  constructor(
    cage: CageMesh,
    readonly size: number,
  ) {
    this.#patches = patchesOf(cage);
    this.owners = new Int32Array(size * size).fill(-1);
    this.#patches.forEach((patch, index) => this.#fill(patch, index));
    this.#widen();
    const { least, most } = boxOf(cage.positions);
    this.middle = (least.x + most.x) / 2;
    this.diagonal = least.distanceTo(most);
    this.pitch = pitchOf(this.#patches) / size;
  }

  /** The place of the cage at a place of the texture; none where no island lies. @param u, v Repeated outside 0..1. */
  at(u: number, v: number): Place | undefined {
    const [insideU, insideV] = [u - Math.floor(u), v - Math.floor(v)];
    const column = Math.min(this.size - 1, Math.floor(insideU * this.size));
    const row = Math.min(this.size - 1, Math.floor(insideV * this.size));
    const patch = this.#patches[this.owners[row * this.size + column]!];
    return patch && { point: pointOf(patch, insideU, insideV), normal: patch.normal.clone() };
  }

  /** The place of the cage that is nearest to a point, on what faces `outside`. Cost: goes through all triangles. */
  nearest(point: Vector3, outside: Vector3): Place | undefined {
    const triangle = new Triangle();
    const found = new Vector3();
    let nearest: Place | undefined;
    let least = Infinity;
    for (const { points, normal } of this.#patches) {
      // A triangle is no nearer than its plane.
      if (normal.dot(outside) <= 0 || Math.abs(found.subVectors(point, points[0]).dot(normal)) >= least) continue;
      triangle.set(...points).closestPointToPoint(point, found);
      const distance = found.distanceTo(point);
      if (distance < least) [least, nearest] = [distance, { point: found.clone(), normal }];
    }
    return nearest;
  }

  /** The same place on the other side of the middle. */
  mirrored({ point, normal }: Place): Place {
    return {
      point: new Vector3(2 * this.middle - point.x, point.y, point.z),
      normal: new Vector3(-normal.x, normal.y, normal.z),
    };
  }

  /** The patches for a shader: of each, 4 numbers `kPatchTexels` times: a, u; b, v; c, 0; shares; normal, 0. */
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
   * The parts of the texture that a brush touches, in shares; they may be a little larger, and overlap.
   * @param without Patches that are left out, by their number.
   */
  touched({ from, to, radius }: Capsule, without: ReadonlySet<number>): Rect[] {
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
      // In the triangle's plane u and v are linear: the ball's shadow there gives their bounds.
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

  /** The patches, by their number, of which all that belongs to them lies within a brush's way, and faces it all along. */
  enclosed({ from, to, radius }: Capsule): number[] {
    const way = new Line3(from.point, to.point);
    const found = new Vector3();
    // A capsule that holds the corners of a triangle holds all of it.
    const isNear = (point: Vector3): boolean => way.closestPointToPoint(point, true, found).distanceTo(point) <= radius;
    return this.#patches.flatMap(({ points, normal }, index) =>
      Math.min(normal.dot(from.normal), normal.dot(to.normal)) >= kFacing && points.every(isNear) ? index : [],
    );
  }

  /** Claims the texels whose centres lie in a patch. */
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

  /** Gives the texels around an island to its border, ring by ring. */
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
    // What has no area, in space or in the texture, cannot be painted.
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

/** The tiles of the texture's repetition that are met between two places, in one direction. */
function tilesOf(from: number, to: number): number[] {
  const first = Math.floor(from);
  return Array.from({ length: Math.max(1, Math.min(kMostTiles, Math.ceil(to) - first)) }, (_, step) => first + step);
}

/** The place of a patch at a place of the texture; beyond its border, a place on the border. */
function pointOf({ points, u, v, shares: [bu, bv, cu, cv] }: Patch, atU: number, atV: number): Vector3 {
  const [du, dv] = [atU - u, atV - v];
  const [shareB, shareC] = [du * bu + dv * bv, du * cu + dv * cv];
  const [a, b, c] = [Math.max(0, 1 - shareB - shareC), Math.max(0, shareB), Math.max(0, shareC)];
  const point = new Vector3();
  [a, b, c].forEach((share, corner) => point.addScaledVector(points[corner]!, share / (a + b + c)));
  return point;
}

function boxOf(positions: Float32Array): { least: Vector3; most: Vector3 } {
  const least = new Vector3(Infinity, Infinity, Infinity);
  const most = new Vector3(-Infinity, -Infinity, -Infinity);
  const point = new Vector3();
  for (let at = 0; at < positions.length; at += 3) {
    point.fromArray(positions, at);
    least.min(point);
    most.max(point);
  }
  return { least, most };
}

/** How much longer a way is in space than in the texture, on the whole. */
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
