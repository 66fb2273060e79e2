import type { SceneMesh } from './scene-file.js';

type Mesh = Required<Pick<SceneMesh, 'positions' | 'indices' | 'uvs'>>;

/** How many pieces the texture of a mesh is in: components over edges with equal position and UV at both ends. */
export function chartCount(mesh: SceneMesh): number {
  const { positions, indices, uvs } = withUvs(mesh);
  const site = (v: number): string =>
    [...positions.subarray(3 * v, 3 * v + 3), ...uvs.subarray(2 * v, 2 * v + 2)].join();
  const sites = Array.from({ length: positions.length / 3 }, (_, v) => site(v));
  const count = indices.length / 3;
  const parents = Array.from({ length: count }, (_, t) => t);
  const find = (t: number): number => {
    while (parents[t] !== t) t = parents[t] = parents[parents[t]!]!;
    return t;
  };
  const firstOn = new Map<string, number>();
  indices.forEach((v, i) => {
    const t = Math.floor(i / 3);
    const edge = [sites[v]!, sites[indices[3 * t + ((i + 1) % 3)]!]!].sort().join(' ');
    const first = firstOn.get(edge);
    if (first === undefined) firstOn.set(edge, t);
    else parents[find(t)] = find(first);
  });
  return parents.filter((parent, t) => parent === t).length;
}

/**
 * The same shape with the texture that a box would have: each triangle is seen along the axis that its normal is nearest to, from
 * one of six sides, which lie side by side in two rows. An ear or a fold is then a chart of its own.
 */
export function unfolded(mesh: SceneMesh): SceneMesh {
  const { positions } = mesh;
  const corner = (v: number): number[] => [...positions.subarray(3 * v, 3 * v + 3)];
  const low = [0, 1, 2].map((k) =>
    positions.reduce((least, x, i) => (i % 3 === k ? Math.min(least, x) : least), Infinity),
  );
  const high = [0, 1, 2].map((k) =>
    positions.reduce((most, x, i) => (i % 3 === k ? Math.max(most, x) : most), -Infinity),
  );
  const size = Math.max(...high.map((x, k) => x - low[k]!));
  const vertices = new Map<string, number>();
  const out = { positions: [] as number[], indices: [] as number[], uvs: [] as number[] };
  for (let i = 0; i < mesh.indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => corner(mesh.indices[i + k]!)) as [number[], number[], number[]];
    const edge = (p: number[]): number[] => p.map((x, k) => x - a[k]!);
    const [e, f] = [edge(b), edge(c)];
    const normal = [0, 1, 2].map((k) => e[(k + 1) % 3]! * f[(k + 2) % 3]! - e[(k + 2) % 3]! * f[(k + 1) % 3]!);
    const axis = normal.reduce((most, x, k) => (Math.abs(x) > Math.abs(normal[most]!) ? k : most), 0);
    const row = normal[axis]! < 0 ? 1 : 0;
    for (const v of mesh.indices.subarray(i, i + 3)) {
      const key = `${v} ${axis} ${row}`;
      if (!vertices.has(key)) {
        const p = corner(v);
        const along = (k: number): number => (0.05 + (0.9 * (p[k % 3]! - low[k % 3]!)) / size) / 3;
        vertices.set(key, out.positions.push(...p) / 3 - 1);
        out.uvs.push(axis / 3 + along(axis + 1), row / 2 + along(axis + 2));
      }
      out.indices.push(vertices.get(key)!);
    }
  }
  return {
    positions: Float32Array.from(out.positions),
    indices: Uint32Array.from(out.indices),
    uvs: Float32Array.from(out.uvs),
  };
}

function withUvs({ positions, indices, uvs }: SceneMesh): Mesh {
  if (uvs === undefined) throw new Error('a mesh without UVs has no UV charts');
  return { positions, indices, uvs };
}
