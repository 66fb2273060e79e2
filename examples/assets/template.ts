import { Document, NodeIO } from '@gltf-transform/core';
import { cageFaults } from './check.ts';
import type { Landmarks } from './landmarks.ts';
import { diagonalOf, type Mesh, point, vertexCount } from './mesh.ts';
import { spaceOf } from './space.ts';
import { weldPositions } from './truth.ts';
import { borderLoops } from './unwrap.ts';
import { add, length, mirrorX, scale, sub, type Vec3 } from './vec.ts';

/** A cage to be fitted to other models of its kind, as it ships with the package. */
export interface Template {
  name: string;
  kind: 'head' | 'body' | 'prop';
  cage: Mesh; // symmetric in x, its UVs symmetric in u = 0.5
  landmarks: Landmarks; // of the model that it was made for; inner ones are joints and centres
  holes: Record<string, number[]>; // the vertices of each, in the order of the border
  skin: Mesh; // of the model
}

/** Whether a landmark is inside of a model rather than on its skin. */
const isInner = (name: string): boolean => /^(joint|wrist)_|_centre(_|$)/.test(name);

/**
 * Makes a cage's positions and UVs mirror images to the last bit: u becomes 1 - u where x becomes -x.
 * @throws Error if a vertex has no mirror image.
 */
export const symmetric = (cage: Mesh): Mesh => {
  const us = cage.uvs!.filter((_, i) => i % 2 === 0);
  const shift = 0.5 - (Math.min(...us) + Math.max(...us)) / 2;
  const uvs = cage.uvs!.map((x, i) => (i % 2 === 0 ? x + shift : x));
  const positions = cage.positions.slice();
  const near = 1e-4 * diagonalOf(cage.positions);
  const count = vertexCount(cage);
  const twins = Array.from({ length: count }, (_, v) => {
    const p = mirrorX(point(cage, v));
    let twin = -1;
    let least = kTwin;
    for (let w = 0; w < count; w++) {
      if (length(sub(point(cage, w), p)) > near) continue;
      const off = Math.hypot(uvs[2 * w]! + uvs[2 * v]! - 1, uvs[2 * w + 1]! - uvs[2 * v + 1]!);
      if (off < least) [twin, least] = [w, off];
    }
    if (twin < 0) throw new Error(`symmetric: vertex ${v} at ${p.join(', ')} has no mirror image in the layout`);
    return twin;
  });
  twins.forEach((w, v) => {
    if (w < v) return;
    const half = (a: Float32Array, i: number, j: number, sign: 1 | -1): number => (a[i]! + sign * a[j]!) / 2;
    const x = half(positions, 3 * v, 3 * w, -1);
    const u = half(uvs, 2 * v, 2 * w, -1);
    positions[3 * v] = x;
    positions[3 * w] = v === w ? 0 : -x;
    uvs[2 * v] = 0.5 + u;
    uvs[2 * w] = 0.5 - u;
    for (const k of [1, 2]) positions[3 * v + k] = positions[3 * w + k] = half(positions, 3 * v + k, 3 * w + k, 1);
    uvs[2 * v + 1] = uvs[2 * w + 1] = half(uvs, 2 * v + 1, 2 * w + 1, 1);
  });
  return { positions, uvs, indices: cage.indices };
};

const kTwin = 0.02; // in UV: mirrored vertices lie nearer to their mirrored places than this

/** The border loops of a cage; seams are no borders, and each vertex is the first used of the copies at its position. */
export const holeLoops = (cage: Mesh): number[][] => {
  // Welding numbers positions by their first use in the triangles.
  const copies = new Map<string, number>();
  for (const v of cage.indices) {
    const key = point(cage, v).join();
    if (!copies.has(key)) copies.set(key, v);
  }
  const order = [...copies.values()];
  return borderLoops(weldPositions(cage)).map((loop) => {
    const own = loop.map((v) => order[v]!);
    const start = own.indexOf(Math.min(...own));
    return [...own.slice(start), ...own.slice(0, start)];
  });
};

