import assert from 'node:assert/strict';
import { test } from 'node:test';
import { checkPictures } from '../../../web/src/loading/given-file';
import { loadModel } from '../../../web/src/loading/load-model';
import { readProject, writeProject } from '../../../web/src/platform/project-file';
import { unzip, zip } from '../../../web/src/platform/zip';
import { marksOf } from '../../../web/src/state/project/bare-part';
import { layersPart } from '../../../web/src/state/project/layers-part';
import { scenePart } from '../../../web/src/state/project/scene-part';
import { wardrobePart } from '../../../web/src/state/project/wardrobe-part';
import { webpOf } from '../../support/files/costly';
import { GlbMaker, tetrahedron } from '../../support/glb';

/** A file of this many nodes that show one mesh. */
function instances(count: number): File {
  const maker = new GlbMaker();
  const mesh = maker.mesh(tetrahedron());
  for (let n = 0; n < count; ++n) maker.node({ mesh });
  return new File([new Uint8Array(maker.finish())], 'many.glb');
}

test('a model that would take all memory is refused before it is loaded', async () => {
  const message =
    'many.glb: the positions of meshes[0] are in 2000 places of the scene; the limit "instances" is 1,000';
  await assert.rejects(loadModel(instances(2000), undefined), { message });
});

test('a model that refers to other files counts them', async () => {
  const maker = new GlbMaker();
  maker.node({ mesh: maker.mesh(tetrahedron()) });
  maker.json.buffers!.push({ byteLength: 8, uri: 'more.bin' });
  maker.json.accessors[0]!.count = 3_000_000;
  delete maker.json.accessors[0]!.bufferView;
  const file = new File([new Uint8Array(maker.finish())], 'box.glb');
  await assert.rejects(loadModel(file, undefined), /box\.glb: the model needs the file more\.bin/);
  const more = new File([new Uint8Array(8)], 'more.bin');
  await assert.rejects(
    loadModel(file, undefined, [more]),
    /box\.glb: .*TEXCOORD_0 has 4 elements for 3000000 vertices/,
  );
});

test('pictures of a project are refused by what they say to be together, paintings counted, before any is decoded', async () => {
  const fileOf = (bytes: Buffer, name = 'a.webp') => new File([new Uint8Array(bytes)], name);
  const none = { files: [], pixels: 0 };
  const large = fileOf(webpOf(8000, 8000)); // 64 million pixels
  await checkPictures([large, large], none);
  const said = /^a\.webp: it has 8,000 × 8,000 pixels; up to it, the layers have 192,000,000, more than 134,217,728$/;
  await assert.rejects(checkPictures([large, large, large], none), { message: said });
  await assert.rejects(checkPictures([large, large], { files: [], pixels: 2 ** 26 }), /the layers have 195,108,864/);
  await assert.rejects(checkPictures([fileOf(webpOf(16_383, 16_383))], none), /16,383 × 16,383 pixels; .*"expansion"/);
  // What real pictures have in bytes, they may have in pixels; bytes that are there once count once.
  const real = fileOf(Buffer.concat([webpOf(8000, 8000), Buffer.alloc(8_000_000)]));
  await checkPictures([real, large, large], none);
  await assert.rejects(checkPictures([real, real, real, real], none), /256,000,000, more than 200,001,600/);
});

test('layers of a project are refused before anything of them is read', async () => {
  const bomb = new File([new Uint8Array(webpOf(8000, 8000))], 'bomb.webp');
  let decoded = 0;
  const part = layersPart({
    session: { checker: {} },
    samples: { samples: [], find: () => ({ paint: { file: 'own.webp' }, sample: {} }) },
    painter: { on() {}, sheetOf: () => assert.fail() },
    images: { check: checkPictures, load: async () => ++decoded, nameOf: () => '', unpack: async () => ++decoded },
  } as never);
  const layer = (sheet: object) => ({ name: 'a', style: {}, sheet });
  const files = () => bomb;
  // Those of samples, too: a project can give any file such a name.
  for (const sheet of [{ file: 'k' }, { file: 'k', paint: 'human/paint.png' }, { file: 'k', drawn: 'tiger' }]) {
    const saved = {
      layers: [layer(sheet), layer({ file: 'p', size: 2048 })],
      away: [layer(sheet), layer(sheet)],
      base: -1,
    };
    await assert.rejects(
      async () => part.read(saved, files),
      /bomb\.webp: it has 8,000 × 8,000 pixels; up to it, the layers have 1/,
    );
  }
  const lists = { layers: Array(17).fill(layer({ file: 'k' })), away: [], base: -1 };
  await assert.rejects(async () => part.read(lists, files), /no list of layers, or too long a one/);
  await assert.rejects(
    async () => part.read({ layers: [layer({ size: 4096, file: 'k' })], base: -1 }, files),
    /a painting has an unknown size/,
  );
  assert.equal(decoded, 0);
});

