// Where the texels of a cage's texture are on the cage.

/** A cage, and what is known of the model that it is for. */
export interface Canvas {
  /** 3 per vertex. */
  positions: ArrayLike<number>;
  /** 2 per vertex. */
  uvs: ArrayLike<number>;
  /** 3 per triangle. */
  indices: ArrayLike<number>;
  /** Spots of the model, as templates name them. */
  landmarks: Readonly<Record<string, readonly number[]>>;
}

export type Point = readonly [x: number, y: number, z: number];

/** Where a texel is: left is +x, up +y, front +z. */
export interface Spot {
  /** Of a face: from the middle between the eyes, in distances of the eyes. Else: from the middle, in halves of the longest side. */
  at: Point;
  normal: Point;
}

/** How positions become those of `Spot`. */
export interface Frame {
  isFace: boolean;
  origin: Point;
  unit: number;
  /** A landmark in the frame; undefined if there is none. */
  mark(name: string): Point | undefined;
}

export function frameOf({ positions, landmarks }: Canvas): Frame {
  const { eye_centre_left: left, eye_centre_right: right } = landmarks;
  const eyes = left && right ? { left, right } : undefined;
  const box = [0, 1, 2].map((k) => {
    let [low, high] = [Infinity, -Infinity];
    for (let i = k; i < positions.length; i += 3)
      [low, high] = [Math.min(low, positions[i]!), Math.max(high, positions[i]!)];
    return { middle: (low + high) / 2, half: (high - low) / 2 };
  });
  const origin = (eyes
    ? [0, 1, 2].map((k) => (eyes.left[k]! + eyes.right[k]!) / 2)
    : box.map(({ middle }) => middle)) as unknown as Point;
  const unit = eyes
    ? Math.hypot(...[0, 1, 2].map((k) => eyes.left[k]! - eyes.right[k]!))
    : Math.max(...box.map(({ half }) => half));
  const framed = (p: readonly number[]): Point => [0, 1, 2].map((k) => (p[k]! - origin[k]!) / unit) as unknown as Point;
  const marks = new Map(Object.entries(landmarks).map(([name, at]) => [name, framed(at)]));
  return { isFace: eyes !== undefined, origin, unit, mark: (name) => marks.get(name) };
}

/**
 * Calls a function for each texel of a square texture that a cage covers, and two texels around it.
 * @param size  Texels per side.
 */
export function eachSpot(
  { positions, uvs, indices }: Canvas,
  frame: Frame,
  size: number,
  call: (texel: number, spot: Spot) => void,
): void {
  const corner = (v: number): Point =>
    [0, 1, 2].map((k) => (positions[3 * v + k]! - frame.origin[k]!) / frame.unit) as unknown as Point;
  const done = new Uint8Array(size * size);
  // What is inside of a triangle comes before what is only beside it.
  for (const margin of [0, 2])
    for (let i = 0; i < indices.length; i += 3) {
      const vertices = [indices[i]!, indices[i + 1]!, indices[i + 2]!] as const;
      const [a, b, c] = vertices.map(corner) as [Point, Point, Point];
      const [p, q, r] = vertices.map((v) => [uvs[2 * v]! * size - 0.5, uvs[2 * v + 1]! * size - 0.5]) as [
        number[],
        number[],
        number[],
      ];
      const [ux, uy, vx, vy] = [q[0]! - p[0]!, q[1]! - p[1]!, r[0]! - p[0]!, r[1]! - p[1]!];
      const area = ux * vy - uy * vx;
      if (area === 0) continue;
      const normal = normalOf(a, b, c);
      // Texels beside it are those near its edges.
      const reach = [0, 1].map((k) => (margin * Math.hypot(k === 0 ? vx : ux, k === 0 ? vy : uy)) / Math.abs(area));
      const third = (margin * Math.hypot(vx - ux, vy - uy)) / Math.abs(area);
      const range = (k: number): [number, number] => [
        Math.max(0, Math.ceil(Math.min(p[k]!, q[k]!, r[k]!) - margin)),
        Math.min(size - 1, Math.floor(Math.max(p[k]!, q[k]!, r[k]!) + margin)),
      ];
      const [[left, right], [top, bottom]] = [range(0), range(1)];
      for (let y = top; y <= bottom; ++y)
        for (let x = left; x <= right; ++x) {
          const texel = y * size + x;
          if (done[texel]) continue;
          const s = ((x - p[0]!) * vy - (y - p[1]!) * vx) / area;
          const t = (ux * (y - p[1]!) - uy * (x - p[0]!)) / area;
          if (s < 0 - reach[0]! || t < 0 - reach[1]! || s + t > 1 + third) continue;
          done[texel] = 1;
          const r0 = 1 - s - t;
          const at: Point = [
            r0 * a[0] + s * b[0] + t * c[0],
            r0 * a[1] + s * b[1] + t * c[1],
            r0 * a[2] + s * b[2] + t * c[2],
          ];
          call(texel, { at, normal });
        }
    }
}

export function normalOf(a: Point, b: Point, c: Point): Point {
  const [u, v] = [b, c].map((p) => [0, 1, 2].map((k) => p[k]! - a[k]!)) as [number[], number[]];
  const cross = [u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!];
  const length = Math.hypot(...cross) || 1;
  return cross.map((x) => x / length) as unknown as Point;
}
