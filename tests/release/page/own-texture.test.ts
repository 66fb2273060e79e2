import assert from 'node:assert/strict';
import { readFile } from 'node:fs/promises';
import { after, before, test } from 'node:test';
import { type Document, type Material, NodeIO, type Primitive } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { PNG } from 'pngjs';
import { Color, SRGBColorSpace } from 'three';
import { image, texel } from '../../support/layers';
import { ball, islandAt, islandCage, texturedBox } from '../../support/models';
import { difference, look, modelArea } from '../../support/picture';
import { primitivesOf, saved, validModel } from '../../support/saved';
import { drop, glb, inRepository, Site, settled, shownError, type Upload } from '../../support/site';

let site: Site;
before(async () => void (site = await Site.open()));
after(() => site?.close());

const kMargin = 1024 / 64; // texels around an island

/** Saves the model with the paint in its own textures. */
async function savedInTexture(page: Page): Promise<{ document: Document; bytes: Buffer; note: string }> {
  await page.locator('#paint-into [value=texture]').check({ force: true });
  const { bytes } = await saved(page, 'export-glb');
  assert.equal(await shownError(page), '');
  return { document: await validModel(bytes), bytes, note: (await page.getByTestId('export-note').textContent())! };
}

const textureOf = (material: Material | null): PNG =>
  PNG.sync.read(Buffer.from(material!.getBaseColorTexture()!.getImage()!));

const isOverlay = (primitive: Primitive): boolean => primitive.getMaterial()?.getName() === 'Cagecast overlay';

/** The UVs of the middle of each triangle. */
function middles(primitive: Primitive, semantic: string): { corners: string; u: number; v: number }[] {
  const indices = primitive.getIndices()!.getArray()!;
  const uvs = primitive.getAttribute(semantic)!;
  return Array.from({ length: indices.length / 3 }, (_, triangle) => {
    const corners = [...indices.subarray(3 * triangle, 3 * triangle + 3)] as number[];
    const mean = (k: number): number => corners.reduce((sum, vertex) => sum + uvs.getElement(vertex, [])[k]!, 0) / 3;
    return { corners: corners.join(), u: mean(0), v: mean(1) };
  });
}

const at = (png: PNG, u: number, v: number): number[] =>
  texel(png, Math.min(png.width - 1, Math.floor(u * png.width)), Math.min(png.height - 1, Math.floor(v * png.height)));

const apart = (a: number[], b: number[]): number => Math.max(...[0, 1, 2].map((k) => Math.abs(a[k]! - b[k]!)));

/** Between bytes of sRGB and linear light. */
const toLinear = (byte: number): number => new Color().setRGB(byte / 255, 0, 0, SRGBColorSpace).r;
const toByte = (linear: number): number => 255 * new Color(linear, 0, 0).convertLinearToSRGB().r;

test('the lizard’s own texture has the paint where the overlay has it, and is unchanged elsewhere', async () => {
  const { page, complaints } = await site.visit();
  const laid = await validModel((await saved(page, 'export-glb')).bytes);
  const { document, note } = await savedInTexture(page);
  assert.equal(note, 'The paint is in one of the model’s own textures.');
  assert.equal(primitivesOf(document).filter(isOverlay).length, 0);
  assert.equal(
    document.getRoot().listTextures().length,
    laid.getRoot().listTextures().length - 1,
    'one copy in place of the original, and none of the paint',
  );

  const [skin, overlay] = [
    primitivesOf(laid).find((primitive) => primitive.getMaterial()?.getName() === 'skin')!,
    primitivesOf(laid).find(isOverlay)!,
  ];
  const [before, after] = [
    textureOf(skin.getMaterial()),
    textureOf(
      primitivesOf(document)
        .find((primitive) => primitive.getMaterial()?.getName() === 'skin')!
        .getMaterial(),
    ),
  ];
  const paint = PNG.sync.read(await readFile(inRepository('examples/samples/lizard/paint-tiger.png')));
  assert.deepEqual([after.width, after.height], [before.width, before.height]);
  const places = new Map(middles(overlay, 'TEXCOORD_0').map((middle) => [middle.corners, middle]));
  const off: number[] = [];
  let bare = 0;
  for (const { corners, u, v } of middles(skin, 'TEXCOORD_0')) {
    const place = places.get(corners);
    if (!place) {
      // What may not be painted touches what is: most of it, not all, is beyond a texel of that.
      if (apart(at(before, u, v), at(after, u, v)) === 0) bare++;
      continue;
    }
    const [over, below] = [at(paint, place.u, place.v), at(before, u, v)];
    const alpha = over[3]! / 255;
    const both = [0, 1, 2].map((k) => toByte(alpha * toLinear(over[k]!) + (1 - alpha) * toLinear(below[k]!)));
    off.push(apart(both, at(after, u, v)));
  }
  off.sort((a, b) => a - b);
  const share = (part: number): number => off[Math.floor(part * off.length)]!;
  assert.ok(
    off.length > 1000 && share(0.5) <= 4 && share(0.9) <= 40,
    `${off.length} painted triangles, off by ${share(0.5)}, ${share(0.9)}, ${share(0.99)}`,
  );
  const forbidden = middles(skin, 'TEXCOORD_0').length - places.size;
  assert.ok(bare > 0.95 * forbidden, `${bare} of ${forbidden} triangles that are not to be painted are as they were`);
  for (const name of ['l-eye', 'tongue', 'upper-teeth']) {
    const imageOf = (from: Document): Uint8Array =>
      primitivesOf(from)
        .find((primitive) => primitive.getMaterial()?.getName() === name)!
        .getMaterial()!
        .getBaseColorTexture()!
        .getImage()!;
    assert.deepEqual(imageOf(document), imageOf(laid), name);
  }
  assert.deepEqual(complaints, []);
});

