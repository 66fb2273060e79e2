import assert from 'node:assert/strict';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import type { Mesh } from 'cagecast';
import { BufferAttribute, BufferGeometry, Mesh as Drawn, Group } from 'three';
import { OBJExporter } from 'three/addons/exporters/OBJExporter.js';
import { asset } from '../../../support/cages';
import { fbxOf } from '../../../support/models';
import { drop, kPlay, openSite, ready } from '../../../support/site';

const site = await openSite();

/** The skin of a head. */
async function head(): Promise<Mesh> {
  const document = await new NodeIO().readBinary(new Uint8Array(asset('human', 'target.glb')));
  const primitives = document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());
  const [largest] = primitives.sort((a, b) => b.getIndices()!.getCount() - a.getIndices()!.getCount());
  return {
    positions: new Float32Array(largest!.getAttribute('POSITION')!.getArray()!),
    indices: new Uint32Array(largest!.getIndices()!.getArray()!),
    uvs: new Float32Array(largest!.getAttribute('TEXCOORD_0')!.getArray()!),
  };
}

function objOf({ positions, indices }: Mesh): string {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  return new OBJExporter().parse(new Group().add(new Drawn(geometry)));
}

for (const [ending, make] of [
  ['obj', objOf],
  ['fbx', fbxOf],
] as const)
  test(`what is dropped alone in Play is painted in one go, as a GLB is: ${ending}`, async () => {
    const { page, complaints } = await site.visit({ viewport: { width: 900, height: 700 } }, kPlay);
    await drop(page, [{ name: `bust.${ending}`, mimeType: '', buffer: Buffer.from(make(await head())) }]);
    await page.locator('#target-name', { hasText: 'bust.glb' }).waitFor({ state: 'attached' });
    await ready(page);
    await page.locator('#stage-verdict[data-verdict=good], #stage-verdict[data-verdict=usable]').waitFor();
    assert.match((await page.locator('#stage-verdict-text').textContent())!, /^(Painted|Looks off\?)/);
    assert.equal(await page.locator('#view-mode input:checked').inputValue(), 'result');
    assert.equal(await page.locator('#cage-name').textContent(), 'bust-cage.glb');
    assert.ok(Number(await page.getByTestId('count-cosmetic').textContent()) > 1000);
    assert.deepEqual(complaints, []);
  });
