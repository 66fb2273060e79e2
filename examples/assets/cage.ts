import {
  type Bounds,
  clip,
  corners,
  largestPart,
  type Mesh,
  mirror,
  point,
  simplify,
  surface,
  vertexCount,
  withMeshNormals,
} from './mesh.ts';
import type { Sdf } from './sdf.ts';
import { type Slit, slit } from './slit.ts';
import { onOpenEdge, spaceOf } from './space.ts';
import { weldPositions } from './truth.ts';
import { borderLoops, fill, perimeter } from './unwrap.ts';
import { add, length, scale, sub, type Vec3 } from './vec.ts';

export interface CagePlan {
  solid: Sdf; // the model's outer skin, symmetric in x, with everything bridged over that the cage shall bridge
  bounds: Bounds; // of the solid and the distance around it
  edge: number; // edge length of the fine surface the cage is made from
  lens?: (p: Vec3) => Vec3; // as of `surface`; the bounds are then in its space
  distance: number; // from the skin
  keep: (p: Vec3) => number; // negative where the cage has a hole or ends
  triangles: number; // at most this many
  focus?: (p: Vec3) => Vec3; // enlarges the regions that deserve more of them
  seams?: readonly Slit[]; // of one half: vertices on them get copies
  wrap: Mesh; // the outside of this must lie within
  seen: (vertex: number) => boolean; // which vertices of `wrap` are outside
}

/**
 * Moves a point away from spots nearby, and from their mirror images: a `focus` of a plan.
 * @param spots  The middle of each on the left, its radius, and how many times it gets larger at its middle, less one.
 * @param from   What the point was moved to before.
 */
export const enlarged = (
  p: Vec3,
  spots: readonly (readonly [middle: Vec3, radius: number, by: number])[],
  from: Vec3 = p,
): Vec3 => {
  const side = p[0] < 0 ? -1 : 1;
  let out = from;
  for (const [[x, y, z], radius, by] of spots) {
    const away = sub(p, [x * side, y, z]);
    const d = length(away) / radius;
    out = add(out, scale(away, by * Math.exp(-d * d)));
  }
  return out;
};

/** Makes a cage: the offset of the outer skin, holes cut, one half simplified and mirrored, then pushed out where it dips into the skin. */
export const makeCage = (plan: CagePlan): Mesh => {
  const skin = surface(plan.solid, plan.bounds, plan.edge, plan.lens);
  const space = spaceOf(skin);
  // The solid's own field is only nearly a distance; the distance to its surface is.
  const grown: Sdf = (x, y, z) => {
    const rough = plan.solid(x, y, z);
    // Far from the cage it need not be exact.
    if (rough > 4 * plan.distance || rough < -plan.distance) return rough - plan.distance;
    const distance = space.nearest([x, y, z]).distance;
    return (rough < 0 ? -distance : distance) - plan.distance;
  };
  const fine = surface(grown, plan.bounds, plan.edge, plan.lens);
  const clipped = largestPart(
    clip(
      clip(fine, (p) => p[0]),
      plan.keep,
    ),
  );
  // Where the skin bulges, a point above it may lie over the very edge of an opening that is elsewhere.
  const half = fill(
    clipped,
    borderLoops(clipped).filter((loop) => perimeter(clipped, loop) < kMinHole * plan.distance),
  );
  const open = plan.seams ? slit(half, plan.seams) : half;
  const cage = mirror(simplify(open, Math.floor(plan.triangles / 2), rimKeeper(half), plan.focus));
  if (!plan.seams) return pushOut(cage, plan);
  const welded = weldPositions(cage);
  const pushed = pushOut(welded, plan);
  const positions = cage.positions.slice();
  cage.indices.forEach((v, i) => positions.set(point(pushed, welded.indices[i]!), 3 * v));
  return { positions: evened(positions, cage.indices), indices: cage.indices };
};

/** Positions that are mirror images again, after each side was moved on its own; the triangles are as `mirror` makes them. */
const evened = (positions: Float32Array, indices: Uint32Array): Float32Array => {
  const out = positions.slice();
  const half = indices.length / 2;
  for (let i = 0; i < half; i++) {
    const [left, right] = [3 * indices[i - (i % 3) + [0, 2, 1][i % 3]!]!, 3 * indices[half + i]!];
    const x = left === right ? 0 : (positions[left]! - positions[right]!) / 2;
    out.set(
      [x, (positions[left + 1]! + positions[right + 1]!) / 2, (positions[left + 2]! + positions[right + 2]!) / 2],
      left,
    );
    out.set([-x, out[left + 1]!, out[left + 2]!], right);
  }
  return out;
};

const kMinHole = 2; // perimeter of a hole that is meant, in distances
const kRimCorners = 12; // of a whole hole

/** Holds on to some vertices all along each border of one half: small holes would lose their shape, or close. */
const rimKeeper = (half: Mesh): ((p: Vec3) => boolean) => {
  const kept = new Set<string>();
  const onPlane = (v: number): boolean => Math.abs(point(half, v)[0]) < 1e-6;
  for (const loop of borderLoops(half)) {
    const start = loop.findIndex(onPlane);
    const whole = start < 0;
    const turned = whole ? loop : [...loop.slice(start), ...loop.slice(0, start)];
    const runs: number[][] = [[]];
    for (const v of turned) {
      if (!onPlane(v)) runs.at(-1)!.push(v);
      else if (runs.at(-1)!.length > 0) runs.push([]);
    }
    for (const run of runs) {
      const steps = run.map((v, i) => (i === 0 ? 0 : length(sub(point(half, v), point(half, run[i - 1]!)))));
      const spacing = steps.reduce((a, b) => a + b, 0) / (whole ? kRimCorners : kRimCorners / 2);
      let walked = spacing / 2;
      run.forEach((v, i) => {
        walked += steps[i]!;
        if (walked < spacing) return;
        kept.add(point(half, v).join());
        walked = 0;
      });
    }
  }
  return (p) => kept.has(p.join());
};

const kRounds = 60;

/** Moves corners of the cage along their normals until every seen vertex of the skin lies at least a fifth of the distance beneath it. */
const pushOut = (cage: Mesh, plan: CagePlan): Mesh => {
  const least = plan.distance * 0.2;
  let current = cage;
  for (let round = 0; round < kRounds; round++) {
    const space = spaceOf(current);
    const onBorder = onOpenEdge(current);
    const { normals } = withMeshNormals(current);
    const push = new Float64Array(vertexCount(current));
    for (let v = 0; v < vertexCount(plan.wrap); v++) {
      if (!plan.seen(v)) continue;
      const p = point(plan.wrap, v);
      const near = space.nearest(p);
      const missing = near.side > 0 ? near.distance + least : least - near.distance;
      if (missing <= 0 || onBorder(near.point)) continue; // beyond a border there is no beneath
      for (const c of corners(current, near.triangle)) push[c] = Math.max(push[c]!, missing);
    }
    if (push.every((d) => d === 0)) return current;
    const positions = current.positions.map((x, i) => {
      const v = Math.floor(i / 3);
      const moved = x + push[v]! * normals![i]!;
      return i % 3 === 0 && Math.abs(x) < 1e-6 ? 0 : moved;
    });
    current = { positions, indices: current.indices };
  }
  return current;
};
