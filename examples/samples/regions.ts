// Writes the regions of a template, such as lips and brows, into the extras of its mesh: outlines in its UVs, from its landmarks.
//
//   node --import tsx examples/samples/regions.ts human-head human-body face-mask

import { NodeIO } from '@gltf-transform/core';
import { type Cage, loadTemplate, type Outline, type TemplateName } from 'cagecast/cages';

type Spot = [x: number, y: number];

/** Outlines of a face seen from the front, in its own unit, x to its left, y up. Only the left half is given of what has two. */
function faceRegions(at: (name: string) => Spot): Record<string, Spot[][]> {
  const mirrored = (outline: Spot[]) => outline.map(([x, y]): Spot => [-x, y]).reverse();
  const whole = (half: Spot[]) => [[...half, ...mirrored(half)]];
  const both = (outline: Spot[]) => [outline, mirrored(outline)];
  const ellipse = ([x, y]: Spot, width: number, above: number, below = above) =>
    Array.from({ length: 24 }, (_, i): Spot => {
      const [cos, sin] = [Math.cos((i * Math.PI) / 12), Math.sin((i * Math.PI) / 12)];
      return [x + width * cos, y + (sin > 0 ? above : below) * sin];
    });
  const [inner, outer, corner, nose] = ['eye_inner_left', 'eye_outer_left', 'mouth_corner_left', 'nose_tip'].map(
    at,
  ) as [Spot, Spot, Spot, Spot];
  const eye: Spot = [(inner[0] + outer[0]) / 2, (inner[1] + outer[1]) / 2];
  const eyeWidth = outer[0] - inner[0];
  const unit = eye[1] - corner[1];
  const upper = at('lip_upper')[1] + 0.035 * unit;
  const lower = at('lip_lower')[1] - 0.045 * unit;
  const [width, middle] = corner;
  const chin = at('chin')[1];
  return {
    lips: whole([
      [0, lower],
      [0.35 * width, lower],
      [0.7 * width, middle + 0.65 * (lower - middle)],
      [1.04 * width, middle],
      [0.65 * width, middle + 0.7 * (upper - middle)],
      [0.22 * width, upper],
      [0, upper - 0.015 * unit],
    ]),
    eyelids: both(ellipse(eye, 0.62 * eyeWidth, 0.44 * eyeWidth, 0.34 * eyeWidth)),
    brows: both([
      [inner[0] - 0.1 * eyeWidth, eye[1] + 0.5 * eyeWidth],
      [eye[0] + 0.2 * eyeWidth, eye[1] + 0.62 * eyeWidth],
      [outer[0] + 0.2 * eyeWidth, eye[1] + 0.42 * eyeWidth],
      [eye[0] + 0.25 * eyeWidth, eye[1] + 0.8 * eyeWidth],
      [inner[0] - 0.1 * eyeWidth, eye[1] + 0.72 * eyeWidth],
    ]),
    nose: whole([
      [0, nose[1] - 0.16 * unit],
      [0.5 * inner[0], nose[1] - 0.15 * unit],
      [1.1 * inner[0], nose[1] - 0.08 * unit],
      [1.1 * inner[0], nose[1] + 0.05 * unit],
      [0.5 * inner[0], nose[1] + 0.2 * unit],
      [0.35 * inner[0], eye[1]],
      [0, eye[1]],
    ]),
    cheeks: both(ellipse([0.85 * outer[0], nose[1]], 0.28 * unit, 0.22 * unit)),
    chin: [ellipse([0, chin], 0.24 * unit, 0.16 * unit)],
    forehead: whole([
      [0, eye[1] + 0.95 * eyeWidth],
      [outer[0], eye[1] + 0.95 * eyeWidth],
      [outer[0], at('forehead')[1]],
      [0.5 * outer[0], at('forehead')[1] + 0.1 * unit],
      [0, at('forehead')[1] + 0.12 * unit],
    ]),
  };
}

type Corners = [number, number, number];

