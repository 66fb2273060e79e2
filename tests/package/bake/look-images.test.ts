// The images of looks, and of models that get one: costly, wrong, or of kinds that the package reads itself.
import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { type PaintOptions, paintGlb } from 'cagecast/gltf';
import type { SavedLayer, SavedLayers } from 'cagecast/three';
import { PNG } from 'pngjs';
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
