// The images of looks, and of models that get one: costly, wrong, or of kinds that the package reads itself.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { crc32, deflateSync } from 'node:zlib';
import { type PaintOptions, paintGlb } from 'cagecast/gltf';
import type { SavedLayer, SavedLayers } from 'cagecast/three';
import { PNG } from 'pngjs';
import { decodePng } from '../../../wasm/src/gltf/look/png.js';
import { islandCage, texturedBox } from '../../support/models';
import { picture } from './reference.js';

type Image = ReturnType<typeof picture>;
const pngOf = ({ width, height, data }: Image): Buffer =>
  PNG.sync.write(Object.assign(new PNG({ width, height }), { data: Buffer.from(data) }));
const own = pngOf(picture(96, () => [100, 120, 200, 255]));
const red = pngOf(picture(4, () => [255, 0, 0, 255]));
const urlOf = (bytes: Buffer) => `data:image/png;base64,${bytes.toString('base64')}`;

/** A look of layers with these images. */
const lookOf = (images: string[], layers: Partial<SavedLayer>[]): SavedLayers => ({
  version: 1,
  images,
  layers: layers.map((layer) => ({
    ...{ name: 'layer', image: 0, opacity: 1, tint: '#ffffff' },
    ...{ blend: 'normal', visible: true, region: null },
    ...layer,
  })),
});
const kRed = lookOf([urlOf(red)], [{}]);

let box: Uint8Array;
let cage: Uint8Array;
before(async () => {
  cage = (await islandCage(1)).buffer;
  box = (await texturedBox(own)).buffer;
});
const paint = (look: SavedLayers, more: Partial<PaintOptions> = {}, model = box) =>
  paintGlb(model, { cage, look, ...more });

describe('the images of a look', () => {
  test('are decoded once, however many layers share them', async () => {
    let times = 0;
    const decode: PaintOptions['decode'] = async (bytes) => {
      if (Buffer.from(bytes).equals(red)) ++times;
      return PNG.sync.read(Buffer.from(bytes));
    };
    await paint(lookOf([urlOf(red), urlOf(red)], [{}, { image: 1 }, { normal: 0 }]), { decode });
    assert.equal(times, 1);
  });

  test('are refused if their data URLs are longer than any that save writes', async () => {
    const url = urlOf(Buffer.concat([red, Buffer.alloc(20e6)]));
    const message =
      /^CagecastError: paintGlb: saved\.layers\[1\]\.image is a data URL of 26,66\d,\d{3} characters, more than 23,55\d,\d{3}$/;
    await assert.rejects(paint(lookOf([urlOf(red), url], [{}, { image: 1 }])), message);
  });

  test('are read by a decoder that is synchronous; one that gives no image is named', async () => {
    const sync = (bytes: Uint8Array) => PNG.sync.read(Buffer.from(bytes));
    const { left } = await paint(kRed, { decode: sync as unknown as PaintOptions['decode'] });
    assert.deepEqual(left, []);
    const wrong: [unknown, RegExp][] = [
      [
        undefined,
        /^CagecastError: paintGlb: options\.decode\(…\) is undefined, not an image \{ width, height, data \}$/,
      ],
      [
        { width: 4, height: 4, data: new Uint8Array(3) },
        /^CagecastError: paintGlb: options\.decode\(…\)\.data has 3 bytes/,
      ],
    ];
    for (const [result, message] of wrong)
      for (const isOfModel of [false, true]) {
        const decode = async (bytes: Uint8Array) =>
          (Buffer.from(bytes).equals(own) === isOfModel ? result : PNG.sync.read(Buffer.from(bytes))) as Image;
        await assert.rejects(paint(kRed, { decode }), (error: Error & { argument?: string }) => {
          assert.match(String(error), message);
          return error.argument === 'options';
        });
      }
  });
});

/** A PNG of these chunks. */
function pngWith(header: number[], chunks: [string, Buffer][]): Buffer {
  const chunk = (type: string, content: Buffer) => {
    const named = Buffer.concat([Buffer.from(type), content]);
    const [length, sum] = [Buffer.alloc(4), Buffer.alloc(4)];
    length.writeUInt32BE(content.length);
    sum.writeUInt32BE(crc32(named));
    return Buffer.concat([length, named, sum]);
  };
  const [width, height, type] = header;
  const start = Buffer.alloc(13);
  start.writeUInt32BE(width!, 0);
  start.writeUInt32BE(height!, 4);
  start.set([8, type!], 8);
  const all = [['IHDR', start], ...chunks, ['IEND', Buffer.alloc(0)]] as [string, Buffer][];
  return Buffer.concat([red.subarray(0, 8), ...all.map(([name, content]) => chunk(name, content))]);
}
const packed = (...bytes: number[]): [string, Buffer] => ['IDAT', deflateSync(Buffer.from(bytes))];

describe('PNGs, without a decoder', () => {
  const reasonOf = async (texture: Buffer) =>
    (await paint(kRed, {}, (await texturedBox(texture)).buffer)).left[0]?.reason;

  test('that are too large, or cannot be read, are left out with the reason', async () => {
    const bomb = pngWith([16384, 16384, 6], [packed(0)]);
    assert.match((await reasonOf(bomb))!, /has 16384 × 16384 pixels, more than 8192 × 8192$/);
    assert.match((await reasonOf(pngWith([1, 1, 3], [packed(0, 0)])))!, /cannot be read: has no palette$/);
    assert.match((await reasonOf(pngWith([1, 1, 6], [packed(5, 0, 0, 0, 0)])))!, /has a row with filter 5/);
  });

  test('are read as pngjs reads them: all filters, kinds of colours and clear ones', async () => {
    const clear = Buffer.from([0, 9, 0, 8, 0, 7]);
    const grey = pngWith([2, 1, 0], [['tRNS', Buffer.from([0, 9])], packed(0, 9, 8)]);
    const rgb = pngWith([2, 1, 2], [['tRNS', clear], packed(0, 9, 8, 7, 9, 8, 8)]);
    const rows = [0, 1, 2, 3, 4].flatMap((filter) => [filter, 250, 3, 200, 255, 17, 99, 4, 180]);
    const filters = pngWith([2, 5, 6], [packed(...rows)]);
    for (const png of [grey, rgb, filters]) {
      // It has no colours for the clear one.
      const shown = (data: Uint8Array | Uint8ClampedArray) =>
        [...data].map((byte, i) => (data[i - (i % 4) + 3] === 0 ? 0 : byte));
      assert.deepEqual(shown((await decodePng(png, 'image/png')).data), shown(PNG.sync.read(png).data));
    }
  });
});