test('exact borders are baked into the texture too', async () => {
  const { page } = await site.visit();
  const skinOf = (document: Document): PNG =>
    textureOf(
      primitivesOf(document)
        .find((primitive) => primitive.getMaterial()?.getName() === 'skin')!
        .getMaterial(),
    );
  const whole = await savedInTexture(page);
  await page.getByTestId('exact-borders').check();
  await page.waitForFunction(() => /Adds/.test(document.querySelector('[data-testid=borders-note]')!.textContent!));
  assert.equal(await settled(page), 'ready', await shownError(page));
  const cut = await savedInTexture(page);
  assert.equal(cut.note, whole.note);
  const triangles = (document: Document): number =>
    primitivesOf(document).reduce((sum, primitive) => sum + primitive.getIndices()!.getCount() / 3, 0);
  assert.ok(triangles(cut.document) > triangles(whole.document));
  const bare = skinOf(await new NodeIO().read(inRepository('examples/samples/lizard/target.glb')));
  const [before, after] = [difference(bare, skinOf(whole.document)), difference(bare, skinOf(cut.document))];
  // What they cut off is 5 % of the painted area by the model's own UVs; its margin goes with it.
  assert.ok(after < before && after > 0.9 * before, `${before} of the texture is painted, ${after} with exact borders`);
  const changed = difference(skinOf(whole.document), skinOf(cut.document));
  assert.ok(changed > 0.0002 && changed < 0.1, `${changed} of the texture is another`);
});

test('a saved model with baked paint looks like the painted model on the page', async () => {
  const { page } = await site.visit();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const painted = await look(page, area);
  const { bytes } = await savedInTexture(page);
  await page.getByTestId('target-input').setInputFiles(glb('painted.glb', bytes));
  assert.equal(await settled(page), 'ready', await shownError(page));
  await page.locator('#show-paint').uncheck({ force: true });
  const again = await look(page, area);
  assert.ok(difference(painted, again) < 0.03, `${difference(painted, again)} of the picture differs`);
  await page.locator('#show-paint').check({ force: true });
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  assert.equal(await settled(page), 'ready');
  await page.locator('#show-paint').uncheck({ force: true });
  assert.ok(difference(painted, await look(page, area)) > 0.1, 'the paint is no small thing');
});

/** A texture of the model’s own, of one colour, with all kinds of alpha. */
const own = (size: number, color: readonly number[]): Upload =>
  image('own.png', size, (x, y) => [...color, (x * 7 + y * 3) % 256]);

const one = (colorAt: (u: number, v: number) => readonly number[]): Upload =>
  image('paint.png', 256, (x, y) => colorAt((x + 0.5) / 256, (y + 0.5) / 256));

