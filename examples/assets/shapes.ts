import { fromSolid, type Mesh, manifold, withCreasedNormals, withMeshNormals } from './mesh.ts';
import { add, frame, mix, scale, sub, type Vec3 } from './vec.ts';

/** A ball with its pole along `forward` and UVs whose centre (0.5, 0.5) is that pole, so an iris is a disc in the texture. */
export const eyeball = (
  centre: Vec3,
  radius: number,
  forward: Vec3,
  rings: number,
  segments: number,
  cornea = 0.06,
): Mesh => {
  const [right, up, front] = frame(forward);
  const positions: number[] = [];
  const uvs: number[] = [];
  const normals: number[] = [];
  const put = (angle: number, turn: number): void => {
    const s = Math.sin(angle);
    const d = add(add(scale(right, s * Math.cos(turn)), scale(up, s * Math.sin(turn))), scale(front, Math.cos(angle)));
    const bulge = angle < 0.6 ? cornea * (1 - (angle / 0.6) ** 2) : 0;
    positions.push(...add(centre, scale(d, radius * (1 + bulge))));
    normals.push(...d);
    const r = (0.48 * angle) / Math.PI;
    uvs.push(0.5 + r * Math.cos(turn), 0.5 - r * Math.sin(turn));
  };
  put(0, 0);
  // Closer rings in front, where one looks.
  for (let i = 1; i <= rings; i++)
    for (let j = 0; j < segments; j++)
      put(Math.PI * (i / (rings + 1)) ** 1.25, (2 * Math.PI * (j + (i % 2) / 2)) / segments);
  // The back pole is drawn out into a ring in the texture: one vertex per triangle.
  const back = positions.length / 3;
  for (let j = 0; j < segments; j++) put(Math.PI, (2 * Math.PI * (j + 0.5)) / segments);
  const indices: number[] = [];
  const at = (i: number, j: number): number => 1 + (i - 1) * segments + (j % segments);
  for (let j = 0; j < segments; j++) {
    indices.push(0, at(1, j), at(1, j + 1));
    for (let i = 1; i < rings; i++) {
      const odd = i % 2; // odd rings are turned by half a step
      if (odd) indices.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
      else indices.push(at(i, j), at(i + 1, j), at(i, j + 1), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
    indices.push(at(rings, j), back + j, at(rings, j + 1));
  }
  return {
    positions: Float32Array.from(positions),
    normals: Float32Array.from(normals),
    uvs: Float32Array.from(uvs),
    indices: Uint32Array.from(indices),
  };
};

/** One cross-section of a swept shape: its centre, half width and half depth. */
export interface Ring {
  centre: Vec3;
  width: number;
  depth: number;
}

/** A shape swept through rings, ending in a point: a tooth, a claw. Widths go along `across`. The first ring stays open: it is buried in what it grows from. */
export const spike = (rings: readonly Ring[], tip: Vec3, across: Vec3, sides: number): Mesh => {
  const positions: number[] = [];
  const uvs: number[] = [];
  rings.forEach((ring, i) => {
    const next = rings[i + 1]?.centre ?? tip;
    const [right, w] = frame(sub(next, ring.centre), across);
    const d = scale(right, -1);
    for (let s = 0; s < sides; s++) {
      const a = (2 * Math.PI * s) / sides;
      positions.push(...add(ring.centre, add(scale(w, ring.width * Math.cos(a)), scale(d, ring.depth * Math.sin(a)))));
      uvs.push(s / sides, 1 - i / rings.length);
    }
  });
  const top = positions.length / 3;
  positions.push(...tip);
  uvs.push(0.5, 0);
  const indices: number[] = [];
  for (let i = 0; i < rings.length; i++)
    for (let s = 0; s < sides; s++) {
      const [a, b] = [i * sides + s, i * sides + ((s + 1) % sides)];
      if (i + 1 < rings.length) indices.push(a, b, b + sides, a, b + sides, a + sides);
      else indices.push(a, b, top);
    }
  return withMeshNormals({
    positions: Float32Array.from(positions),
    uvs: Float32Array.from(uvs),
    indices: Uint32Array.from(indices),
  });
};

/** Points at equal distances along a polyline, ends left out by half a step. */
export const alongLine = (line: readonly Vec3[], count: number): { at: Vec3; ahead: Vec3 }[] => {
  const lengths = line.slice(1).map((p, i) => Math.hypot(...sub(p, line[i]!)));
  const total = lengths.reduce((a, b) => a + b, 0);
  return Array.from({ length: count }, (_, k) => {
    let left = (total * (k + 0.5)) / count;
    let i = 0;
    while (i < lengths.length - 1 && left > lengths[i]!) left -= lengths[i++]!;
    return { at: mix(line[i]!, line[i + 1]!, left / lengths[i]!), ahead: sub(line[i + 1]!, line[i]!) };
  });
};

/** A profile (distance from the axis, place along it), turned about an axis parallel to x through `centre`; both ends stay open. */
export const lathe = (centre: Vec3, profile: readonly (readonly [number, number])[], segments: number): Mesh => {
  const positions: number[] = [];
  for (const [r, x] of profile)
    for (let j = 0; j < segments; j++) {
      const a = (2 * Math.PI * j) / segments;
      positions.push(centre[0] + x, centre[1] + r * Math.sin(a), centre[2] + r * Math.cos(a));
    }
  const indices: number[] = [];
  for (let i = 0; i + 1 < profile.length; i++)
    for (let j = 0; j < segments; j++) {
      const [a, b] = [i * segments + j, i * segments + ((j + 1) % segments)];
      indices.push(a, b, b + segments, a, b + segments, a + segments);
    }
  return withMeshNormals({ positions: Float32Array.from(positions), indices: Uint32Array.from(indices) });
};

/**
 * A wheel rim about an axis parallel to x through `centre`, its face towards +x: a profile (distance from the axis, place along
 * it; closed on the axis), turned, with a window between every two spokes.
 */
export const spokedRim = (
  centre: Vec3,
  profile: readonly (readonly [number, number])[],
  segments: number,
  spokes: number,
  from: number,
  to: number,
): Mesh => {
  const { Manifold } = manifold;
  let solid = Manifold.revolve([profile.map(([r, x]) => [r, x] as [number, number])], segments);
  const half = (Math.PI / spokes) * 0.72;
  const window = [
    ...[-1, 0, 1].map((k) => [to, half * k] as const),
    ...[1, -1].map((k) => [from, half * 0.62 * k] as const),
  ].map(([r, a]) => [r * Math.cos(a), r * Math.sin(a)] as [number, number]);
  for (let k = 0; k < spokes; k++) {
    const hole = Manifold.extrude([window], 1, 0, 0, [1, 1], true).rotate([0, 0, ((k + 0.5) * 360) / spokes]);
    solid = solid.subtract(hole);
  }
  // The solid's axis is z: x, y and z of the model are its z, x and y.
  const mesh = fromSolid(solid, ([a, b, c]) => [centre[0] + c, centre[1] + a, centre[2] + b]);
  return withCreasedNormals(mesh, 0.6);
};
