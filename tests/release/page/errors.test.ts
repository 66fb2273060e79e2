import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { mkdir, mkdtemp, rm, truncate, writeFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { PNG } from 'pngjs';
import { glbOf, tetrahedron } from '../../support/glb';
import { texturedBox } from '../../support/models';
import {
  drop,
  glb,
  inRepository,
  passed,
  Site,
  settled,
  shownCounts,
  shownError,
  type Upload,
  type Visit,
} from '../../support/site';

let site: Site;
// One page for all of it: it must come through everything.
let visit: Visit;
before(async () => {
  site = await Site.open();
  visit = await site.visit({ viewport: { width: 700, height: 500 } });
});
after(() => site?.close());

const sound = tetrahedron();
const lizard = readFileSync(inRepository('examples/samples/lizard/target.glb'));
const positions = (at: number, value: number): Float32Array =>
  Float32Array.from(sound.positions, (old, i) => (i === at ? value : old));
const { uvs: _, ...withoutUvs } = tetrahedron(2);

/** Everything that can be wrong with a file, where it is given, and what the page must say. */
const kBad: { what: string; input: 'target' | 'cage' | 'texture'; file: Upload; says: RegExp }[] = [
  {
    what: 'a position that is NaN',
    input: 'target',
    file: glb('nan.glb', glbOf({ ...sound, positions: positions(7, NaN) }, 'thing')),
    says: /nan\.glb: .*positions\[7\] = NaN is not a finite number/,
  },
  {
    what: 'a position that is infinite',
    input: 'cage',
    file: glb('far.glb', glbOf({ ...sound, positions: positions(4, Infinity) }, 'thing')),
    says: /far\.glb: .*positions\[4\] = Infinity is not a finite number/,
  },
  {
    what: 'an index out of range',
    input: 'target',
    file: glb('index.glb', glbOf({ ...sound, indices: Uint16Array.of(0, 2, 1, 0, 1, 9) }, 'thing')),
    says: /index\.glb: .*"thing" has indices\[5\] = 9, .*out of range \(4 vertices\)/,
  },
  {
    what: 'a cage without UVs',
    input: 'cage',
    file: glb('bare.glb', glbOf(withoutUvs, 'thing')),
    says: /bare\.glb: .*cage\.uvs is missing/,
  },
  {
    what: 'a mesh without triangles',
    input: 'target',
    file: glb('empty.glb', glbOf({ ...sound, indices: new Uint16Array() }, 'thing')),
    says: /empty\.glb: .*no triangles/,
  },
  {
    what: 'a mesh without vertices',
    input: 'cage',
    file: glb(
      'void.glb',
      glbOf({ positions: new Float32Array(), indices: new Uint16Array(), uvs: new Float32Array() }, 'thing'),
    ),
    says: /void\.glb: .*no triangles/,
  },
  {
    what: 'a GLB cut short',
    input: 'target',
    file: glb('short.glb', lizard.subarray(0, lizard.length - 1000)),
    says: new RegExp(`short\\.glb: .*cut short.*${lizard.length - 1000} of its ${lizard.length} bytes`),
  },
  {
    what: 'a GLB cut within its header',
    input: 'cage',
    file: glb('stub.glb', lizard.subarray(0, 15)),
    says: /stub\.glb: .*ends after 15 bytes/,
  },
  {
    what: 'a file that is no GLB',
    input: 'target',
    file: glb('poem.glb', Buffer.from('Shall I compare thee to a summer’s day?')),
    says: /poem\.glb: .*not a GLB or glTF file/,
  },
  {
    what: 'JSON that is no glTF',
    input: 'cage',
    file: glb('package.gltf', Buffer.from('{"name":"thing"}')),
    says: /package\.gltf: .*not a glTF model/,
  },
  { what: 'an empty file', input: 'target', file: glb('nothing.glb', Buffer.alloc(0)), says: /nothing\.glb: .*empty/ },
  {
    what: 'a model of points',
    input: 'target',
    file: glb('cloud.glb', glbOf({ ...sound, mode: 0 }, 'thing')),
    says: /cloud\.glb: the file contains no triangles/,
  },
  {
    what: 'a texture that is no image',
    input: 'texture',
    file: { name: 'text.png', mimeType: 'image/png', buffer: Buffer.from('no image') },
    says: /text\.png: the browser cannot read this image/,
  },
];

for (const { what, input, file, says } of kBad) {
  test(`${what} is reported, and the next file works`, async () => {
    const { page, complaints } = visit;
    const before = await shownCounts(page);
    await page.getByTestId(`${input}-input`).setInputFiles(file);
    assert.equal(await settled(page), 'error');
    assert.match(await shownError(page), says);
    assert.deepEqual(await shownCounts(page), before, 'what was shown stays');

    await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', glbOf(tetrahedron(2), 'thing')));
    await page.getByTestId('target-input').setInputFiles(glb('thing.glb', glbOf(sound, 'thing')));
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.equal(await shownError(page), '');
    assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });

    await page.getByTestId('sample-select').selectOption({ index: 0 });
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.deepEqual(await shownCounts(page), before);
    assert.deepEqual(complaints, []);
  });
}

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
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.match(await shownError(page), says, kind);
    assert.match(await shownError(page), / White is shown in its place\.$/);
    assert.ok((await shownCounts(page)).cosmetic > 0);
  }
  // It was read, and need not be said again.
  await page.locator('#alert-close').click();
  await page.getByTestId('preset').selectOption('paper');
  assert.equal(await settled(page), 'ready');
  assert.equal(await shownError(page), '');
  assert.ok(
    complaints.every((complaint) => /Couldn't load texture|blob:/.test(complaint)),
    complaints.join(),
  );
  complaints.length = 0;
});

