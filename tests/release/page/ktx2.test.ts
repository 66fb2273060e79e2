import assert from 'node:assert/strict';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { KHRTextureBasisu } from '@gltf-transform/extensions';
import { PNG } from 'pngjs';
import { ktx2Of } from '../../support/ktx2';
import { texel } from '../../support/layers';
import { islandCage, lumpyBall } from '../../support/models';
import { look, modelArea, shareOfHue } from '../../support/picture';
import { saved, validModel } from '../../support/saved';
import { glb, inRepository, openSite, ready, settled, shownCounts, shownError, type Upload } from '../../support/site';

const site = await openSite();

async function ballWith(image: Uint8Array<ArrayBuffer>): Promise<Upload> {
  const document = await new NodeIO().readBinary(new Uint8Array((await lumpyBall(24)).buffer));
  document.createExtension(KHRTextureBasisu).setRequired(true);
  const texture = document.createTexture('colour').setMimeType('image/ktx2').setImage(image);
  const material = document
    .createMaterial('coloured')
    .setBaseColorTexture(texture)
    .setMetallicFactor(0)
    .setRoughnessFactor(1);
  for (const mesh of document.getRoot().listMeshes())
    for (const primitive of mesh.listPrimitives()) primitive.setMaterial(material);
  return glb(
    'target.glb',
    Buffer.from(await new NodeIO().registerExtensions([KHRTextureBasisu]).writeBinary(document)),
  );
}

// 8 × 8 texels of the same colour as Basis Universal’s encoder 2.5 writes them: one cannot be put down by hand.
const kEtc1s =
  'q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAACwAAACUAAAAJAAAALgAAAAAAAAAggAAAAAAAAA6AQAAAAAAAAEA' +
  'AAAAAAAAAAAAAAAAAAAsAAAAAAAAAAIAKACjAQIAAwMAAAgAAAAAAAAAAAA/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIu' +
  'NTAAAAEAAQAqAAAABQAAACsAAAAAAAAAAAAAAAAAAAABAAAAAAAAAAAAAAABwAQAAAAAAAAiApgCIAAAAACCfjQMACYAAAAAAAAQBMAMAAAAAAAAEsisqqqq' +
  'AhTARAAAAAAAABIhAJgAAAAAAABACAETAQAAAAAASBsBYAJAAAAAAAARCAAA';
const kUastcZstd =
  'q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAAAAAAAAAAAAAAAAAAAAAAAAC4AAAAAAAAABoA' +
  'AAAAAAAAQAAAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAAAAAAAAAAAAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIu' +
  'NTAAACi1L/0gQI0AAEgXGYD7/9KAAwACAM2MIANH';
const kColor = [200, 0, 220] as const;
const kHue = 295;

const kImages = {
  UASTC: ktx2Of(...kColor),
  'UASTC packed by Zstandard': new Uint8Array(Buffer.from(kUastcZstd, 'base64')),
  ETC1S: new Uint8Array(Buffer.from(kEtc1s, 'base64')),
};

/** How each is painted into: one is enough of what is the same once it is decoded. */
const kPaints: Record<string, readonly boolean[]> = {
  UASTC: [false],
  'UASTC packed by Zstandard': [],
  ETC1S: [false, true],
};

test('KTX2 textures work under the content security policy, are saved unchanged, and can be painted', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } });
  await page.getByTestId('cage-input').setInputFiles(await islandCage(1));
  await settled(page);
  for (const [kind, image] of Object.entries(kImages)) {
    await page.getByTestId('target-input').setInputFiles(await ballWith(image));
    await ready(page);
    assert.ok((await shownCounts(page)).cosmetic > 0);
    await page.locator('#show-paint').uncheck({ force: true });
    const shown = shareOfHue(await look(page, await modelArea(page)), kHue);
    assert.ok(shown > 0.1, `${shown} of the picture has the colour of ${kind}`);

    await page.locator('#paint-into [value=overlay]').check({ force: true });
    const laid = await validModel((await saved(page, 'export-glb')).bytes);
    const kept = laid
      .getRoot()
      .listTextures()
      .find((texture) => texture.getMimeType() === 'image/ktx2');
    assert.deepEqual(kept?.getImage(), image);

    // Into the texture itself: a PNG, as nothing here writes KTX2.
    await page.locator('#paint-into [value=texture]').check({ force: true });
    for (const painted of kPaints[kind]!) {
      await page
        .getByTestId('layer-list')
        .getByRole('checkbox', { name: 'Show Flowers' })
        .setChecked(painted, { force: true });
      const document = await validModel((await saved(page, 'export-glb')).bytes);
      assert.equal(
        await page.getByTestId('export-note').textContent(),
        'The paint is in one of the model’s own textures.',
      );
      assert.ok(
        document
          .getRoot()
          .listExtensionsUsed()
          .every(({ extensionName }) => extensionName !== 'KHR_texture_basisu'),
      );
      const [texture, ...others] = document.getRoot().listTextures();
      assert.deepEqual([texture!.getMimeType(), others.length], ['image/png', 0]);
      const png = PNG.sync.read(Buffer.from(texture!.getImage()!));
      assert.deepEqual([png.width, png.height], [1024, 1024]);
      const color = texel(png, 700, 512);
      const apart = Math.max(...kColor.map((value, channel) => Math.abs(value - color[channel]!)));
      assert.ok(
        painted ? apart > 30 : apart <= 3,
        `${color}, ${painted ? 'the checker’s' : 'the own'} colour of ${kind}`,
      );
    }
  }
  assert.deepEqual(complaints, []);
});

test('a damaged KTX2 texture is shown in white, and reported', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 800, height: 500 } });
  await page.getByTestId('cage-input').setInputFiles(await islandCage(1));
  await settled(page);
  await page.getByTestId('target-input').setInputFiles(await ballWith(ktx2Of(...kColor).slice(0, 150)));
  await ready(page);
  assert.equal(
    await shownError(page),
    'target.glb: image “colour” cannot be shown: the KTX2 file is cut short after 150 bytes. White is shown in its place.',
  );
  assert.ok((await shownCounts(page)).cosmetic > 0);
  await page.locator('#show-paint').uncheck({ force: true });
  assert.ok(shareOfHue(await look(page, await modelArea(page)), kHue) < 0.001);
  assert.ok(
    complaints.every((complaint) => !/Content Security Policy|EvalError/.test(complaint)),
    complaints.join(),
  );
});

test('the development server serves the transcoder as in the build, and its URL to modules', async () => {
  const { createServer } = await import('vite');
  const server = await createServer({
    configFile: inRepository('web/vite.config.ts'),
    logLevel: 'error',
    server: { host: '127.0.0.1', port: 0 },
  });
  try {
    await server.listen();
    const address = `${server.resolvedUrls!.local[0]}@fs${inRepository('node_modules/three/examples/jsm/libs/basis/basis_transcoder.js')}`;
    const [script, module] = await Promise.all(
      [address, `${address}?url`].map(async (url) => (await fetch(url)).text()),
    );
    assert.match(script!, /var BASIS/);
    assert.doesNotMatch(script!, /newFunc\(Function/);
    assert.match(module!, /^export default ".*basis_transcoder\.js"/);
  } finally {
    await server.close();
  }
});
