// A cage with several UV sets: which of them the texture was drawn in.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import type { Mesh as Arrays, Finding } from 'cagecast';
import { cagecast, type PaintedGlb, paintGlb } from 'cagecast/gltf';
import { applyTransfer, inspectModel } from 'cagecast/three';
import { terminate } from 'cagecast/worker';
import { PNG } from 'pngjs';
import { BufferAttribute, BufferGeometry, Mesh } from 'three';
import { fails, json, ok, run } from '../../support/command.js';
import { GlbMaker, glbOf, primitivesOf, unpackGlb } from '../../support/gltf.js';
import { fbxOf, flipped } from '../../support/models.js';
import { png, workplace, write } from '../command/workplace.js';

const { target, cage } = workplace('uv-sets');
const io = new NodeIO();
const texture = png(200);
/** UVs as of a program that packs them anew: other places, half as large. */
const packed = Float32Array.from(cage.uvs!, (x, i) => (i % 2 === 0 ? 1 - x / 2 : x / 2));

after(terminate);

/** A cage with these sets. @param texCoord  The one of its texture, if it has one. */
function cageOf(sets: readonly Float32Array[], texCoord?: number): Buffer {
  const maker = new GlbMaker();
  const mesh = maker.mesh({ positions: cage.positions, indices: cage.indices });
  const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
  for (const [set, uvs] of sets.entries()) attributes[`TEXCOORD_${set}`] = maker.accessor(uvs, 'VEC2');
  if (texCoord !== undefined) {
    maker.json.images = [{ bufferView: maker.view(texture), mimeType: 'image/png' }];
    maker.json.textures = [{ source: 0 }];
    maker.json.materials = [{ pbrMetallicRoughness: { baseColorTexture: { index: 0, texCoord } } }];
    maker.json.meshes[mesh]!.primitives[0]!.material = 0;
  }
  maker.node({ mesh });
  return maker.finish();
}

const drawn = cage.uvs!;
const point = drawn.map(() => 0.5);
write('lightmap-first.glb', cageOf([packed, drawn]));
const { findings: none } = await json<{ findings: Finding[] }>('inspect target.glb --cage cage.glb');

/** The UVs that a transfer adds. */
async function uvsBy(flags: string): Promise<ArrayLike<number>> {
  await ok(`transfer target.glb ${flags} -o out.glb`);
  return primitivesOf(await io.read('out.glb'))[0]!
    .getAttribute('TEXCOORD_1')!
    .getArray()!;
}

/** What is asked of a cage, if anything is. */
async function asked(flags: string): Promise<Finding | undefined> {
  const { verdict, findings } = await json<{ verdict: string; findings: Finding[] }>(`inspect target.glb ${flags}`);
  const found = findings.find(({ code }) => code === 'uvsUnknown');
  if (found) assert.equal(verdict, 'usable');
  assert.deepEqual(findings.length - (found ? 1 : 0), none.length);
  return found;
}