test('charts are painted up to their edge and a margin; every byte beyond is unchanged, transparent ones too', async () => {
  const { page, complaints } = await site.visit();
  const base = own(1024, [10, 20, 200]);
  await drop(page, [await islandCage(1), await texturedBox(base.buffer), one(() => [230, 30, 40, 255])]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  const { document, note } = await savedInTexture(page);
  assert.equal(note, 'The paint is in one of the model’s own textures.');
  const [before, after] = [PNG.sync.read(base.buffer), textureOf(primitivesOf(document)[0]!.getMaterial())];
  const counts = { painted: 0, margin: 0, kept: 0 };
  for (let y = 0; y < 1024; y++) {
    for (let x = 0; x < 1024; x++) {
      const [was, is] = [texel(before, x, y), texel(after, x, y)];
      assert.equal(is[3], was[3], 'alpha stays');
      const [island, beyond] = [islandAt(x, y, 1024, kMargin - 2), islandAt(x, y, 1024, kMargin + 2) === 0];
      if (island !== 0) assert.ok(apart(is, [230, 30, 40]) <= 1, `${x}, ${y} is ${is}`);
      if (beyond) assert.deepEqual(is, was, `${x}, ${y}`);
      counts.painted += Number(island === 1);
      counts.margin += Number(island === -1);
      counts.kept += Number(beyond);
    }
  }
  assert.ok(Math.min(...Object.values(counts)) > 50_000, JSON.stringify(counts));
  assert.deepEqual(complaints, []);
});

test('mirrored halves that share texels are reported; one of them is painted completely', async () => {
  const { page } = await site.visit();
  const cells = one((u, v) => (u < 1 / 3 && v < 1 / 2 ? [230, 30, 40, 255] : [20, 200, 60, 255]));
  await drop(page, [
    await islandCage(1),
    await texturedBox(own(1024, [10, 20, 200]).buffer, { mirrored: true }),
    cells,
  ]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  const { document, note } = await savedInTexture(page);
  assert.match(note, /own UVs overlap, for example in mirrored halves, so 17 % of the paint was left out/);
  const after = textureOf(primitivesOf(document)[0]!.getMaterial());
  // Of the first of the islands.
  const seen = new Set<string>();
  for (let y = 0; y < 512; y++)
    for (let x = 0; x < 341; x++) if (islandAt(x, y, 1024, 0) === 1) seen.add(texel(after, x, y).slice(0, 3).join());
  assert.equal(seen.size, 1, [...seen].slice(0, 5).join(' '));
});

test('KHR_texture_transform is applied', async () => {
  const { page } = await site.visit();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  const base = image('own.png', 1024, (x, y) => [x >> 2, y >> 2, 90, 255]).buffer;
  const found: { bare: PNG; texture: PNG }[] = [];
  for (const moved of [false, true]) {
    // The paint stays.
    await drop(page, [
      await islandCage(1),
      await texturedBox(base, { moved }),
      ...(moved ? [] : [one((u, v) => [255 * u, 40, 255 * v, 200])]),
    ]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    await page.locator('#show-paint').uncheck({ force: true });
    const bare = await look(page, area);
    const { document, note } = await savedInTexture(page);
    assert.equal(note, 'The paint is in one of the model’s own textures.');
    found.push({ bare, texture: textureOf(primitivesOf(document)[0]!.getMaterial()) });
  }
  assert.ok(difference(found[0]!.bare, found[1]!.bare) < 0.001, 'its own texture is seen in the same places');
  assert.ok(
    difference(found[0]!.texture, found[1]!.texture) === 0,
    `${difference(found[0]!.texture, found[1]!.texture)} of the texture differs`,
  );
});

test('textures are resized to the limits, and the base colour factor is baked in', async () => {
  const { page } = await site.visit();
  const half = one((u) => (u < 0.5 ? [230, 30, 40, 255] : [0, 0, 0, 0]));
  for (const [from, to] of [
    [256, 1024],
    [4096, 2048],
  ] as const) {
    const color: [number, number, number, number] = [0.5, 1, 0.25, 1];
    await drop(page, [
      await islandCage(1),
      await texturedBox(image('own.png', from, () => [200, 100, 60, 255]).buffer, { factor: color }),
      half,
    ]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    const material = primitivesOf((await savedInTexture(page)).document)[0]!.getMaterial()!;
    const after = textureOf(material);
    assert.deepEqual([after.width, after.height], [to, to]);
    assert.deepEqual(material.getBaseColorFactor(), [1, 1, 1, 1]);
    const multiplied = [200, 100, 60].map((byte, k) => toByte(color[k]! * toLinear(byte)));
    assert.ok(apart(at(after, 0.9, 0.75), multiplied) <= 1, `${at(after, 0.9, 0.75)} for ${multiplied}`);
    assert.ok(apart(at(after, 1 / 6, 0.25), [230, 30, 40]) <= 1);
  }
});

test('parts without a texture keep an overlay and are named; the choice is disabled without any texture', async () => {
  const { page } = await site.visit();
  await page.getByTestId('sample-select').selectOption('car');
  assert.equal(await settled(page), 'ready');
  const { document, note } = await savedInTexture(page);
  assert.match(
    note,
    /^The paint is in one of the model’s own textures\. On [\w, -]*bumpers[\w, -]* it is an overlay, because there is no suitable texture\.$/,
  );
  const overlays = primitivesOf(document).filter(isOverlay);
  assert.ok(overlays.length > 0);
  const bases = document
    .getRoot()
    .listMeshes()
    .filter((mesh) => mesh.listPrimitives().some(isOverlay))
    .flatMap((mesh) => mesh.listPrimitives().filter((primitive) => !isOverlay(primitive)));
  assert.ok(bases.every((primitive) => primitive.getMaterial()?.getBaseColorTexture() === null));

  await drop(page, [await islandCage(1), { ...(await ball()), name: 'target.glb' }]);
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await page.locator('#paint-into [value=texture]').isDisabled(), true);
  assert.equal(await page.locator('#paint-into [value=overlay]').isChecked(), true);
  assert.equal(primitivesOf(await validModel((await saved(page, 'export-glb')).bytes)).filter(isOverlay).length, 1);
});
