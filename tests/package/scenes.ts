import { existsSync, readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { NodeIO } from '@gltf-transform/core';
import type { Mesh } from 'cagecast';
import { GlbMaker } from '../support/glb.js';

/** A cage and its target. */
export interface Scene {
  name: string;
  cage: Mesh;
  target: Mesh;
}

/** A mesh with UVs and groups. */
type Whole = Mesh & Required<Omit<Mesh, 'poses' | 'names' | 'otherUvSets'>>;

/** Numbers in 0 … 1 that a seed repeats (mulberry32). */
export function random(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** A closed grid of rings and sectors around a centre, its radius a function of the direction; UVs by longitude and latitude. */
export function ball(
  centre: readonly number[],
  radius: (phi: number, theta: number) => number,
  rings: number,
  sectors: number,
): Whole & { indices: Uint32Array } {
  const positions: number[] = [];
  const uvs: number[] = [];
  const indices: number[] = [];
  for (let r = 0; r <= rings; ++r) {
    for (let s = 0; s <= sectors; ++s) {
      const theta = (Math.PI * r) / rings;
      const phi = (2 * Math.PI * (s % sectors)) / sectors;
      const length = radius(phi, theta);
      const sine = r % rings === 0 ? 0 : Math.sin(theta); // poles are one place
      positions.push(
        centre[0]! + length * sine * Math.cos(phi),
        centre[1]! + length * sine * Math.sin(phi),
        centre[2]! + length * Math.cos(theta),
      );
      uvs.push(s / sectors, r / rings);
      if (r === rings || s === sectors) continue;
      const a = r * (sectors + 1) + s;
      const b = a + sectors + 1;
      if (r > 0) indices.push(a, b, a + 1);
      if (r < rings - 1) indices.push(a + 1, b, b + 1);
    }
  }
  return {
    positions: new Float32Array(positions),
    indices: new Uint32Array(indices),
    uvs: new Float32Array(uvs),
    groups: new Uint32Array(positions.length / 3),
  };
}

/** Several meshes as one, a group for each. */
export function join3d(...meshes: Mesh[]): Whole & { indices: Uint32Array } {
  const positions: number[] = [];
  const uvs: number[] = [];
  const indices: number[] = [];
  const groups: number[] = [];
  meshes.forEach((mesh, group) => {
    const first = positions.length / 3;
    for (const value of mesh.positions) positions.push(value);
    for (const value of mesh.uvs ?? new Float32Array((mesh.positions.length / 3) * 2)) uvs.push(value);
    for (const index of mesh.indices) indices.push(first + index);
    for (let v = 0; v < mesh.positions.length / 3; ++v) groups.push(group);
  });
  return {
    positions: new Float32Array(positions),
    indices: new Uint32Array(indices),
    uvs: new Float32Array(uvs),
    groups: new Uint32Array(groups),
  };
}

/** A mesh without the triangles of which a corner is not kept. */
export function within<M extends Mesh>(mesh: M, isKept: (x: number, y: number, z: number) => boolean): M {
  const { positions, indices } = mesh;
  const keeps = (v: number) => isKept(positions[3 * v]!, positions[3 * v + 1]!, positions[3 * v + 2]!);
  const kept = Uint32Array.from(indices).filter((_, i, all) => [0, 1, 2].every((k) => keeps(all[i - (i % 3) + k]!)));
  return { ...mesh, indices: kept };
}

/** A bumpy head with an eye in a socket and a tongue inside, and a cage with a hole over the eye. */
export function head(seed: number, detail = 20): Scene {
  const next = random(seed);
  const [bumps, depth, lobes] = [0.02 + 0.08 * next(), 0.1 + 0.2 * next(), 2 + Math.floor(5 * next())];
  const skin = ball(
    [0, 0, 0],
    (phi, theta) =>
      1 +
      bumps * Math.sin(lobes * phi) * Math.sin(theta) ** 2 -
      depth * Math.exp(-20 * ((phi - 1) ** 2 + (theta - 1.5) ** 2)),
    detail,
    2 * detail,
  );
  const eye = ball(
    [0.85 * Math.cos(1) * Math.sin(1.5), 0.85 * Math.sin(1) * Math.sin(1.5), 0.85 * Math.cos(1.5)],
    () => 0.12,
    8,
    12,
  );
  const tongue = ball([0.1 * next(), 0.1 * next(), 0.1 * next()], (phi) => 0.2 + 0.05 * Math.sin(3 * phi), 6, 9);
  const cage = ball([0, 0, 0], (phi, theta) => 1.15 + 0.05 * Math.sin(2 * phi) * Math.sin(theta), 10, 18);
  const open: number[] = [];
  for (let t = 0; t < cage.indices.length; t += 3) {
    const corner = cage.indices[t]!;
    const [phi, theta] = [2 * Math.PI * cage.uvs![2 * corner]!, Math.PI * cage.uvs![2 * corner + 1]!];
    if (Math.hypot(phi - 1, theta - 1.5) > 0.45) open.push(...cage.indices.subarray(t, t + 3));
  }
  return {
    name: `head, seed ${seed}`,
    cage: { ...cage, indices: new Uint32Array(open) },
    target: join3d(skin, eye, tongue),
  };
}

/** The parts of `cagedFigure`; each has UVs of its own, further to the right, on its cage. */
export const kCagedParts = ['Left_Geo', 'Upper_Geo', 'Lower'];

/** Whether a UV is one of the cage of a part of `cagedFigure`. */
export const isOfCage = (u: number, part: number): boolean => u > part - 1e-3 && u < part + 1.001;

/**
 * A ball, and two halves of one, so close to it that their cages reach into each other; with their cages beside them, under nodes of
 * their own, and a marker. The cages of the halves are open where they meet.
 */
export function cagedFigure(): Uint8Array {
  const maker = new GlbMaker();
  const kRound = 1e-6;
  const halves = (size: number): Mesh[] => {
    const mesh = ball([0.53, 0, 0], () => size, 12, 24);
    return [
      ball([-0.53, 0, 0], () => size, 12, 24),
      within(mesh, (_, __, z) => z > -kRound),
      within(mesh, (_, __, z) => z < kRound),
    ];
  };
  halves(0.5).forEach((mesh, p) => maker.node({ name: kCagedParts[p]!, mesh: maker.mesh(mesh) }));
  halves(0.58).forEach(({ positions, indices, uvs }, p) => {
    const half = {
      positions: positions.map((x) => x / 2),
      indices,
      uvs: uvs!.map((x, i) => (i % 2 === 0 ? x + p : x)),
    };
    const name = `${kCagedParts[p]!.replace('_Geo', '')}_OuterCage`;
    const node = maker.node(
      { name: p === 0 ? `TransferTarget_${name}` : name, mesh: maker.mesh(half), rotation: [0, 0, -1, 0] },
      false,
    );
    maker.node({ children: [node], scale: [2, 2, 2], rotation: [0, 0, 1, 0] });
  });
  maker.node({ name: 'Hat_Att', mesh: maker.mesh(ball([0, 0, 0], () => 2, 6, 9)) });
  return maker.finish();
}

/** A ball of skin with an eye on it, under a cage whose hole leaves a part of the eye bare: too little to fail by the threshold. */
export function smallHole(opening = 0.1): Scene {
  const [phi, theta] = [1, 1.5];
  const eye = ball(
    [0.98 * Math.cos(phi) * Math.sin(theta), 0.98 * Math.sin(phi) * Math.sin(theta), 0.98 * Math.cos(theta)],
    () => 0.15,
    12,
    16,
  );
  const cage = ball([0, 0, 0], () => 1.2, 48, 96);
  const open: number[] = [];
  for (let t = 0; t < cage.indices.length; t += 3) {
    const corner = cage.indices[t]!;
    if (Math.hypot(2 * Math.PI * cage.uvs![2 * corner]! - phi, Math.PI * cage.uvs![2 * corner + 1]! - theta) > opening)
      open.push(...cage.indices.subarray(t, t + 3));
  }
  return {
    name: 'small hole',
    cage: { ...cage, indices: new Uint32Array(open) },
    target: join3d(
      ball([0, 0, 0], () => 1, 24, 48),
      eye,
    ),
  };
}

/** Triangles thrown at random: nothing about it is a well-behaved surface. */
export function soup(seed: number, triangles = 150): Scene {
  const next = random(seed);
  const mesh = (scale: number): Mesh => {
    const positions: number[] = [];
    for (let t = 0; t < triangles; ++t) {
      const centre = [next() - 0.5, next() - 0.5, next() - 0.5];
      for (let corner = 0; corner < 3; ++corner)
        for (let k = 0; k < 3; ++k) positions.push(scale * (centre[k]! + 0.3 * (next() - 0.5)));
    }
    const vertices = positions.length / 3;
    return {
      positions: new Float32Array(positions),
      indices: Uint32Array.from({ length: vertices }, (_, v) => v),
      uvs: Float32Array.from({ length: 2 * vertices }, next),
    };
  };
  return { name: `soup, seed ${seed}`, cage: mesh(1.3), target: mesh(1) };
}

/** A triangle with UVs, and one just under it. */
export function smallest(): { cage: Whole; target: Whole } {
  const mesh = (z: number) => ({
    positions: new Float32Array([0, 0, z, 1, 0, z, 0, 1, z]),
    indices: new Uint32Array([0, 1, 2]),
    uvs: new Float32Array([0, 0, 1, 0, 0, 1]),
    groups: new Uint32Array(3),
  });
  return { cage: mesh(0.1), target: mesh(0) };
}

/** Every folder with a target and a cage: of the samples that were built, and of CAGECAST_ASSETS where that is set. */
export function modelFolders(): string[] {
  const folders = ['examples/samples', process.env['CAGECAST_ASSETS']].filter((folder) => folder !== undefined);
  return folders.flatMap((folder) =>
    existsSync(folder)
      ? readdirSync(folder)
          .filter((name) => !name.startsWith('.')) // one that is being made
          .map((name) => join(folder, name))
          .filter((model) => existsSync(join(model, 'target.glb')) && existsSync(join(model, 'cage.glb')))
      : [],
  );
}

/** Reads a GLB of floats that nothing compresses or moves, by other means than the command does. */
export async function readPlain(path: string): Promise<Mesh> {
  const document = await new NodeIO().readBinary(new Uint8Array(readFileSync(path)));
  const meshes: Mesh[] = [];
  const scene = document.getRoot().getDefaultScene() ?? document.getRoot().listScenes()[0]!;
  scene.traverse((node) => {
    for (const primitive of node.getMesh()?.listPrimitives() ?? []) {
      const matrix = node.getWorldMatrix();
      const position = primitive.getAttribute('POSITION')!;
      const positions = new Float32Array(3 * position.getCount());
      for (let v = 0; v < position.getCount(); ++v) {
        const [x = 0, y = 0, z = 0] = position.getElement(v, []);
        for (let k = 0; k < 3; ++k)
          positions[3 * v + k] = matrix[k]! * x + matrix[4 + k]! * y + matrix[8 + k]! * z + matrix[12 + k]!;
      }
      const indices =
        primitive.getIndices()?.getArray() ?? Uint32Array.from({ length: position.getCount() }, (_, v) => v);
      const uvs = primitive.getAttribute('TEXCOORD_0')?.getArray();
      meshes.push({ positions, indices: Uint32Array.from(indices), ...(uvs && { uvs: Float32Array.from(uvs) }) });
    }
  });
  return join3d(...meshes);
}
