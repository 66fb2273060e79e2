// Makes the template `face-mask`: the face of `human-head` on a chart of its own, which it fills.
//
//   node --import tsx examples/samples/face-mask.ts

import { type Accessor, Document, NodeIO } from '@gltf-transform/core';
import { type Cage, fitCage, type Landmarks, loadTemplate, type Position, terminate } from 'cagecast/cages';
import { cageModel } from 'cagecast/gltf';

const kFolder = 'examples/samples';
/** Where the face is seen from: inside of the head. */
const kCentre = [0, -0.1, 0] as const;
/**
 * How far it reaches, in degrees: above and below the centre, and to both sides, there and at its lower end. So the rest of any head is
 * large enough for its outline to be an outer border (docs/method.md).
 */
const [kTop, kBottom, kSide, kLowSide] = [50, -60, 66, 46];
/** What the chart leaves free at the borders of the texture. */
const kMargin = 0.01;
/** Columns from the middle to the side, and rows from the top: close together where eyes and mouth are. */
const kColumns = [...spaced(0, 0.42, 7), ...spaced(0.42, 1, 4), 1];
const kRows = [...spaced(0, 0.27, 4), ...spaced(0.27, 0.78, 17), ...spaced(0.78, 1, 3), 1];
const kSmoothing = 200;

type Flat = [x: number, y: number];
type Point = [x: number, y: number, z: number];

function spaced(from: number, to: number, count: number): number[] {
  return Array.from({ length: count }, (_, i) => from + ((to - from) * i) / count);
}

const radians = (degrees: number) => (degrees * Math.PI) / 180;
/** How far the face reaches to the side at a height, in degrees. */
const sideAt = (y: number) => kSide + (kLowSide - kSide) * Math.max(0, (y - 0.6) / 0.4) ** 2;

/** The direction of a spot of the left half of the face: x from its middle to its side, y from its top down, 0..1. */
function directionOf([x, y]: Flat): Point {
  const [across, up] = [radians(x * sideAt(y)), radians(kTop + y * (kBottom - kTop))];
  return [Math.sin(across) * Math.cos(up), Math.sin(up), Math.cos(across) * Math.cos(up)];
}

/** The spot in the direction of a point. */
function spotOf(point: Position): Flat {
  const [x, y, z] = point.map((value, k) => value - kCentre[k]!) as Point;
  const up = (Math.atan2(y, Math.hypot(x, z)) * 180) / Math.PI;
  const height = (up - kTop) / (kBottom - kTop);
  return [(Math.atan2(x, z) * 180) / Math.PI / sideAt(height), height];
}

const pointOf = ({ positions }: Cage, v: number): Point => [...positions.subarray(3 * v, 3 * v + 3)] as Point;
const cross = (a: Point, b: Point): Point => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
const dot = (a: readonly number[], b: readonly number[]) => a.reduce((sum, x, k) => sum + x * b[k]!, 0);
const minus = (a: readonly number[], b: readonly number[]) => a.map((x, k) => x - b[k]!) as Point;

/** The outermost point of a cage in a direction from the centre. */
function surfaceAt(cage: Cage, direction: Point): Point {
  let far = 0;
  for (let i = 0; i < cage.indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => minus(pointOf(cage, cage.indices[i + k]!), kCentre)) as [
      Point,
      Point,
      Point,
    ];
    const volume = dot(a, cross(b, c));
    const weights = [dot(direction, cross(b, c)), dot(direction, cross(c, a)), dot(direction, cross(a, b))];
    if (weights.every((w) => w >= -1e-9)) far = Math.max(far, volume / weights.reduce((s, w) => s + w));
  }
  return direction.map((x, k) => kCentre[k]! + far * x) as Point;
}

function isInside([x, y]: Flat, polygon: readonly Flat[]): boolean {
  const crossed = polygon.filter(([ax, ay], i) => {
    const [bx, by] = polygon[(i + 1) % polygon.length]!;
    return ay > y !== by > y && x < ax + ((bx - ax) * (y - ay)) / (by - ay);
  });
  return crossed.length % 2 === 1;
}