describe('of several UV sets', () => {
  test('the first counts if nothing tells, which is said; and the one that is chosen', async () => {
    const [plain, other] = [await uvsBy('--cage cage.glb'), await uvsBy('--cage lightmap-first.glb')];
    assert.notDeepEqual(other, plain);
    const finding = await asked('--cage lightmap-first.glb');
    assert.match(finding!.sentence, /besides the one that was taken, with other UVs: 1$/);
    assert.deepEqual(finding!.numbers, { others: [1] });
    assert.match(
      await ok('inspect target.glb --cage lightmap-first.glb'),
      /the file of the cage\. By: --set cageUvs=1\n/,
    );
    const chosen = '--cage lightmap-first.glb --set cageUvs=1';
    assert.deepEqual([await uvsBy(chosen), await asked(chosen)], [plain, undefined]);
    const first = '--cage lightmap-first.glb --set cageUvs=0';
    assert.deepEqual([await uvsBy(first), await asked(first)], [other, undefined]);
    assert.equal(await asked('--cage cage.glb'), undefined);
  });

  test('every command says so, unless it was told', async () => {
    const line = /^nothing tells in which UV set of the cage .* that was taken: 1; --set cageUvs=1 takes it$/m;
    const painting = 'transfer target.glb --texture paint.png -o out.glb';
    assert.match(await ok(`${painting} --cage lightmap-first.glb`), line);
    assert.doesNotMatch(await ok(`${painting} --cage lightmap-first.glb --set cageUvs=0`), line);
    assert.match(
      await ok(`${painting} --cage cage.glb --region lightmap-first.glb=paint.png`),
      /was taken: 1; leave no other in its file$/m,
    );
    const [job] = (await run('batch target.glb --cage lightmap-first.glb -o batch.glb')).stdout.split('\n');
    assert.deepEqual(JSON.parse(job!).otherUvSets, [1]);
    const relay = 'relay target.glb --texture paint.png -o relayed.png';
    assert.match(await ok(`${relay} --cage lightmap-first.glb --to cage.glb`), line);
    assert.match(
      await ok(`${relay} --cage cage.glb --to lightmap-first.glb`),
      /leave no other in lightmap-first.glb$/m,
    );
  });

  test('those of the texture of the cage count', async () => {
    write('textured.glb', cageOf([packed, drawn], 1));
    const plain = await uvsBy('--cage cage.glb');
    assert.deepEqual([await uvsBy('--cage textured.glb'), await asked('--cage textured.glb')], [plain, undefined]);
    assert.notDeepEqual(await uvsBy('--cage textured.glb --set cageUvs=0'), plain);
  });

  test('one that repeats another, or is all in one point, is none', async () => {
    const plain = await uvsBy('--cage cage.glb');
    for (const sets of [
      [drawn, drawn],
      [point, drawn],
      [drawn, point],
      [point, drawn, drawn],
    ]) {
      write('alike.glb', cageOf(sets));
      assert.deepEqual([await uvsBy('--cage alike.glb'), await asked('--cage alike.glb')], [plain, undefined]);
    }
  });

  test('names tell, where a format has them', async () => {
    const plain = await uvsBy('--cage cage.glb');
    write('plain.fbx', fbxOf(cage));
    const byFbx = await uvsBy('--cage plain.fbx');
    const named = (...sets: [string, Float32Array][]): string => {
      const layer = (text: string, number: number, name: string, uvs: Float32Array) =>
        text
          .replace('LayerElementUV: 0', `LayerElementUV: ${number}`)
          .replace('UVMap', name)
          .replace(/(?<=UV: \*\d+ \{\s+a: )[^\n]*/, [...flipped(uvs)].join());
      const [, before, own, rest] = /^(.*?)(\t+LayerElementUV: 0 \{.*?\n\t\t\})(.*)$/s.exec(fbxOf(cage))!;
      return before + sets.map(([name, uvs], i) => layer(own!, i, name, uvs)).join('\n') + rest;
    };
    for (const [first, second] of [
      ['LightMapUV', 'DiffuseUV'],
      ['lightmap', 'map1'],
      ['UVSet0', 'UVMap'],
    ] as const) {
      write('named.fbx', named([first, packed], [second, drawn]));
      assert.deepEqual([await uvsBy('--cage named.fbx'), await asked('--cage named.fbx')], [byFbx, undefined], first);
      assert.notDeepEqual(await uvsBy(`--cage named.fbx --set cageUvs=${first}`), byFbx);
      assert.deepEqual(await uvsBy(`--cage named.fbx --set cageUvs=${second}`), byFbx);
    }
    assert.deepEqual(plain.length, byFbx.length);
    write('named.fbx', named(['one', drawn], ['two', packed], ['three', point]));
    assert.deepEqual((await asked('--cage named.fbx'))?.numbers, { others: [1] });
    await fails(
      1,
      'named.fbx: meshes[0].primitives[0] has no UV set "UVMap": there is 0 ("one"), 1 ("two"), 2 ("three")',
      'transfer target.glb --cage named.fbx --set cageUvs=UVMap',
    );
  });

  test('every command takes the choice for --cage', async () => {
    const plain = await uvsBy('--cage cage.glb');
    const uvs = Float32Array.from({ length: (2 * target.positions.length) / 3 }, (_, i) => ((7 * i) % 97) / 97);
    write('unwrapped.glb', glbOf({ ...target, uvs }));
    const levels = new PNG({ width: 64, height: 64 });
    levels.data.forEach((_, i) => (levels.data[i] = i % 4 === 3 ? 255 : (i >> 4) % 256));
    write('levels.png', PNG.sync.write(levels));
    await ok('bake unwrapped.glb --cage cage.glb --texture levels.png -o expected.png');
    await ok('relay target.glb --cage cage.glb --texture levels.png --to cage.glb -o carried.png');
    const chosen = '--cage lightmap-first.glb --set cageUvs=1';
    await ok(`bake unwrapped.glb ${chosen} --texture levels.png -o baked.png`);
    assert.deepEqual(readFileSync('baked.png'), readFileSync('expected.png'));
    await ok(`relay target.glb ${chosen} --texture levels.png --to cage.glb -o relayed.png`);
    assert.deepEqual(readFileSync('relayed.png'), readFileSync('carried.png'));
    await ok(`batch target.glb ${chosen} -o batch.glb --quiet`);
    write(
      'jobs.jsonl',
      JSON.stringify({ target: 'target.glb', cage: 'lightmap-first.glb', cageUvs: 1, output: 'line.glb' }),
    );
    await ok('batch --manifest jobs.jsonl --quiet');
    for (const name of ['batch.glb', 'line.glb'])
      assert.deepEqual(
        primitivesOf(await io.read(name))[0]!
          .getAttribute('TEXCOORD_1')!
          .getArray()!,
        plain,
        name,
      );
    await ok(
      `transfer target.glb --cage cage.glb --texture paint.png --region lightmap-first.glb=paint.png -o two.glb`,
    );
    await fails(
      1,
      'lightmap-first.glb: meshes[0].primitives[0] has no UV set 2: there is 0, 1',
      'transfer target.glb --cage lightmap-first.glb --set cageUvs=2',
    );
    write('jobs.jsonl', JSON.stringify({ target: 'target.glb', cage: 'cage.glb', cageUvs: -1 }));
    const { stdout } = await run('batch --manifest jobs.jsonl');
    assert.match(stdout, /cageUvs." is -1, not the number of a UV set, from 0, or its name/);
  });
});

describe('in code', () => {
  const files = { plain: glbOf(cage), two: cageOf([packed, drawn]) };

  test('paintGlb has an option for the number, and asks', async () => {
    const painted = (cage: Uint8Array, cageUvs?: number): Promise<PaintedGlb> =>
      paintGlb(glbOf(target), { cage, cageUvs, texture });
    const [plain, first, chosen] = [await painted(files.plain), await painted(files.two), await painted(files.two, 1)];
    const asks = ({ findings }: PaintedGlb) => findings.some(({ code }) => code === 'uvsUnknown');
    assert.deepEqual([asks(plain), asks(first), asks(chosen)], [false, true, false]);
    assert.deepEqual(unpackGlb(chosen.bytes), unpackGlb(plain.bytes));
    assert.notDeepEqual(unpackGlb(first.bytes), unpackGlb(plain.bytes));
    await assert.rejects(painted(files.two, 2), /cage: meshes\[0\]\.primitives\[0\] has no UV set 2: there is 0, 1$/);
    await assert.rejects(painted(files.two, 0.5), {
      code: 'badOption',
      message: /options\.cageUvs is 0\.5, not the number/,
    });
    const { code, message } = await paintGlb(glbOf(target), { template: 'car', cageUvs: 1, texture }).catch((e) => e);
    assert.deepEqual([code, message.includes('options.cageUvs is for a cage that is a file')], ['badOption', true]);
  });

  test('so has cagecast, for documents', async () => {
    const added = async (bytes: Buffer, cageUvs?: number) => {
      const document = await io.readBinary(Uint8Array.from(glbOf(target)));
      await document.transform(cagecast({ cage: await io.readBinary(Uint8Array.from(bytes)), cageUvs }));
      return primitivesOf(document)[0]!.getAttribute('TEXCOORD_1')!.getArray()!;
    };
    assert.deepEqual(await added(files.two, 1), await added(files.plain));
    assert.notDeepEqual(await added(files.two), await added(files.plain));
    await assert.rejects(added(files.two, 3), /cage: .*has no UV set 3: there is 0, 1$/);
    await assert.rejects(added(files.two, -1), /cageUvs is -1, not the number of a UV set/);
  });

  test('so have applyTransfer and inspectModel, for three.js', async () => {
    const meshOf = ({ positions, indices }: Arrays, ...sets: Float32Array[]): Mesh => {
      const geometry = new BufferGeometry().setIndex(new BufferAttribute(indices, 1));
      geometry.setAttribute('position', new BufferAttribute(positions, 3));
      for (const [set, uvs] of sets.entries()) geometry.setAttribute(`uv${set || ''}`, new BufferAttribute(uvs, 2));
      return new Mesh(geometry);
    };
    const [plain, two] = [meshOf(cage, drawn), meshOf(cage, packed, drawn)];
    const added = (cage: Mesh, cageUvs?: number) => {
      const model = meshOf(target);
      applyTransfer(model, { cage, cageUvs });
      return model.geometry.getAttribute('uv1').array;
    };
    assert.deepEqual(added(two, 1), added(plain));
    assert.notDeepEqual(added(two), added(plain));
    assert.throws(() => added(two, 2), /cage: .*has no UV set 2: there is 0, 1/);
    assert.throws(() => added(two, -1), { code: 'badOption' });
    const codes = async (cage: Mesh, cageUvs?: number) =>
      (await inspectModel(meshOf(target), { cage, cageUvs })).findings.map(({ code }) => code);
    assert.ok((await codes(two)).includes('uvsUnknown'));
    assert.ok(!(await codes(two, 1)).includes('uvsUnknown'));
    await assert.rejects(codes(two, -1), { code: 'badOption' });
  });
});
