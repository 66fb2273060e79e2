// A part whose texture is transparent wherever it lies is not drawn: it neither hides nor is painted.
import assert from 'node:assert/strict';
import { after, test } from 'node:test';
import type { Image } from 'cagecast/engines';
import { paintGlb } from 'cagecast/gltf';
import { extract } from 'cagecast/three';
import { terminate } from 'cagecast/worker';
import { PNG } from 'pngjs';
import { BufferAttribute, BufferGeometry, DataTexture, Group, Mesh, MeshBasicMaterial, RepeatWrapping } from 'three';
import { json } from '../../support/command.js';
import { type GlbMaker, unpackGlb } from '../../support/gltf.js';
import { png, workplace, writeMade } from '../command/workplace.js';
import { ball } from '../scenes.js';

const { cage, target } = workplace('clear-textures');
const veil = ball([0, 0, 0], () => 1.05, 12, 24);

after(terminate);

/** A texture whose right half has some alpha, and whose left half is opaque. */
function halves(alpha: number): Image {
  const [width, height] = [64, 32];
  const data = new Uint8Array(4 * width * height).map((_, i) =>
    i % 4 < 3 ? 200 : (i >> 2) % width < width / 2 ? 255 : alpha,
  );
  return { width, height, data };
}

const pngOf = ({ width, height, data }: Image): Buffer => {
  const image = new PNG({ width, height });
  image.data = Buffer.from(data);
  return PNG.sync.write(image);
};

/** How a veil over a head looks. Its UVs have a share of the texture, from u on. */
interface Look {
  alpha?: number;
  from?: number;
  share?: number;
  mode?: 'BLEND' | 'MASK' | 'OPAQUE';
  cutoff?: number;
  factor?: number;
  clamped?: boolean;
}

const laid = ({ from = 0.55, share = 0.4 }: Look): Float32Array =>
  veil.uvs.map((x, i) => (i % 2 === 0 ? from + share * x : 0.1 + 0.8 * x));

function make(maker: GlbMaker, look: Look): void {
  const { alpha = 0, mode = 'BLEND', cutoff = 0.5, factor = 1, clamped = false } = look;
  maker.json.images = [{ bufferView: maker.view(pngOf(halves(alpha))), mimeType: 'image/png' }];
  maker.json.samplers = [clamped ? { wrapS: 33071, wrapT: 33071 } : {}];
  maker.json.textures = [{ source: 0, sampler: 0 }];
  maker.json.materials = [
    {
      alphaMode: mode,
      ...(mode === 'MASK' && { alphaCutoff: cutoff }),
      pbrMetallicRoughness: { baseColorTexture: { index: 0 }, baseColorFactor: [1, 1, 1, factor] },
    },
  ];
  const { positions, indices } = target;
  maker.node({ name: 'head', mesh: maker.mesh({ positions, indices }) });
  maker.node({ name: 'Veil', mesh: maker.mesh({ ...veil, uvs: laid(look) }, { material: 0 }) });
}

/** Looks, and whether nothing of the veil is drawn. */
const kLooks: [Look, boolean][] = [
  [{}, true],
  [{ alpha: 3 }, true],
  [{ alpha: 40 }, false],
  [{ mode: 'MASK', alpha: 120 }, true],
  [{ mode: 'MASK', alpha: 200 }, false],
  [{ mode: 'MASK', alpha: 200, factor: 0.5 }, true],
  [{ mode: 'MASK', cutoff: 0 }, false],
  [{ mode: 'OPAQUE' }, false],
  [{ from: 0.3 }, false],
  [{ from: 0.05 }, false],
  // The texture begins anew, so that the right half is where it was.
  [{ from: 2.55 }, true],
  [{ from: 2.55, clamped: true }, false],
  [{ from: 0.55, clamped: true }, true],
];

test('the command leaves it out, and paints what is below', async () => {
  const none = await json<{ counts: { cosmetic: number } }>('transfer target.glb --cage cage.glb');
  for (const [look, isClear] of kLooks) {
    writeMade('veiled.glb', (maker) => make(maker, look));
    const { target, counts } = await json<{
      target: { leftOut: { name: string; why: string }[] };
      counts: { cosmetic: number };
    }>('transfer veiled.glb --cage cage.glb');
    const left = target.leftOut.map(({ name, why }) => `${name}: ${why}`);
    assert.deepEqual(left, isClear ? ['Veil: transparent'] : [], JSON.stringify(look));
    if (isClear) assert.deepEqual(counts, none.counts);
  }
});

test('so does paintGlb, if it can decode the texture', async () => {
  const painted = async (look: Look, decode?: (bytes: Uint8Array) => Promise<Image>) => {
    let bytes = new Uint8Array();
    writeMade('veiled.glb', (maker) => {
      make(maker, look);
      bytes = Uint8Array.from(maker.finish());
    });
    const made = await paintGlb(bytes, { cage: { ...cage, uvs: cage.uvs! }, texture: png(200), decode });
    return unpackGlb(made.bytes).json.meshes![1]!.primitives.length > 1;
  };
  const decode = async (bytes: Uint8Array) => PNG.sync.read(Buffer.from(bytes));
  assert.equal(await painted({}, decode), false);
  assert.equal(await painted({ alpha: 200 }, decode), true);
  assert.equal(await painted({}), true, 'it is not known what the texture shows');
  const broken = () => Promise.reject(new Error('of another kind'));
  assert.equal(await painted({}, broken), true);
});

test('so does three.js', () => {
  const meshOf = ({ positions, indices }: typeof veil, uvs: Float32Array, material = new MeshBasicMaterial()): Mesh => {
    const geometry = new BufferGeometry().setIndex(new BufferAttribute(indices, 1));
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute('uv', new BufferAttribute(uvs, 2));
    return new Mesh(geometry, material);
  };
  for (const [look, isClear] of kLooks) {
    const { alpha = 0, mode = 'BLEND', cutoff = 0.5, factor = 1, clamped = false } = look;
    const { width, height, data } = halves(alpha);
    const map = new DataTexture(data, width, height);
    if (!clamped) Object.assign(map, { wrapS: RepeatWrapping, wrapT: RepeatWrapping });
    const alphaTest = mode === 'MASK' ? cutoff : 0;
    const material = new MeshBasicMaterial({ map, opacity: factor, transparent: mode === 'BLEND', alphaTest });
    const head = meshOf(target as typeof veil, new Float32Array((2 * target.positions.length) / 3));
    const root = new Group().add(head, meshOf(veil, laid(look), material));
    const { leftOut } = extract(root);
    assert.deepEqual(
      leftOut.map(({ why }) => why),
      isClear ? ['transparent'] : [],
      JSON.stringify(look),
    );
  }
});