test('known files are opened and others are reported', async () => {
  const { page } = visit;
  const text = { name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('hello') };
  await drop(page, [text]);
  assert.equal(await settled(page), 'error');
  assert.equal(
    await shownError(page),
    'notes.txt: this is not a GLB or glTF file; models must be GLB or glTF, paints PNG, JPEG or WebP',
  );
  await page.locator('#alert-close').click();
  assert.equal(await shownError(page), '');
  const thing = { name: 'thing.obj', mimeType: '', buffer: Buffer.from('o thing\nv 0 0 0\n') };
  const picture = {
    name: 'thing.png',
    mimeType: 'image/png',
    buffer: PNG.sync.write(new PNG({ width: 4, height: 4 })),
  };
  await drop(page, [thing, picture]);
  assert.equal(await settled(page), 'error');
  assert.match(await shownError(page), /thing\.obj: .*an OBJ file/);
  await page.locator('#alert-close').click();
  await drop(page, [picture, text]);
  await page.locator('#error', { hasText: 'notes.txt was ignored' }).waitFor();
  assert.equal(await settled(page), 'ready');
  await page.locator('#alert-close').click();

  const [small, large, cage] = [
    glb('cage-a.glb', glbOf(tetrahedron(), 'thing')),
    glb('cage-b.glb', lizard),
    glb('cage.glb', glbOf(tetrahedron(2), 'thing')),
  ];
  for (const [files, slots, says] of [
    [
      [small, large],
      ['cage-b.glb', 'cage-a.glb'],
      'cage-a.glb and cage-b.glb are both named as cages; the one with more triangles is used as the target.',
    ],
    [
      [{ ...small, name: 'a.glb' }, cage, text, { ...small, name: 'c.glb' }],
      ['a.glb', 'cage.glb'],
      'notes.txt and 1 more were ignored: only one target, one cage and one paint can be opened at a time.',
    ],
  ] as const) {
    await drop(page, [...files]);
    assert.equal(await settled(page), 'ready', await shownError(page));
    assert.deepEqual(
      [await page.locator('#target-name').textContent(), await page.locator('#cage-name').textContent()],
      slots,
    );
    assert.equal(await shownError(page), says);
  }
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
    assert.equal(await settled(page), 'ready', await shownError(page));
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
    await page.locator('#target-name', { hasText: 'scene.gltf' }).waitFor();
    assert.equal(await settled(page), 'ready', await shownError(page));
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
  assert.equal(await settled(page), 'ready', await shownError(page));
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
  assert.equal(await settled(page), 'ready', await shownError(page));
  assert.equal(await shownError(page), '');
});

test('a sample that fails to load has no effect, and waiting files do not mix with the current scene', async () => {
  const { page } = await site.visit({}, (page) =>
    page.route(/(car\/target|human\/cage)\.glb$/, (route) => route.abort()).then(() => {}),
  );
  const again = async (): Promise<object> => {
    await page.getByTestId('preset').selectOption('paper');
    assert.equal(await settled(page), 'ready', await shownError(page));
    const counts = await shownCounts(page);
    await page.getByTestId('preset').selectOption('default');
    assert.equal(await settled(page), 'ready', await shownError(page));
    return { paper: counts, default: await shownCounts(page), cage: await page.locator('#cage-name').textContent() };
  };
  const before = await again();
  await page.getByTestId('sample-select').selectOption('car');
  assert.equal(await settled(page), 'error');
  assert.match(await shownError(page), /^car\/target\.glb: /);
  assert.deepEqual(await again(), before);
  await drop(page, [glb('target.glb', Buffer.from('glTF')), glb('cage.glb', glbOf(tetrahedron(4), 'thing'))]);
  assert.equal(await settled(page), 'error');
  assert.deepEqual(await again(), before);

  // What a link says of a sample that does not come is not said of the next one.
  await page.evaluate(() => (location.hash = 'sample=human&deform=bend,1'));
  await page.getByTestId('error').filter({ hasText: 'human/cage.glb' }).waitFor();
  await page.unroute(/(car\/target|human\/cage)\.glb$/);
  await page.getByTestId('sample-select').selectOption('human');
  assert.equal(await settled(page), 'ready', await shownError(page));
  const straight = await shownCounts(page);
  await page.getByTestId('sample-select').selectOption('lizard');
  assert.equal(await settled(page), 'ready');
  await page.getByTestId('sample-select').selectOption('human');
  assert.equal(await settled(page), 'ready');
  assert.deepEqual(await shownCounts(page), straight);
});

test('warnings about files stay while borders are cut', async () => {
  const { page } = await site.visit();
  await page.getByTestId('exact-borders').check({ force: true });
  assert.equal(await settled(page), 'ready');
  await drop(page, [
    glb('a.glb', glbOf(tetrahedron(1), 'thing')),
    glb('b.glb', glbOf(tetrahedron(2), 'thing')),
    glb('cage.glb', glbOf(tetrahedron(4), 'thing')),
  ]);
  assert.equal(await settled(page), 'ready');
  await passed(page, 1500);
  assert.equal(await settled(page), 'ready');
  assert.match(await shownError(page), / was ignored: /);
});
