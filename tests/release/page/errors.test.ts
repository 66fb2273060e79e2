import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { mkdir, mkdtemp, rm, truncate, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { PNG } from 'pngjs';
import { asset } from '../../support/cages';
import { glbOf, tetrahedron } from '../../support/glb';
import { texturedBox } from '../../support/models';
import { drop, glb, inRepository, kPlay, openSite, ready, settled, shownCounts, shownError } from '../../support/site';

const site = await openSite();
// One page for all of it: it must come through everything.
const visit = await site.visit({ viewport: { width: 700, height: 500 } });

const sound = tetrahedron();
const lizard = readFileSync(inRepository('examples/samples/lizard/target.glb'));

test('a damaged image is shown in white, and reported', async () => {
  const { page, complaints } = visit;
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(4), 'thing')));
  const png = PNG.sync.write(
    Object.assign(new PNG({ width: 64, height: 64 }), {
      data: Buffer.from(Uint8Array.from({ length: 4 * 64 * 64 }, (_, at) => (at * at) >> 3)),
    }),
  );
  const flipped = Buffer.from(png.map((byte, at) => (at > 100 && at < 140 ? byte ^ 0xff : byte)));
  for (const [kind, mimeType, image, says] of [
    ['empty', 'image/png', Buffer.alloc(0), /^box\.glb: image “own” cannot be shown: it is empty\./],
    [
      'of another kind',
      'image/jpeg',
      Buffer.from('what was meant to be an image'),
      /^box\.glb: image “own” cannot be shown: it is not a JPEG file\./,
    ],
    [
      'cut short',
      'image/jpeg',
      Buffer.from([0xff, 0xd8, 0xff, 0xe0, 0, 16]),
      /^box\.glb: image “own” cannot be shown: the JPEG file is cut short after 6 bytes\./,
    ],
    ['damaged', 'image/png', flipped, /^box\.glb: image “own” cannot be shown: the PNG file is damaged\./],
  ] as const) {
    const io = new NodeIO();
    const document = await io.readBinary(new Uint8Array((await texturedBox(png)).buffer));
    document.getRoot().listTextures()[0]!.setMimeType(mimeType).setImage(new Uint8Array(image));
    await page.getByTestId('target-input').setInputFiles(glb('box.glb', Buffer.from(await io.writeBinary(document))));
    await ready(page);
    assert.match(await shownError(page), says, kind);
    assert.match(await shownError(page), / White is shown in its place\.$/);
    assert.ok((await shownCounts(page)).cosmetic > 0);
  }
  // It was read, and need not be said again.
  await page.locator('#alert-close').click();
  await page.getByTestId('preset').selectOption('paper');
  await ready(page);
  assert.equal(await shownError(page), '');
  assert.ok(
    complaints.every((complaint) => /Couldn't load texture|blob:/.test(complaint)),
    complaints.join(),
  );
  complaints.length = 0;
});

test('folders can be dropped; empty ones and files that are too large are reported', async () => {
  const { page, complaints } = visit;
  const folder = await mkdtemp(path.join(tmpdir(), 'cagecast-drop-'));
  try {
    const session = await page.context().newCDPSession(page);
    const dropFolder = async (name: string): Promise<void> => {
      const data = { items: [], files: [path.join(folder, name)], dragOperationsMask: 1 };
      for (const type of ['dragEnter', 'dragOver', 'drop'] as const)
        await session.send('Input.dispatchDragEvent', { type, x: 300, y: 200, data });
    };
    await mkdir(path.join(folder, 'nothing'));
    await dropFolder('nothing');
    await page.getByTestId('error').waitFor();
    assert.equal(await shownError(page), 'nothing: the folder is empty');
    await mkdir(path.join(folder, 'avatar/fitting'), { recursive: true });
    await writeFile(path.join(folder, 'avatar/head.glb'), lizard);
    await writeFile(path.join(folder, 'avatar/fitting/cage.glb'), glbOf(tetrahedron(9), 'thing'));
    await dropFolder('avatar');
    await page.locator('#target-name', { hasText: 'head.glb' }).waitFor();
    await ready(page);
    assert.equal(await page.locator('#cage-name').textContent(), 'cage.glb');
    const { cosmetic } = await shownCounts(page);
    // Files of one name, in the folders of their models.
    const pair = { first: glbOf(tetrahedron(9), 'thing'), second: lizard };
    for (const [name, bytes] of Object.entries(pair)) {
      const length = bytes.readUInt32LE(12);
      const json = JSON.parse(bytes.subarray(20, 20 + length).toString());
      json.buffers[0].uri = 'scene.bin';
      await mkdir(path.join(folder, 'pair', name), { recursive: true });
      await writeFile(path.join(folder, 'pair', name, 'scene.gltf'), JSON.stringify(json));
      await writeFile(path.join(folder, 'pair', name, 'scene.bin'), bytes.subarray(28 + length));
    }
    await dropFolder('pair');
    await page.getByRole('button', { name: 'Only pair/second/scene.gltf' }).click();
    await page.locator('#target-name', { hasText: 'scene.gltf' }).waitFor();
    await ready(page);
    assert.equal((await shownCounts(page)).cosmetic, cosmetic);

    const huge = path.join(folder, 'huge.glb');
    await writeFile(huge, '');
    await truncate(huge, 3e9); // more than a page can hold at once, of which nothing is on the disk
    await page.getByTestId('target-input').setInputFiles(huge);
    assert.equal(await settled(page), 'error');
    assert.equal(
      await shownError(page),
      'huge.glb: the browser cannot read this file (3,000 MB); it may be too large, or deleted',
    );
    assert.deepEqual(complaints, []);
  } finally {
    await rm(folder, { recursive: true });
  }
});