test('marks of a project take memory for all models together', () => {
  assert.equal(marksOf([3, 2]).length, 5);
  assert.throws(() => marksOf([2 ** 26, 1]), /it has too many marks, 67108865: more than 67108864/);
  assert.throws(() => marksOf([3, 2], 4), /more than 67108864/);
  const model = { files: ['k'] };
  const avatars = Array.from({ length: 3 }, () => ({ name: 'a', model, locks: {}, bare: [2 ** 25] }));
  const read = (list: object[]) =>
    wardrobePart({ kept: {} } as never).read({ at: 0, all: true, avatars: list }, () => new File([], 'a.glb'));
  assert.throws(() => read(avatars), /too many marks, 100663296: more than 67108864/);
  read(avatars.slice(1));
});

test('a file that a project names often counts once', async () => {
  let given: readonly File[] = [];
  const load = async (file: File, others: readonly File[]) => {
    given = [file, ...others];
    return { files: given };
  };
  const part = scenePart({ checker: {} } as never, { samples: [] } as never, { load } as never);
  const [one, other] = [new File([], 'a.glb'), new File([], 'b.bin')];
  const model = { files: ['a', 'b', ...Array(900).fill('b')] };
  await part.read({ target: model, cage: model }, (key) => (key === 'a' ? one : other));
  assert.deepEqual(given, [one, other]);
});

test('a project is a ZIP that holds its files; what is none, or not whole, or of another version is refused', async () => {
  const sizes = new File(['one'], '../a:b.txt', { type: 'text/plain' });
  const whole = await writeProject(
    { rules: 1 },
    new Map<string, Blob>([
      ['k1', sizes],
      ['k2', new Blob(['two'])],
    ]),
  );
  const { parts, files } = await readProject(whole);
  assert.deepEqual(parts, { rules: 1 });
  assert.deepEqual([files('k1').name, files('k1').type, await files('k1').text()], [sizes.name, sizes.type, 'one']);
  assert.equal(await files('k2').text(), 'two');
  assert.throws(() => files('k3'), { message: 'the project is damaged: a file is missing' });
  assert.deepEqual([...(await unzip(whole))!.keys()], ['project.json', '1--a-b.txt', '2-painting']);

  const none = { message: 'this is not a Cagecast project, or not a whole one' };
  for (const other of [new Blob(['A text']), new Blob([]), whole.slice(0, -1), whole.slice(1), await zip([])])
    await assert.rejects(readProject(other), none);
  const bytes = new Uint8Array(await whole.arrayBuffer());
  // What the last record says: that it is one, how many files there are, and where their list begins.
  for (const at of [0, 8, 16]) {
    const damaged = bytes.slice();
    damaged.fill(255, bytes.length - 22 + at, bytes.length - 18 + at);
    await assert.rejects(readProject(new Blob([damaged])), none);
  }
  const withText = (text: string) => zip([{ name: 'project.json', blob: new Blob([text]) }]).then(readProject);
  await assert.rejects(withText('{'), /its text cannot be read/);
  await assert.rejects(withText('{"version": 9}'), /another version of the page/);
  await assert.rejects(
    withText('{"version": 1, "parts": {}, "files": [{"key": 1, "path": "x"}]}'),
    /a file is missing/,
  );
  await assert.rejects(withText('{"version": 1, "parts": {}, "files": 7}'), /no list of files/);
});

test('a project file whose files share their bytes is none: a kilobyte could be gigabytes', async () => {
  const bytes = new Uint8Array(
    await (await zip([{ name: 'painting', blob: new Blob(['x'.repeat(1000)]) }])).arrayBuffer(),
  );
  const view = new DataView(bytes.buffer);
  const [end, list] = [bytes.length - 22, view.getUint32(bytes.length - 6, true)];
  const sharing = (count: number) => {
    const last = bytes.slice(end);
    new DataView(last.buffer).setUint16(10, count, true);
    const entries = Array.from({ length: count }, (_, n) => bytes.slice(list, end).fill(65 + n, 46, 47)); // each has a name
    return new Blob([bytes.slice(0, list), ...entries, last]);
  };
  assert.equal((await unzip(sharing(1)))?.size, 1);
  assert.equal(await unzip(sharing(40)), undefined);
});