/**
 * Names the holes of a cage, each by a point near its middle.
 * @throws Error if a hole has no name, or a name no hole of its own.
 */
export const namedHoles = (cage: Mesh, middles: Record<string, Vec3>): Record<string, number[]> => {
  const loops = holeLoops(cage);
  const centres = loops.map((loop) =>
    scale(
      loop.map((v) => point(cage, v)).reduce((a, b) => add(a, b)),
      1 / loop.length,
    ),
  );
  const holes = Object.fromEntries(
    Object.entries(middles).map(([name, middle]) => {
      const distances = centres.map((c) => length(sub(c, middle)));
      return [name, loops[distances.indexOf(Math.min(...distances))]!];
    }),
  );
  if (new Set(Object.values(holes)).size !== loops.length || Object.keys(holes).length !== loops.length)
    throw new Error(`namedHoles: ${Object.keys(holes).length} names for ${loops.length} holes`);
  return holes;
};

const kOffSkin = 1e-3; // of the diagonal
const kExact = 1e-6; // in model units and UV: what rounding leaves of a mirror image
const kBytes = 60_000;

/** What is wrong with a template, one line each; nothing if it is as it should be. */
export const templateFaults = (template: Template, bytes: Uint8Array): string[] => {
  const { cage, kind, landmarks, holes, skin } = template;
  const faults = cageFaults(cage, kind);
  const expect = (holds: boolean, fault: string): void => void (holds || faults.push(fault));
  const all = Array.from({ length: vertexCount(cage) }, (_, v) => v);
  const isMirrored = (v: number): boolean => {
    const p = mirrorX(point(cage, v));
    const [u, w] = [1 - cage.uvs![2 * v]!, cage.uvs![2 * v + 1]!];
    return all.some(
      (o) =>
        Math.abs(cage.uvs![2 * o]! - u) < kExact &&
        Math.abs(cage.uvs![2 * o + 1]! - w) < kExact &&
        length(sub(point(cage, o), p)) < kExact,
    );
  };
  const lone = all.filter((v) => !isMirrored(v));
  expect(lone.length === 0, `vertex ${lone[0]} (and ${lone.length - 1} more) has no mirror image`);
  const space = spaceOf(skin);
  const limit = kOffSkin * diagonalOf(skin.positions);
  for (const [name, p] of Object.entries(landmarks)) {
    const { distance } = space.nearest(p);
    expect(isInner(name) || distance < limit, `${name} is ${distance.toFixed(4)} off the skin`);
  }
  expect(
    Object.values(holes).every((loop) => loop.length >= 3),
    'a hole has fewer than three vertices',
  );
  expect(bytes.length <= kBytes, `${bytes.length} bytes, more than ${kBytes}`);
  return faults;
};

const rounded = (p: Vec3): number[] => p.map((x) => Math.round(x * 1e5) / 1e5 + 0);

/** A template as GLB: positions, UVs and triangles, and in the mesh's extras its kind, landmarks and holes. */
export const writeTemplate = (template: Template): Promise<Uint8Array> => {
  const document = new Document();
  document.getRoot().getAsset().generator = 'cagecast templates';
  const buffer = document.createBuffer();
  const accessor = (type: 'VEC2' | 'VEC3' | 'SCALAR', array: Float32Array | Uint16Array) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const { cage, name, kind, landmarks, holes } = template;
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor('VEC3', cage.positions))
    .setAttribute('TEXCOORD_0', accessor('VEC2', cage.uvs!))
    .setIndices(accessor('SCALAR', Uint16Array.from(cage.indices)));
  const mesh = document
    .createMesh(name)
    .addPrimitive(primitive)
    .setExtras({
      kind,
      landmarks: Object.fromEntries(Object.entries(landmarks).map(([spot, p]) => [spot, rounded(p)])),
      holes,
    });
  document.createScene(name).addChild(document.createNode(name).setMesh(mesh));
  return new NodeIO().writeBinary(document);
};
