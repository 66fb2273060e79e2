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
  /** The landmarks of a name, on the left and on the right. */
  pair(name: string): readonly [left: Point | undefined, right: Point | undefined];
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
  // Made once: a name that is put together for each texel takes longer than all else.
  const pairs = new Map<string, ReturnType<Frame['pair']>>();
  const pair: Frame['pair'] = (name) => {
    const known = pairs.get(name) ?? ([marks.get(`${name}_left`), marks.get(`${name}_right`)] as const);
    pairs.set(name, known);
    return known;
  };
  return { isFace: eyes !== undefined, origin, unit, mark: (name) => marks.get(name), pair };
}

/** The vertices of a cage, in a frame. */
export const framed = ({ positions }: Canvas, { origin, unit }: Frame): Point[] =>
  Array.from({ length: positions.length / 3 }, (_, v): Point => {
    const at = (k: 0 | 1 | 2): number => (positions[3 * v + k]! - origin[k]) / unit;
    return [at(0), at(1), at(2)];
  });

/** A point of a picture, in pixels; the middle of the first pixel is 0, 0. */
export type Place = readonly [x: number, y: number];

/** Where a pixel is in a triangle: the shares of its second and third corner. */
type Call = (pixel: number, s: number, t: number) => void;

/**
 * Calls a function for each pixel of a square picture whose middle is in a triangle.
 * @param size    Pixels per side.
 * @param margin  How many pixels beside the triangle count, too.
 */
export function eachPixel([p, q, r]: readonly [Place, Place, Place], size: number, margin: number, call: Call): void {
  const [ux, uy, vx, vy] = [q[0] - p[0], q[1] - p[1], r[0] - p[0], r[1] - p[1]];
  const area = ux * vy - uy * vx;
  if (area === 0) return;
  // A share of 1 is as wide as the triangle is from an edge to the corner opposite to it.
  const share = (x: number, y: number): number => (margin * Math.hypot(x, y)) / Math.abs(area);
  const [beyondS, beyondT, beyondEdge] = [share(vx, vy), share(ux, uy), share(vx - ux, vy - uy)];
  const range = (k: 0 | 1): [number, number] => [
    Math.max(0, Math.ceil(Math.min(p[k], q[k], r[k]) - margin)),
    Math.min(size - 1, Math.floor(Math.max(p[k], q[k], r[k]) + margin)),
  ];
  const [[left, right], [top, bottom]] = [range(0), range(1)];
  for (let y = top; y <= bottom; ++y)
    for (let x = left; x <= right; ++x) {
      const s = ((x - p[0]) * vy - (y - p[1]) * vx) / area;
      const t = (ux * (y - p[1]) - uy * (x - p[0])) / area;
      if (s >= -beyondS && t >= -beyondT && s + t <= 1 + beyondEdge) call(y * size + x, s, t);
    }
}

/** A point of a triangle, by the shares of its second and third corner. */
export const pointIn = ([a, b, c]: readonly [Point, Point, Point], s: number, t: number): Point => {
  const along = (k: 0 | 1 | 2): number => a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]);
  return [along(0), along(1), along(2)];
};

const kGutter = 2; // texels

/**
 * Calls a function for each texel of a square texture that a cage covers, and those around it. The spot is another one after the call.
 * @param size  Texels per side.
 */
export function eachSpot(canvas: Canvas, frame: Frame, size: number, call: (texel: number, spot: Spot) => void): void {
  const { uvs, indices } = canvas;
  const points = framed(canvas, frame);
  const done = new Uint8Array(size * size);
  const place = (v: number): Place => [uvs[2 * v]! * size - 0.5, uvs[2 * v + 1]! * size - 0.5];
  // What is in a triangle comes before what is only beside another one.
  for (const margin of [0, kGutter])
    for (let i = 0; i < indices.length; i += 3) {
      const [u, v, w] = [indices[i]!, indices[i + 1]!, indices[i + 2]!];
      const corners = [points[u]!, points[v]!, points[w]!] as const;
      const at: [number, number, number] = [0, 0, 0];
      const spot = { at, normal: normalOf(...corners) };
      const [a, b, c] = corners;
      eachPixel([place(u), place(v), place(w)], size, margin, (texel, s, t) => {
        if (done[texel]) return;
        done[texel] = 1;
        for (let k = 0 as 0 | 1 | 2; k < 3; ++k) at[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]);
        call(texel, spot);
      });
    }
}

export function normalOf(a: Point, b: Point, c: Point): Point {
  const [u, v] = [b, c].map((p) => [0, 1, 2].map((k) => p[k]! - a[k]!)) as [number[], number[]];
  const cross = [u[1]! * v[2]! - u[2]! * v[1]!, u[2]! * v[0]! - u[0]! * v[2]!, u[0]! * v[1]! - u[1]! * v[0]!];
  const length = Math.hypot(...cross) || 1;
  return cross.map((x) => x / length) as unknown as Point;
}
