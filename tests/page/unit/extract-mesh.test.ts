import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BufferAttribute, Mesh, MeshStandardMaterial, PlaneGeometry, Texture } from 'three';
import { extractMesh, meshesOf } from '../../../web/src/loading/extract-mesh';
import { arraysOf } from '../../../web/src/state/arrays';
import { Pose, type Shape } from '../../../web/src/tools/live/pose';

test('UVs are of the channel of the base colour texture, the first ones without a texture', () => {
  const geometry = new PlaneGeometry();
  const second = Float32Array.of(0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5);
  geometry.setAttribute('uv1', new BufferAttribute(second, 2));
  const material = new MeshStandardMaterial();
  const uvs = () => extractMesh(new Mesh(geometry, material), () => 'plane').uvs;
  assert.deepEqual(uvs(), geometry.getAttribute('uv').array);
  material.map = new Texture();
  assert.deepEqual(uvs(), geometry.getAttribute('uv').array);
  material.map.channel = 1;
  assert.deepEqual(uvs(), second);
});

test('as a cage, a model with several sets of UVs keeps in mind that nothing tells which is meant', () => {
  const geometry = new PlaneGeometry();
  const plane = new Mesh(geometry, new MeshStandardMaterial());
  const { mesh, cageMesh } = meshesOf(plane);
  assert.equal(mesh, cageMesh);
  geometry.setAttribute('uv1', new BufferAttribute(Float32Array.of(0, 0, 0.5, 0, 0, 0.5, 0.5, 0.5), 2));
  const several = meshesOf(plane);
  assert.deepEqual([several.mesh.otherUvSets, several.cageMesh.otherUvSets], [undefined, [1]]);
  assert.deepEqual(arraysOf({ mesh: several.cageMesh } as never, several as never).cage.otherUvSets, [1]);
  plane.material.map = new Texture();
  plane.material.map.channel = 1;
  const told = meshesOf(plane);
  assert.equal(told.mesh, told.cageMesh);
});

test('UVs are where the transform of the base colour texture puts them, as in the command', () => {
  const map = new Texture();
  map.offset.set(0.5, 0.75);
  map.rotation = Math.PI / 2;
  map.repeat.set(0.5, 0.25);
  const geometry = new PlaneGeometry();
  const { uvs } = extractMesh(new Mesh(geometry, new MeshStandardMaterial({ map })));
  const own = geometry.getAttribute('uv').array;
  const expected = own.map((_, i) => (i % 2 === 0 ? 0.5 + 0.25 * own[i + 1]! : 0.75 - 0.5 * own[i - 1]!));
  uvs!.forEach((value, i) => assert.ok(Math.abs(value - expected[i]!) < 1e-6, `${uvs} is not ${expected}`));
});

test('morph targets shape a model as its file says; other weights move it from there, and so does a deformation', () => {
  const geometry = new PlaneGeometry();
  const base = [...geometry.getAttribute('position').array];
  geometry.morphAttributes.position = [new BufferAttribute(Float32Array.from(base), 3)];
  geometry.morphTargetsRelative = true;
  const mesh = new Mesh(geometry, new MeshStandardMaterial());
  mesh.morphTargetInfluences = [0.5];
  const extracted = extractMesh(mesh);
  assert.deepEqual(
    [...extracted.positions],
    base.map((x) => 1.5 * x),
  );
  const pose = new Pose(extracted);
  const shape: Shape = { how: 'bend', amount: 0, extent: pose.extent, morphs: new Map([['Morph 1', 2]]) };
  assert.deepEqual(
    [...pose.positions(shape)],
    base.map((x) => 3 * x),
  );
  const bent = { ...shape, amount: 1e-9, morphs: undefined };
  pose.set(pose.positions(bent), bent);
  // To these the renderer adds the morph.
  assert.deepEqual([...mesh.geometry.getAttribute('position').array], base);
});
