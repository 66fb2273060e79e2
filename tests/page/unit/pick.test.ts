import assert from 'node:assert/strict';
import { test } from 'node:test';
import { InstancedMesh, Matrix4, MeshBasicMaterial, PlaneGeometry, Raycaster, Vector3 } from 'three';
import { extractMesh } from '../../../web/src/loading/extract-mesh';
import { pick } from '../../../web/src/view/pick';

test('a spot on any instance of a mesh is the same place on the first one, where the paint is made', () => {
  const mesh = new InstancedMesh(new PlaneGeometry(), new MeshBasicMaterial(), 2);
  mesh.setMatrixAt(0, new Matrix4().makeTranslation(1, 0, 0));
  mesh.setMatrixAt(1, new Matrix4().makeScale(2, 2, 2).setPosition(10, 0, 0));
  const target = extractMesh(mesh);
  const spots = [1.25, 10.5].map((x) => pick(target, new Raycaster(new Vector3(x, 0.1, 1), new Vector3(0, 0, -1)))!);
  assert.deepEqual(
    spots.map(({ seen }) => seen.x),
    [1.25, 10.5],
  );
  const round = (point: Vector3): number[] => point.toArray().map((value) => Math.round(value * 1e6) / 1e6);
  assert.deepEqual(
    spots.map(({ point }) => round(point)),
    [
      [1.25, 0.1, 0],
      [1.25, 0.05, 0],
    ],
  );
});