/** The point of an outline that is nearest to a spot, in both: edge and share of its length. */
function nearestOn(outline: readonly Flat[], [x, y]: Flat): { edge: number; share: number; distance: number } {
  const places = outline.map((a, edge) => {
    const b = outline[(edge + 1) % outline.length]!;
    const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    const share = Math.min(1, Math.max(0, ((x - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy)));
    return { edge, share, distance: Math.hypot(x - a[0] - share * dx, y - a[1] - share * dy) };
  });
  return places.reduce((best, place) => (place.distance < best.distance ? place : best));
}

/** The left half of the mask: a grid with holes, whose first column is the middle. */
function halfMask(head: Cage) {
  const [width, height] = [kColumns.length, kRows.length];
  const spots = kRows.flatMap((y) => kColumns.map((x): Flat => [x, y]));
  const points: (Point | undefined)[] = [];
  const cut = new Set<number>();
  const holes: Record<string, number[]> = {};
  for (const name of ['eye_left', 'mouth']) {
    const loop = head.holes[name]!.map((v) => pointOf(head, v));
    const outline = loop.map(spotOf);
    const corners = (quad: number) => [quad, quad + 1, quad + 1 + width, quad + width];
    const own = spots.flatMap((_, quad) => {
      if (quad % width === width - 1 || quad >= width * (height - 1)) return [];
      const middle = [0, 1].map((k) => corners(quad).reduce((sum, v) => sum + spots[v]![k]! / 4, 0)) as Flat;
      return isInside(middle, outline) ? [quad] : [];
    });
    for (const quad of own) cut.add(quad);
    const inner = new Set(own);
    const around = (v: number) => [v, v - 1, v - width, v - width - 1].filter((q) => q >= 0);
    const border = [...new Set(own.flatMap(corners))].filter(
      // Corners of the middle column have two quads in this half.
      (v) => around(v).filter((q) => inner.has(q)).length < (v % width === 0 ? 2 : 4),
    );
    for (const v of border) {
      const isMiddle = v % width === 0;
      // Where the outline crosses the middle, above or below.
      const ends = outline.flatMap(([x], edge) => {
        const next = outline[(edge + 1) % outline.length]!;
        return x <= 0 !== next[0] <= 0 ? [{ edge, share: x / (x - next[0]) }] : [];
      });
      const at = ({ edge, share }: { edge: number; share: number }, list: readonly number[][]) =>
        list[edge]!.map((value, k) => value + share * (list[(edge + 1) % list.length]![k]! - value));
      const place = isMiddle
        ? ends.reduce((a, b) =>
            Math.abs(at(a, outline)[1]! - spots[v]![1]) < Math.abs(at(b, outline)[1]! - spots[v]![1]) ? a : b,
          )
        : nearestOn(outline, spots[v]!);
      points[v] = at(place, loop) as Point;
      if (isMiddle) points[v]![0] = 0;
      spots[v] = spotOf(points[v]!);
    }
    holes[name] = border;
  }
  smooth(spots, points, cut, width);
  const positions = spots.map((spot, v) => points[v] ?? surfaceAt(head, directionOf(spot)));
  return { spots, positions, cut, holes, width };
}

/** Evens out the places of what is on no border; those in the middle stay there. */
function smooth(spots: Flat[], fixed: readonly unknown[], cut: ReadonlySet<number>, width: number): void {
  const height = spots.length / width;
  const isGone = (v: number) => [v, v - 1, v - width, v - width - 1].every((q) => cut.has(q));
  const rest = spots.map(([x, y]): Flat => [x, y]);
  for (let round = 0; round < kSmoothing; ++round)
    for (let v = 0; v < spots.length; ++v) {
      const [column, row] = [v % width, Math.floor(v / width)];
      if (fixed[v] || isGone(v) || column === width - 1 || row === 0 || row === height - 1) continue;
      // By how far its neighbours have moved, so that the spacing stays.
      const next = [v - width, v + width, v + 1, column > 0 ? v - 1 : v + 1];
      const move = [0, 1].map((k) => next.reduce((sum, o) => sum + (spots[o]![k]! - rest[o]![k]!) / 4, 0)) as Flat;
      spots[v] = [column === 0 ? 0 : rest[v]![0] + move[0], rest[v]![1] + move[1]];
    }
}

/** The whole mask: the left half and its mirror image. */
function maskOf(head: Cage): Cage {
  const { spots, positions, cut, holes, width } = halfMask(head);
  const quads = spots.flatMap((_, q) =>
    q % width < width - 1 && q + width < spots.length && !cut.has(q) ? [[q, q + width, q + width + 1, q + 1]] : [],
  );
  const used = [...new Set(quads.flat())].sort((a, b) => a - b);
  const twins = used.filter((v) => v % width > 0);
  const left = new Map(used.map((v, i) => [v, i]));
  const right = new Map(used.map((v) => [v, v % width === 0 ? left.get(v)! : used.length + twins.indexOf(v)]));
  const chart = ([x, y]: Flat, sign: number): Flat => [
    0.5 + sign * x * (0.5 - kMargin),
    kMargin + y * (1 - 2 * kMargin),
  ];
  const indices = quads.flatMap((quad) => {
    const [a, b, c, d] = quad as [number, number, number, number];
    const size = (p: number, q: number) => Math.hypot(...minus(positions[p]!, positions[q]!));
    const triangles = size(a, c) < size(b, d) ? [a, b, c, a, c, d] : [a, b, d, b, c, d];
    return [...triangles.map((v) => left.get(v)!), ...triangles.reverse().map((v) => right.get(v)!)];
  });
  const inFront = ([name]: [string, Position]) => !/^(crown|occiput|nape|ear_)/.test(name);
  return {
    positions: Float32Array.from([
      ...used.flatMap((v) => positions[v]!),
      ...twins.flatMap((v) => [-positions[v]![0], positions[v]![1], positions[v]![2]]),
    ]),
    uvs: Float32Array.from([
      ...used.flatMap((v) => chart(spots[v]!, 1)),
      ...twins.flatMap((v) => chart(spots[v]!, -1)),
    ]),
    indices: Uint32Array.from(indices),
    landmarks: Object.fromEntries(Object.entries(head.landmarks).filter(inFront)),
    holes: {
      eye_left: holes['eye_left']!.map((v) => left.get(v)!),
      eye_right: holes['eye_left']!.map((v) => right.get(v)!),
      mouth: [...new Set(holes['mouth']!.flatMap((v) => [left.get(v)!, right.get(v)!]))],
    },
    kind: 'head',
  };
}

/** The same with both halves alike. */
function mirrored({ uvs, ...cage }: Cage): Cage {
  const vertices = Array.from({ length: uvs.length / 2 }, (_, v) => v);
  const off = (v: number, o: number) => Math.hypot(1 - uvs[2 * v]! - uvs[2 * o]!, uvs[2 * v + 1]! - uvs[2 * o + 1]!);
  const twins = vertices.map((v) => vertices.reduce((best, o) => (off(v, o) < off(v, best) ? o : best)));
  const positions = cage.positions.map((value, i) => {
    const [v, k] = [Math.floor(i / 3), i % 3];
    return (value + (k === 0 ? -1 : 1) * cage.positions[3 * twins[v]! + k]!) / 2 + 0; // not -0
  });
  return { ...cage, uvs, positions };
}

async function write(name: string, { positions, uvs, indices, landmarks, holes, kind }: Cage): Promise<void> {
  const document = new Document();
  document.getRoot().getAsset().generator = 'cagecast templates';
  const buffer = document.createBuffer();
  const accessor = (
    type: 'VEC3' | 'VEC2' | 'SCALAR',
    array: Float32Array<ArrayBuffer> | Uint16Array<ArrayBuffer>,
  ): Accessor => document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor('VEC3', positions))
    .setAttribute('TEXCOORD_0', accessor('VEC2', uvs))
    .setIndices(accessor('SCALAR', Uint16Array.from(indices)));
  const mesh = document.createMesh(name).addPrimitive(primitive).setExtras({ kind, landmarks, holes });
  document.createScene().addChild(document.createNode(name).setMesh(mesh));
  await new NodeIO().write(`${kFolder}/templates/${name}.glb`, document);
}

const head = await loadTemplate('human-head');
const mask = maskOf(head);
const model = cageModel(await new NodeIO().read(`${kFolder}/human/target.glb`));
const { cage } = await fitCage(mask, model, mask.landmarks as Landmarks);
terminate();
await write('face-mask', { ...mirrored(cage), landmarks: mask.landmarks, holes: mask.holes, kind: 'head' });