/** Where a cage is hit from the front, in its UVs; if it is at a hole, on its border. */
function uvInFront({ positions, uvs, indices }: Cage, [x, y]: Spot): [u: number, v: number] {
  const at = (v: number): Spot => [positions[3 * v]!, positions[3 * v + 1]!];
  let best = { off: Number.POSITIVE_INFINITY, z: Number.NEGATIVE_INFINITY, uv: [0, 0] as [number, number] };
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [...indices.subarray(i, i + 3)] as Corners;
    const [a, b, c] = corners.map(at) as [Spot, Spot, Spot];
    const area = (p: Spot, q: Spot, r: Spot) => (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    const size = area(a, b, c);
    if (!(size > 0)) continue; // seen from behind
    const raw = [area(b, c, [x, y]), area(c, a, [x, y]), area(a, b, [x, y])].map((w) => Math.max(0, w / size));
    const total = raw.reduce((sum, w) => sum + w);
    const weights = raw.map((w) => w / total);
    const blend = (list: ArrayLike<number>, width: number, k: number) =>
      corners.reduce((sum, v, j) => sum + weights[j]! * list[width * v + k]!, 0);
    const off = Math.hypot(blend(positions, 3, 0) - x, blend(positions, 3, 1) - y);
    const z = blend(positions, 3, 2);
    const isBetter = Math.abs(off - best.off) < 1e-7 ? z > best.z : off < best.off;
    if (isBetter) best = { off, z, uv: [blend(uvs, 2, 0), blend(uvs, 2, 1)] };
  }
  return best.uv;
}

/** The outlines in UVs of some triangles. */
function outlinesOf({ uvs, indices }: Cage, isIn: (corners: Corners) => boolean): Outline[] {
  const next = new Map<string, [number, number]>();
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [...indices.subarray(i, i + 3)] as Corners;
    if (!isIn(corners)) continue;
    for (const [k, from] of corners.entries()) {
      const to = corners[(k + 1) % 3]!;
      if (!next.delete(`${to} ${from}`)) next.set(`${from} ${to}`, [from, to]);
    }
  }
  // Outlines may meet at a vertex.
  const edges = new Map<number, number[]>();
  for (const [from, to] of next.values()) edges.set(from, [...(edges.get(from) ?? []), to]);
  const outlines: Outline[] = [];
  for (const start of edges.keys())
    while (edges.get(start)!.length > 0) {
      const outline: [number, number][] = [];
      for (let v: number | undefined = start; v !== undefined; v = edges.get(v)!.pop())
        outline.push([uvs[2 * v]!, uvs[2 * v + 1]!]);
      outlines.push(outline.slice(0, -1)); // it ends where it begins
    }
  return outlines;
}

/** Hands and feet: what is beyond wrists and below ankles. */
function limbRegions(cage: Cage): Record<string, Outline[]> {
  const { landmarks, positions } = cage;
  const isBeyond = (end: string, before: string, v: number) =>
    ['left', 'right'].some((side) => {
      const [to, from] = [landmarks[`${end}_${side}`]!, landmarks[`${before}_${side}`]!];
      const along = to.map((x, k) => x - from[k]!);
      const off = to.map((x, k) => positions[3 * v + k]! - x);
      const size = Math.hypot(...along);
      return off.reduce((sum, x, k) => sum + x * along[k]!, 0) > 0 && Math.hypot(...off) < size;
    });
  return {
    hands: outlinesOf(cage, (corners) => corners.every((v) => isBeyond('joint_wrist', 'joint_elbow', v))),
    feet: outlinesOf(cage, (corners) => corners.every((v) => isBeyond('joint_ankle', 'joint_knee', v))),
  };
}

const rounded = (outlines: readonly Outline[]) =>
  outlines.map((outline) => outline.map((uv) => uv.map((x) => Math.round(1e5 * x) / 1e5)));

for (const name of process.argv.slice(2)) {
  const cage = await loadTemplate(name as TemplateName);
  const spots = faceRegions((landmark) => cage.landmarks[landmark]!.slice(0, 2) as Spot);
  const regions: Record<string, Outline[]> = {};
  for (const [region, outlines] of Object.entries(spots))
    regions[region] = outlines.map((outline) => outline.map((spot) => uvInFront(cage, spot)));
  if (cage.kind === 'body') Object.assign(regions, limbRegions(cage));
  const path = `examples/samples/templates/${name}.glb`;
  const document = await new NodeIO().read(path);
  const [mesh] = document.getRoot().listMeshes();
  mesh!.setExtras({
    ...mesh!.getExtras(),
    regions: Object.fromEntries(Object.entries(regions).map(([region, outlines]) => [region, rounded(outlines)])),
  });
  await new NodeIO().write(path, document);
}
