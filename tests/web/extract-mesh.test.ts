import assert from 'node:assert/strict';
import { test } from 'node:test';
import { BufferAttribute, Mesh, MeshStandardMaterial, PlaneGeometry, Texture } from 'three';
import { extractMesh } from '../../web/src/scene/extract-mesh';

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
