// The function for glTF-Transform and the writer of files: both make the same of a target, valid and with all that it had.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, describe, test } from 'node:test';
import { Document, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { join as joinMeshes } from '@gltf-transform/functions';
import { CagecastError, type CutTarget, cutBorders, init, type Mesh, type TransferResult, transfer } from 'cagecast';
import { type CagecastOptions, cagecast, type PartRange } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { Vector3 } from 'three';
import { loadFileLayer } from '../support/file-layer.js';
import { richFile } from '../support/files/rich.js';
import {
  assertNear,
  assertTransferred,
  GlbMaker,
  glbOf,
  isOverlay,
  primitivesOf as primitives,
  storedUv,
  validate,
} from '../support/gltf.js';
import { ball, cagedFigure, head, isOfCage, modelFolders } from './scenes.js';

const files = await loadFileLayer();
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const { cage, target } = head(2, 10);
const vertices = target.positions.length / 3;
const texture = new Uint8Array(PNG.sync.write(new PNG({ width: 4, height: 4 })));
const documentOf = (glb: Uint8Array): Promise<Document> => io.readBinary(new Uint8Array(glb));
const arrayOf = (primitive: Primitive, semantic: string) => primitive.getAttribute(semantic)!.getArray()!;
/** The primitives of meshes in the order of the nodes that show them, as numbers of meshes may differ. */
const shown = (document: Document): Primitive[] =>
  document
    .getRoot()
    .listNodes()
    .flatMap((node) => node.getMesh()?.listPrimitives() ?? []);

before(init);

/** A mesh that two nodes show, one of them mirrored; and its attributes in a second mesh, too. */
function shared(): Uint8Array {
  const maker = new GlbMaker();
  const mesh = maker.mesh(ball([0, 0, 0], () => 0.2, 8, 12));
  const other = maker.json.meshes.push(structuredClone(maker.json.meshes[mesh]!)) - 1;
  maker.node({ mesh, name: 'left', translation: [-0.6, 0, 0] });
  maker.node({ mesh, name: 'right', translation: [0.6, 0, 0], scale: [-1, 1, 1] });
  maker.node({ mesh: other, name: 'upper', translation: [0, 0.6, 0] });
  return maker.finish();
}

/** Morph targets of which an overlay needs a part, or nothing. */
function morphing(): Uint8Array {
  const maker = new GlbMaker();
  const mesh = maker.mesh(target);
  const deltas = (size: 2 | 3) =>
    maker.accessor(new Float32Array(size * vertices).fill(0.25), size === 2 ? 'VEC2' : 'VEC3');
  maker.json.meshes[mesh]!.primitives[0]!.targets = [
    { POSITION: deltas(3), TEXCOORD_0: deltas(2) },
    { TEXCOORD_0: deltas(2) },
  ];
  maker.node({ mesh });
  return maker.finish();
}

const cageGlb = glbOf(cage);
const targets: Record<string, { target: Uint8Array; cage: Uint8Array }> = {
  'a plain mesh': { target: glbOf(target), cage: cageGlb },
  'a skinned mesh that morphs': { target: richFile(target, 'skinned'), cage: cageGlb },
  'a mirrored mesh that morphs': { target: richFile(target, 'mirrored'), cage: cageGlb },
  'meshes that share what they have': { target: shared(), cage: cageGlb },
  'morphs of UVs': { target: morphing(), cage: cageGlb },
};
// The others are read as this one; all of them take some seconds.
for (const folder of modelFolders().filter((name) => process.env['CAGECAST_ASSETS'] ?? name.endsWith('lizard')))
  targets[folder] = { target: readFileSync(join(folder, 'target.glb')), cage: readFileSync(join(folder, 'cage.glb')) };

/** What the writer of files makes of a target. */
async function written(glb: Uint8Array, cageFile: Uint8Array, borders: 'triangle' | 'cut') {
  const file = await files.readGltf('target.glb', files.defaultReading, glb);
  const extracted = files.extract(file);
  const around = files.extract(await files.readGltf('cage.glb', files.defaultReading, cageFile)).mesh;
  const result = transfer(around, extracted.mesh);
  const cut = borders === 'cut' ? cutBorders(around, extracted.mesh, result) : undefined;
  const prepared = extracted.parts.map((part) => files.preparePiece(part, result, cut));
  const { data } = await files.writeTransfer(file, extracted, prepared, { paints: [files.paintOf(texture)] });
  return { data, result, cut, mesh: extracted.mesh };
}

describe('the document and the file are the same, and valid', () => {
  for (const [name, { target: glb, cage: cageFile }] of Object.entries(targets)) {
    for (const borders of ['triangle', 'cut'] as const) {
      test(`${name}, borders: ${borders}`, async () => {
        const { data } = await written(glb, cageFile, borders);
        const document = await documentOf(glb);
        await document.transform(cagecast({ cage: await documentOf(cageFile), texture, borders }));
        const own = await io.writeBinary(document);
        for (const bytes of [own, data]) assert.deepEqual(await validate(bytes), []);
        const [ours, theirs] = [shown(await documentOf(own)), shown(await documentOf(data))];
        assert.equal(ours.length, theirs.length);
        ours.forEach((primitive, p) => {
          const other = theirs[p]!;
          const all = (one: Primitive) => [one, ...one.listTargets()];
          all(primitive).forEach((of, i) => {
            const same = all(other)[i]!;
            assert.deepEqual(of.listSemantics().sort(), same.listSemantics().sort());
            for (const semantic of of.listSemantics())
              assert.deepEqual(
                of.getAttribute(semantic)!.getArray(),
                same.getAttribute(semantic)!.getArray(),
                semantic,
              );
          });
          assert.deepEqual([...primitive.getIndices()!.getArray()!], [...other.getIndices()!.getArray()!]);
          const [a, b] = [primitive, other].map((one) => {
            const material = one.getMaterial();
            return [
              material?.getName(),
              material?.getAlphaMode(),
              material?.getRoughnessFactor(),
              material?.getDoubleSided(),
            ];
          });
          assert.deepEqual(a, b);
        });
      });
    }
  }
});

test('new vertices of cut borders have all attributes of those around them, in proportion', async () => {
  for (const kind of ['skinned', 'mirrored'] as const) {
    const glb = richFile(target, kind);
    const { data, cut, mesh } = (await written(glb, cageGlb, 'cut')) as {
      data: Uint8Array;
      cut: CutTarget;
      mesh: Mesh;
    };
    const [[was], [is, overlay]] = (await Promise.all([glb, data].map(documentOf))).map(primitives) as [
      [Primitive],
      [Primitive, Primitive],
    ];
    assert.ok(cut.sources.length / 3 > 20 && cut.indices.length > mesh.indices.length);
    assert.equal(overlay.getIndices()!.getCount(), 3 * cut.cosmeticTriangles.filter((one) => one === 1).length);

    // Each corner is where cutBorders has it, in the winding of the file, and has its UV.
    const corners = is.getIndices()!.getArray()!;
    assert.equal(corners.length, cut.indices.length);
    const vertexOf = new Map<number, number>();
    corners.forEach((vertex: number, i: number) => {
      const from = kind === 'mirrored' && i % 3 > 0 ? i + (i % 3 === 1 ? 1 : -1) : i;
      assert.equal(vertexOf.get(vertex) ?? cut.indices[from]!, cut.indices[from]);
      vertexOf.set(vertex, cut.indices[from]!);
      const uv = storedUv(is.getAttribute('TEXCOORD_1')!, vertex);
      assertNear(uv, cut.cornerUvs.subarray(2 * from, 2 * from + 2), `corner ${i}`);
    });

    const near = (a: ArrayLike<number>, b: readonly number[], most: number, what: string) =>
      b.forEach((x, k) => assert.ok(Math.abs(a[k]! - x) <= most, `${what}: ${Array.from(a)} is not ${b}`));
    for (const [vertex, v] of vertexOf) {
      const own = 3 * (v - vertices);
      const sources =
        v < vertices
          ? [[v, 1] as const]
          : [0, 1, 2].map((j) => [cut.sources[own + j]!, cut.weights[own + j]!] as const);
      const row = (list: ArrayLike<number>, size: number, u: number) =>
        Array.from({ length: size }, (_, k) => list[size * u + k]!);
      const mean = (list: ArrayLike<number>, size: number) =>
        row(list, size, 0).map((_, k) => sources.reduce((sum, [u, weight]) => sum + weight * list[size * u + k]!, 0));
      const unit = (list: ArrayLike<number>, size: number) =>
        new Vector3(...(mean(list, size).slice(0, 3) as [number, number, number])).normalize().toArray();
      const has = (semantic: string, size: number) => row(arrayOf(is, semantic), size, vertex);
      assert.equal(arrayOf(is, '_NCZ')[vertex], cut.zones[v]);
      near(has('POSITION', 3), mean(arrayOf(was, 'POSITION'), 3), 1e-6, 'POSITION');
      near(has('COLOR_0', 4), mean(arrayOf(was, 'COLOR_0'), 4), 0.51, 'COLOR_0');
      near(has('TEXCOORD_0', 2), mean(arrayOf(was, 'TEXCOORD_0'), 2), 1e-6, 'TEXCOORD_0');
      near(has('_HEAT', 1), mean(arrayOf(was, '_HEAT'), 1), 1e-6, '_HEAT');
      near(has('NORMAL', 3), unit(arrayOf(was, 'NORMAL'), 3), 1e-6, 'NORMAL');
      near(has('TANGENT', 4), [...unit(arrayOf(was, 'TANGENT'), 4), -1], 1e-6, 'TANGENT');
      was.listTargets().forEach((deltas, t) => {
        for (const semantic of deltas.listSemantics()) {
          const list = is.listTargets()[t]!.getAttribute(semantic)!.getArray()!;
          near(row(list, 3, vertex), mean(deltas.getAttribute(semantic)!.getArray()!, 3), 1e-6, `delta of ${semantic}`);
        }
      });
      if (kind === 'mirrored') continue;
      const pulls = (primitive: Primitive, u: number) => {
        const all = new Array<number>(12).fill(0);
        for (let k = 4 * u; k < 4 * u + 4; ++k)
          all[arrayOf(primitive, 'JOINTS_0')[k]!]! += arrayOf(primitive, 'WEIGHTS_0')[k]!;
        return all;
      };
      const blended = sources
        .map(([u, weight]) => pulls(was, u).map((pull) => weight * pull))
        .reduce((a, b) => a.map((pull, k) => pull + b[k]!));
      // The four that pull most.
      const least = [...blended].sort((a, b) => b - a)[3]!;
      const kept = blended.map((pull) => (pull >= least ? pull : 0));
      const sum = kept.reduce((a, b) => a + b);
      near(
        pulls(is, vertex),
        kept.map((pull) => pull / sum),
        1e-6,
        'skin',
      );
    }
  }
});

describe('document.transform(cagecast(…))', () => {
  test('a note says why nothing may be painted, and so does the logger', async () => {
    const document = await documentOf(glbOf(target));
    const heard: string[] = [];
    document.setLogger({ ...document.getLogger(), warn: (text) => void heard.push(text) });
    const away = { ...cage, positions: cage.positions.map((x) => x + 9) };
    let told: string | undefined;
    await document.transform(cagecast({ cage: away, onResult: (_, __, note) => void (told = note) }));
    assert.match(told!, /^nothing may be painted: the cage lies over next to none of the target; put /);
    assert.deepEqual(heard, [`cagecast: ${told}`]);
    const outer = await documentOf(glbOf(cage));
    const within = ball([0, 0, 0], () => 0.5, 60, 80);
    await outer.transform(cagecast({ cage: within, onResult: (_, __, note) => void (told = note) }));
    assert.match(told!, /^nothing may be painted: target and cage seem to be exchanged/);
    assert.throws(
      () => transfer(outer as never, target),
      /^.*transfer: cage is a document of glTF-Transform; give cageTemplate\(cage\)/,
    );
  });

  test('far from the origin', async () => {
    const translation = [1e7, -1e7, 3e6];
    const place = (mesh: Mesh) => {
      const maker = new GlbMaker();
      maker.node({ mesh: maker.mesh(mesh), translation });
      return documentOf(maker.finish());
    };
    const painted = async (document: Document, around: Document | Mesh) => {
      let count = 0;
      const onResult = ({ cosmeticTriangles }: TransferResult) =>
        void (count = cosmeticTriangles.filter(Boolean).length);
      await document.transform(cagecast({ cage: around, onResult }));
      return count;
    };
    const expected = await painted(await documentOf(glbOf(target)), cage);
    assert.equal(await painted(await place(target), await place(cage)), expected);
  });

  test('writes the UVs and zones of the package, by its options, and keeps the rest', async () => {
    for (const options of [{}, { threshold: 1, seams: 'vertex' }] as const) {
      const document = await documentOf(glbOf(target));
      const results: TransferResult[] = [];
      const onResult = (result: TransferResult) => void results.push(result);
      await document.transform(cagecast({ cage: await documentOf(cageGlb), ...options, onResult }));
      const expected = transfer(cage, { ...target, groups: undefined }, options);
      const [primitive, ...others] = primitives(document);
      assert.equal(others.length, 0);
      const added = assertTransferred(primitives(await documentOf(glbOf(target)))[0]!, primitive!, expected);
      assert.equal(added > 0, !('seams' in options));
      assert.deepEqual(results[0]!.zones, expected.zones);
    }
  });

  test('the option parts says what counts; what is left out gets nothing', async () => {
    const maker = new GlbMaker();
    for (const name of ['head', 'Visor', 'Head_Att']) maker.node({ name, mesh: maker.mesh(target) });
    const document = await documentOf(maker.finish());
    const left: string[] = [];
    await document.transform(
      cagecast({
        cage,
        texture,
        parts: { ignore: ['visor'] },
        onResult: (_, parts, __, leftOut) => void left.push(...[...parts, ...leftOut].map(({ name }) => name)),
      }),
    );
    assert.deepEqual(left, ['head', 'Visor', 'Head_Att']);
    assert.deepEqual(
      document
        .getRoot()
        .listMeshes()
        .map((mesh) => mesh.listPrimitives().map((one) => one.getAttribute('_NCZ') !== null)),
      [[true, false], [false], [false]],
    );
  });

  test('what a cage was made without stays bare', async () => {
    const maker = new GlbMaker();
    for (const name of ['skin', 'Hair']) maker.node({ name, mesh: maker.mesh(target) });
    const bytes = maker.finish();
    const around = await documentOf(cageGlb);
    around
      .getRoot()
      .listNodes()[0]!
      .setExtras({ bare: ['Hair'] });
    for (const by of [around, { ...cage, bare: ['Hair'] }]) {
      let fates: [number, boolean][] = [];
      const onResult = ({ segmentStats }: TransferResult) =>
        (fates = segmentStats.map(({ group, culledBy }) => [group, culledBy === 'lock']));
      await (await documentOf(bytes)).transform(cagecast({ cage: by, onResult }));
      assert.ok(fates.length >= 2 && fates.every(([group, isLocked]) => isLocked === (group === 1)));
    }
  });

  test('without a cage, the cages in the document are taken, each for the part of its name', async () => {
    const document = await documentOf(cagedFigure());
    const onResult = ({ uvs, zones }: TransferResult, parts: PartRange[]) =>
      parts.forEach(({ firstVertex, vertexCount }, p) => {
        const own = zones.subarray(firstVertex, firstVertex + vertexCount);
        assert.ok(own.includes(0));
        own.forEach((_, v) => assert.ok(isOfCage(uvs[2 * (firstVertex + v)]!, p)));
      });
    await document.transform(cagecast({ texture, onResult }));
    assert.deepEqual(await validate(await io.writeBinary(document)), []);
    const none = {
      message: /^cagecast: cage is undefined, not a document or a mesh, and no mesh of the target is named/,
    };
    await assert.rejects((await documentOf(glbOf(target))).transform(cagecast({ texture })), none);
  });

  test('a mesh that two nodes show, one of them mirrored, becomes one for each; what another scene shows stays', async () => {
    const document = await documentOf(shared());
    const [left, right] = document.getRoot().listNodes();
    const other = document.createNode('other').setMesh(left!.getMesh());
    document.getRoot().setDefaultScene(document.getRoot().listScenes()[0]!);
    document.createScene('other').addChild(other);
    let names: string[] = [];
    const onResult = (_: TransferResult, parts: { name: string }[]) => (names = parts.map(({ name }) => name));
    await document.transform(cagecast({ cage, texture, onResult: (result, parts) => void onResult(result, parts) }));
    assert.deepEqual(names, ['left', 'right', 'upper']);
    const all = [left!, right!].map((node) => node.getMesh()!.listPrimitives());
    assert.deepEqual(
      all.map(({ length }) => length),
      [2, 2],
    );
    assert.notDeepEqual(arrayOf(all[0]![0]!, 'TEXCOORD_1'), arrayOf(all[1]![0]!, 'TEXCOORD_1'));
    assert.deepEqual(
      other
        .getMesh()!
        .listPrimitives()
        .map((primitive) => primitive.listSemantics()),
      [['POSITION', 'TEXCOORD_0']],
    );
  });

  test('an overlay has the very positions and skin of its base, no colours, and the deltas that it needs', async () => {
    for (const [glb, semantics] of [
      [richFile(target, 'skinned'), ['JOINTS_0', 'NORMAL', 'POSITION', 'TEXCOORD_0', 'WEIGHTS_0']],
      [morphing(), ['POSITION', 'TEXCOORD_0']],
    ] as const) {
      const document = await documentOf(glb);
      await document.transform(cagecast({ cage, texture }));
      const [base, overlay] = primitives(document) as [Primitive, Primitive];
      assert.deepEqual(overlay.listSemantics().sort(), semantics);
      for (const semantic of semantics)
        assert.equal(
          overlay.getAttribute(semantic),
          base.getAttribute(semantic === 'TEXCOORD_0' ? 'TEXCOORD_1' : semantic),
        );
      overlay.listTargets().forEach((deltas, t) => {
        for (const semantic of ['POSITION', 'NORMAL']) {
          const own = base.listTargets()[t]!.getAttribute(semantic);
          if (own && semantics.includes(semantic as never)) assert.equal(deltas.getAttribute(semantic), own);
        }
        // One without anything in it is not allowed.
        if (t === 1 && !semantics.includes('NORMAL' as never))
          assert.ok(
            deltas
              .getAttribute('POSITION')!
              .getArray()!
              .every((delta: number) => delta === 0),
          );
      });
      assert.ok(overlay.getIndices()!.getCount() > 0);
    }
  });

  test('applied again, it takes the model alone, and its overlay and UVs take the place of those before', async () => {
    const document = await documentOf(glbOf(target));
    const step = cagecast({ cage, texture });
    const state = () => ({
      semantics: primitives(document).map((primitive) => primitive.listSemantics().sort()),
      zones: arrayOf(primitives(document)[0]!, '_NCZ'),
      vertices: primitives(document)[0]!.getAttribute('POSITION')!.getCount(),
      materials: document.getRoot().listMaterials().length,
      textures: document.getRoot().listTextures().length,
    });
    await document.transform(step);
    const before = state();
    await document.transform(step);
    assert.deepEqual(state(), before);
  });

  test('the overlays of an earlier transfer are known after their primitives were joined, in files, too', async () => {
    const document = await documentOf(glbOf(target));
    const whole = primitives(document)[0]!;
    const corners = whole.getIndices()!.getArray()!;
    const half = 3 * Math.floor(corners.length / 6);
    const other = whole.clone().setIndices(whole.getIndices()!.clone().setArray(corners.slice(half)));
    whole.setIndices(whole.getIndices()!.clone().setArray(corners.slice(0, half)));
    const node = document.createNode().setMesh(document.createMesh().addPrimitive(other));
    document.getRoot().getDefaultScene()!.addChild(node);
    const painted: number[] = [];
    const onResult = ({ cosmeticTriangles }: TransferResult) =>
      void painted.push(cosmeticTriangles.filter(Boolean).length);
    const step = cagecast({ cage, texture, onResult });
    const count = () => primitives(document).map((one) => one.getMaterial()?.getName() === 'Cagecast overlay');
    await document.transform(step);
    assert.deepEqual(count(), [false, true, false, true]);
    await document.transform(joinMeshes());
    assert.deepEqual(count(), [false, true]);
    const glb = await io.writeBinary(document);
    await document.transform(step);
    assert.deepEqual(count(), [false, true]);
    assert.equal(painted[1], painted[0]);
    const { data } = await written(glb, cageGlb, 'triangle');
    assert.deepEqual(primitives(await documentOf(data)).map(isOverlay), [false, true]);
  });

  test('unusable input is one error, and the document stays unchanged', async () => {
    const broken = target.positions.slice();
    broken[16] = Number.NaN;
    const bare = { positions: cage.positions, indices: cage.indices };
    const refused = () => {
      throw new CagecastError('badArgument', '', 'not for this model');
    };
    type Given = { [Name in keyof CagecastOptions]?: unknown } & { target?: Uint8Array };
    const cases: [Given, RegExp, string?][] = [
      [
        { target: glbOf({ ...target, positions: broken }) },
        /^cagecast: target: meshes\[0\]\.primitives\[0\]: POSITION of vertex 5 has NaN/,
      ],
      [{ cage: await documentOf(glbOf(bare)) }, /cage\.uvs is missing/, 'missingUvs'],
      [{ cage: new Document() }, /cage has no vertices/, 'emptyMesh'],
      [{ cage: 'cage.glb' }, /^cagecast: cage is "cage\.glb", not a document or a mesh/],
      [{ cage: null }, /^cagecast: cage is null/],
      [{ texture: new Uint8Array(100) }, /^cagecast: texture: is neither a PNG nor a JPEG image/],
      [{ texture: texture.subarray(0, 50) }, /^cagecast: texture: is truncated/],
      [{ texture: texture.buffer }, /^cagecast: texture is of type ArrayBuffer, not a Uint8Array$/],
      [{ parts: 'head' }, /^cagecast: options\.parts is "head", not an object$/, 'badOption'],
      [{ parts: { ignore: ['head'] } }, /^cagecast: target: parts\.ignore: nothing is named "head"; there are only/],
      [{ parts: { ignore: [2] } }, /^cagecast: target: parts\.ignore: there is no part 2, only 1/],
      [
        { parts: { ignore: ['*'] } },
        /^cagecast: target: all parts are left out: "only" \(ignored\); name what counts in parts\.keep/,
      ],
      [{ maskImages: { nevr: 1 } }, /^cagecast: maskImages is .*, not \{ never, always \}/],
      [{ threshold: 2 }, /threshold = 2/, 'badOption'],
      [
        { borders: 'straight' },
        /^cagecast: options\.borders = "straight" is unknown; there are: "triangle", "cut"/,
        'badOption',
      ],
      [{ borders: 'cut', threshold: 2 }, /threshold = 2/, 'badOption'],
      [{ onResult: refused }, /^not for this model$/],
    ];
    for (const [{ target: glb = glbOf(target), ...given }, message, code = 'badArgument'] of cases) {
      const document = await documentOf(glb);
      const { json } = await io.writeJSON(document);
      const step = cagecast({ cage, ...given } as CagecastOptions);
      await assert.rejects(document.transform(step), { name: 'CagecastError', code, message });
      assert.deepEqual((await io.writeJSON(document)).json, json);
    }
    const call = cagecast as unknown as () => void;
    assert.throws(call, { name: 'CagecastError', message: /^cagecast: the argument is undefined, not an object/ });
  });
});
