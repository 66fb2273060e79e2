import type { Mesh } from 'cagecast';
import { boxOf, dot, minus, pointAt, type Vector } from '../../wasm/src/inspect/geometry.js';

/** From where pictures are taken: all around, from a little above and a little below in turns. */
const directions = Array.from({ length: 12 }, (_, i) => {
  const [turn, rise] = [(i * Math.PI) / 6, ((i % 2 === 0 ? 20 : -10) * Math.PI) / 180];
  return { turn, rise };
});
const fieldOfView = (28 * Math.PI) / 180; // the page's
/** Pixels along each side of a picture. */
const kSize = 400;

/**
 * Counts what of a mesh is seen in 12 pictures of 400 × 400 pixels from all around, in perspective, both sides of each
 * triangle: a depth buffer, filled at the centres of pixels.
 * @returns 1 per triangle corner: in how many pixels the triangle is in front, and this corner the nearest of its three. All of
 * them add up to the pixels that show the model. Whatever a method paints, the picture's shape is the same: so one count
 * serves all methods.
 */
export function visiblePixels({ positions, indices }: Mesh): Uint32Array {
  const counts = new Uint32Array(indices.length);
  const vertices = positions.length / 3;
  const { min, max, diagonal } = boxOf(positions);
  const middle: Vector = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
  // All of the ball around the box is in the picture.
  const distance = diagonal / 2 / Math.sin(fieldOfView / 2);
  const focus = kSize / 2 / Math.tan(fieldOfView / 2);
  const [xs, ys, nears] = [new Float64Array(vertices), new Float64Array(vertices), new Float64Array(vertices)];
  for (const { turn, rise } of directions) {
    const eye: Vector = [Math.sin(turn) * Math.cos(rise), Math.sin(rise), Math.cos(turn) * Math.cos(rise)];
    const right: Vector = [Math.cos(turn), 0, -Math.sin(turn)];
    const up: Vector = [-Math.sin(turn) * Math.sin(rise), Math.cos(rise), -Math.cos(turn) * Math.sin(rise)];
    for (let v = 0; v < vertices; ++v) {
      const p = minus(pointAt(positions, v), middle);
      nears[v] = 1 / (distance - dot(p, eye));
      xs[v] = kSize / 2 + focus * dot(p, right) * nears[v]! - 0.5;
      ys[v] = kSize / 2 - focus * dot(p, up) * nears[v]! - 0.5;
    }
    for (const corner of frontCorners(indices, xs, ys, nears)) if (corner >= 0) ++counts[corner]!;
  }
  return counts;
}

/** Per pixel: of the triangle in front, the corner that is nearest; -1 where there is none. @param nears  1 ÷ depth. */
function frontCorners(indices: Mesh['indices'], xs: Float64Array, ys: Float64Array, nears: Float64Array): Int32Array {
  const corners = new Int32Array(kSize * kSize).fill(-1);
  const depths = new Float64Array(kSize * kSize);
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [indices[t]!, indices[t + 1]!, indices[t + 2]!];
    const [ax, ay, bx, by, cx, cy] = [xs[a]!, ys[a]!, xs[b]!, ys[b]!, xs[c]!, ys[c]!];
    const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
    if (area === 0) continue;
    const [left, last] = [
      Math.max(0, Math.ceil(Math.min(ax, bx, cx))),
      Math.min(kSize - 1, Math.floor(Math.max(ax, bx, cx))),
    ];
    const [top, bottom] = [
      Math.max(0, Math.ceil(Math.min(ay, by, cy))),
      Math.min(kSize - 1, Math.floor(Math.max(ay, by, cy))),
    ];
    for (let y = top; y <= bottom; ++y) {
      for (let x = left; x <= last; ++x) {
        // 1 ÷ depth is linear in the picture, and so are the corners' shares of the place multiplied by it.
        const u = (((bx - x) * (cy - y) - (by - y) * (cx - x)) / area) * nears[a]!;
        const v = (((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area) * nears[b]!;
        const w = (((ax - x) * (by - y) - (ay - y) * (bx - x)) / area) * nears[c]!;
        if (u < 0 || v < 0 || w < 0) continue;
        const at = y * kSize + x;
        if (u + v + w <= depths[at]!) continue;
        depths[at] = u + v + w;
        corners[at] = t + (u >= v && u >= w ? 0 : v >= w ? 1 : 2);
      }
    }
  }
  return corners;
}
