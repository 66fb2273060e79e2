import { pointAt, type Vector } from '../../inspect/geometry.js';
import { facingOf, lit, type Picture } from './picture.js';
import type { Surface } from './surfaces.js';
import type { View } from './views.js';

/** A triangle that is to be blended. */
interface Blended {
  drawer: Drawer;
  triangle: number;
  depth: number;
}

/**
 * Draws surfaces: first what is opaque or cut out, then what is blended, from the back to the front; of the same depth, as overlays have
 * it, in their order.
 */
export function drawSurfaces(picture: Picture, view: View, surfaces: readonly Surface[]): void {
  const blended: Blended[] = [];
  for (const surface of surfaces) {
    const drawer = new Drawer(picture, view, surface);
    for (let triangle = 0; triangle < surface.indices.length / 3; ++triangle)
      if (surface.mode === 'BLEND') blended.push({ drawer, triangle, depth: drawer.depthOf(triangle) });
      else drawer.draw(triangle);
  }
  blended.sort((a, b) => a.depth - b.depth);
  for (const { drawer, triangle } of blended) drawer.draw(triangle);
}

/** What draws the triangles of a surface, one by one. */
class Drawer {
  readonly #picture: Picture;
  readonly #surface: Surface;
  /** 3 per vertex. */
  readonly #projected: Float64Array;
  /** 1 per vertex: the cosine between its normal and the eye. */
  readonly #facing: Float32Array | undefined;
  /** Of the triangle that is drawn: its corners, its copy of the texture, which side is seen, and its own facing. */
  #corners: [number, number, number] = [0, 0, 0];
  #level = 0;
  #side: 1 | -1 = 1;
  #flat = 1;

  constructor(picture: Picture, { eye }: View, surface: Surface) {
    this.#picture = picture;
    this.#surface = surface;
    const { positions, normals } = surface;
    this.#projected = new Float64Array(positions.length);
    for (let v = 0; v < positions.length / 3; ++v) this.#projected.set(picture.project(pointAt(positions, v)), 3 * v);
    this.#facing = normals && new Float32Array(positions.length / 3).map((_, v) => facingAt(normals, v, eye));
  }

  /** How near a triangle is to the eye. */
  depthOf(triangle: number): number {
    const { indices } = this.#surface;
    return [0, 1, 2].reduce((sum, k) => sum + this.#projected[3 * indices[3 * triangle + k]! + 2]!, 0);
  }

  draw(triangle: number): void {
    const { indices, doubleSided, mode, unlit } = this.#surface;
    const [a, b, c] = [indices[3 * triangle]!, indices[3 * triangle + 1]!, indices[3 * triangle + 2]!];
    const [p, q, r] = [pointAt(this.#projected, a), pointAt(this.#projected, b), pointAt(this.#projected, c)];
    const facing = facingOf(p, q, r);
    if (facing === 0 || (facing < 0 && !doubleSided)) return;
    this.#corners = [a, b, c];
    this.#side = facing > 0 ? 1 : -1;
    this.#flat = unlit ? 1 : lit(Math.abs(facing));
    this.#level = this.#levelFor(p, q, r);
    this.#picture.fill(p, q, r, this.#shade, mode === 'BLEND');
  }

  #levelFor(p: Vector, q: Vector, r: Vector): number {
    const { texture, uvs } = this.#surface;
    if (!texture || !uvs) return 0;
    const [a, b, c] = this.#corners;
    const area = (at: (k: 0 | 1, n: 0 | 1 | 2) => number) =>
      Math.abs((at(0, 1) - at(0, 0)) * (at(1, 2) - at(1, 0)) - (at(1, 1) - at(1, 0)) * (at(0, 2) - at(0, 0)));
    const samples = area((k, n) => [p, q, r][n]![k]);
    return texture.levelFor(area((k, n) => uvs[2 * [a, b, c][n]! + k]!) / samples);
  }

  readonly #shade = (q: number, r: number, out: Float32Array): void => {
    const { texture, uvs, colors, factor, mode, cutoff, unlit } = this.#surface;
    const [a, b, c] = this.#corners;
    const p = 1 - q - r;
    if (texture && uvs)
      texture.sample(
        p * uvs[2 * a]! + q * uvs[2 * b]! + r * uvs[2 * c]!,
        p * uvs[2 * a + 1]! + q * uvs[2 * b + 1]! + r * uvs[2 * c + 1]!,
        this.#level,
        out,
      );
    else out.fill(1);
    if (colors) {
      const { values, size } = colors;
      for (let k = 0; k < size; ++k)
        out[k]! *= p * values[size * a + k]! + q * values[size * b + k]! + r * values[size * c + k]!;
    }
    const facing = this.#facing;
    const light = unlit || !facing ? this.#flat : lit(this.#side * (p * facing[a]! + q * facing[b]! + r * facing[c]!));
    for (let k = 0; k < 3; ++k) out[k]! *= factor[k]! * light;
    out[3] =
      mode === 'OPAQUE'
        ? 1
        : mode === 'MASK'
          ? Number(out[3]! * factor[3]! >= cutoff)
          : Math.min(1, Math.max(0, out[3]! * factor[3]!));
  };
}

/** The cosine between the normal of a vertex and the eye. */
function facingAt(normals: Float32Array, v: number, [x, y, z]: Vector): number {
  const [nx, ny, nz] = pointAt(normals, v);
  return (nx * x + ny * y + nz * z) / (Math.hypot(nx, ny, nz) || 1);
}