test('missing samples are reported, and own files work', async () => {
  const { page } = await site.visit(
    { viewport: { width: 700, height: 500 } },
    `const fetched = fetch
    globalThis.fetch = (input, options) => String(input).endsWith('index.json') ? Promise.resolve(new Response('', { status: 404 })) : fetched(input, options)`,
  );
  assert.equal(await page.getByTestId('status').textContent(), 'error');
  assert.match(await shownError(page), /samples could not be loaded/);
  await page.getByTestId('target-input').setInputFiles(glb('thing.glb', glbOf(sound, 'thing')));
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(2), 'thing')));
  await ready(page);
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });
});

test('a worker that fails to start is reported, and the next transfer starts another', async () => {
  const kWorker = /\/transfer-worker-[^/]*\.js$/;
  const { page } = await site.visit({ viewport: { width: 700, height: 500 } }, async (page) => {
    await page.route(kWorker, (route) => route.abort());
  });
  assert.equal(await page.getByTestId('status').textContent(), 'error');
  assert.match(await shownError(page), /the transfer could not be started/);
  await page.unroute(kWorker);
  await page.getByTestId('sample-select').selectOption({ index: 1 });
  await ready(page);
  assert.equal(await shownError(page), '');
});

test('warnings about files stay while borders are cut', async () => {
  const { page } = await site.visit();
  await page.getByTestId('exact-borders').check({ force: true });
  await ready(page);
  await drop(page, [
    glb('a.glb', glbOf(tetrahedron(1), 'thing')),
    glb('b.glb', glbOf(tetrahedron(2), 'thing')),
    glb('cage.glb', glbOf(tetrahedron(4), 'thing')),
  ]);
  await ready(page);
  await page.locator('#borders-note', { hasText: 'Adds' }).waitFor();
  await ready(page);
  assert.match(await shownError(page), / was ignored: /);
});

test('while a model loads nothing is said of the one before; of a refused file the message tells, and the chip is of what is there', async () => {
  const { page } = await site.visit({}, kPlay);
  await page.locator('#stage-verdict[data-verdict=good]').waitFor();
  await drop(page, [glb('broken.glb', Buffer.from('glTF'))]);
  assert.equal(await settled(page), 'error');
  assert.match(await shownError(page), /broken\.glb/);
  assert.ok(await page.locator('#stage-verdict').isVisible());
  const said = page.evaluate(
    () =>
      new Promise<string[]>((done) => {
        const root = document.documentElement;
        new MutationObserver(() => {
          if (!root.hasAttribute('data-leaving')) return;
          const all = ['stage-verdict', 'ask', 'alert'];
          done(all.filter((id) => document.getElementById(id)!.checkVisibility()));
        }).observe(root, { attributeFilter: ['data-leaving'] });
      }),
  );
  await drop(page, [glb('bust.glb', asset('human', 'target.glb')), glb('bust-cage.glb', asset('human', 'cage.glb'))]);
  assert.deepEqual(await said, []);
  await ready(page);
  assert.ok(await page.locator('#stage-verdict').isVisible());
});
