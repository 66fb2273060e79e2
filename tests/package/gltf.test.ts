import assert from 'node:assert/strict';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, describe, test } from 'node:test';
import { Document, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { join as joinMeshes } from '@gltf-transform/functions';
import { CagecastError, init, type Mesh, type TransferResult, transfer } from 'cagecast';
import { type CagecastOptions, cagecast as cagecastTransform } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import { assertTransferred, cagecast, GlbMaker, glbOf, validate } from '../support/gltf.js';
import { temporaryFolder } from '../support/temporary.js';
import { ball, head, modelFolders } from './scenes.js';

const { at } = temporaryFolder('gltf');
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS);
const scene = head(2, 10);
const paint = PNG.sync.write(new PNG({ width: 4, height: 4 }));
const documentOf = (glb: Uint8Array): Promise<Document> => io.readBinary(glb);
const primitives = (document: Document): Primitive[] =>
  document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());
const arrayOf = (primitive: Primitive, semantic: string) => primitive.getAttribute(semantic)!.getArray()!;

before(async () => {
  await init();
  writeFileSync(at('paint.png'), paint);
});

describe('document.transform(cagecast(…))', () => {
  test('writes the UVs and zones of the package, and keeps the rest', async () => {
    const document = await documentOf(glbOf(scene.target));
    let seen: TransferResult | undefined;
    await document.transform(cagecastTransform({ cage: scene.cage, onResult: (result) => (seen = result) }));
    const expected = transfer(scene.cage, { ...scene.target, groups: undefined });
    const [primitive, ...others] = primitives(document);
    assert.equal(others.length, 0);
    const before = primitives(await documentOf(glbOf(scene.target)))[0]!;
    assert.ok(assertTransferred(before, primitive!, expected) > 0);
    assert.deepEqual(seen!.zones, expected.zones);
  });

  test('options are those of transfer', async () => {
    const document = await documentOf(glbOf(scene.target));
    await document.transform(
      cagecastTransform({ cage: await documentOf(glbOf(scene.cage)), threshold: 1, seams: 'vertex' }),
    );
    assert.deepEqual(
      [...arrayOf(primitives(document)[0]!, '_NCZ')],
      [...transfer(scene.cage, { ...scene.target, groups: undefined }, { threshold: 1 }).zones],
    );
  });

  for (const model of modelFolders()) {
    test(`${model}: the same as the command writes, and valid`, async () => {
      const [target, cage] = [join(model, 'target.glb'), join(model, 'cage.glb')];
      assert.equal(
        cagecast('transfer', target, '--cage', cage, '--texture', at('paint.png'), '-o', at('command.glb')).status,
        0,
      );
      const document = await io.read(target);
      await document.transform(cagecastTransform({ cage: await io.read(cage), texture: paint }));
      await io.write(at('function.glb'), document);
      assert.deepEqual(await validate(at('function.glb')), []);
      const [ours, theirs] = [
        primitives(await io.read(at('function.glb'))),
        primitives(await io.read(at('command.glb'))),
      ];
      assert.equal(ours.length, theirs.length);
      ours.forEach((primitive, p) => {
        assert.deepEqual(primitive.listSemantics().sort(), theirs[p]!.listSemantics().sort());
        for (const semantic of primitive.listSemantics())
          assert.deepEqual(arrayOf(primitive, semantic), arrayOf(theirs[p]!, semantic), semantic);
        assert.deepEqual([...primitive.getIndices()!.getArray()!], [...theirs[p]!.getIndices()!.getArray()!]);
        const [a, b] = [primitive.getMaterial(), theirs[p]!.getMaterial()];
        assert.deepEqual(
          [a?.getName(), a?.getAlphaMode(), a?.getRoughnessFactor(), a?.getDoubleSided()],
          [b?.getName(), b?.getAlphaMode(), b?.getRoughnessFactor(), b?.getDoubleSided()],
        );
      });
    });
  }

  test('a mesh that two nodes show, one of them mirrored, becomes one for each', async () => {
    const maker = new GlbMaker();
    const mesh = maker.mesh(ball([0, 0, 0], () => 0.2, 8, 12));
    maker.node({ mesh, name: 'left', translation: [-0.6, 0, 0] });
    maker.node({ mesh, name: 'right', translation: [0.6, 0, 0], scale: [-1, 1, 1] });
    const document = await documentOf(maker.finish());
    let names: string[] = [];
    await document.transform(
      cagecastTransform({
        cage: scene.cage,
        texture: paint,
        onResult: (_, parts) => (names = parts.map(({ name }) => name)),
      }),
    );
    assert.deepEqual(names, ['left', 'right']);
    const [left, right] = document
      .getRoot()
      .listNodes()
      .map((node) => node.getMesh()!);
    assert.notEqual(left, right);
    assert.deepEqual(
      [left, right].map((one) => one!.listPrimitives().length),
      [2, 2],
    );
    assert.notDeepEqual(
      arrayOf(left!.listPrimitives()[0]!, 'TEXCOORD_1'),
      arrayOf(right!.listPrimitives()[0]!, 'TEXCOORD_1'),
    );
    await io.write(at('twins.glb'), document);
    assert.deepEqual(await validate(at('twins.glb')), []);
  });

  test('a primitive that two meshes share becomes one for each, and one that another scene shows stays as it is', async () => {
    const ready = async (other: 'clone' | 'same') => {
      const document = await documentOf(glbOf(ball([0, 0, 0], () => 0.2, 8, 12)));
      const [left] = document.getRoot().listNodes();
      left!.setTranslation([-0.6, 0, 0]);
      const mesh = left!.getMesh()!;
      return {
        document,
        right: document
          .createNode('right')
          .setTranslation([0.6, 0, 0])
          .setMesh(other === 'clone' ? mesh.clone() : mesh),
      };
    };
    const uvsOf = (document: Document) =>
      document
        .getRoot()
        .listNodes()
        .map((node) => arrayOf(node.getMesh()!.listPrimitives()[0]!, 'TEXCOORD_1'));
    const answers = [];
    for (const isReadAgain of [false, true]) {
      const { document, right } = await ready('clone');
      document.getRoot().listScenes()[0]!.addChild(right);
      const written = isReadAgain ? await documentOf(await io.writeBinary(document)) : document;
      await written.transform(cagecastTransform({ cage: scene.cage, texture: paint }));
      answers.push(uvsOf(written));
    }
    assert.deepEqual(answers[0], answers[1]);

    const { document, right } = await ready('same');
    document.createScene('other').addChild(right);
    document.getRoot().setDefaultScene(document.getRoot().listScenes()[0]!);
    await document.transform(cagecastTransform({ cage: scene.cage, texture: paint }));
    assert.deepEqual(
      right
        .getMesh()!
        .listPrimitives()
        .map((primitive) => primitive.listSemantics()),
      [['POSITION', 'TEXCOORD_0']],
    );
    assert.equal(document.getRoot().listNodes()[0]!.getMesh()!.listPrimitives().length, 2);
  });

  test('an overlay has the morph deltas of its attributes, except for UVs', async () => {
    const document = await documentOf(glbOf(scene.target));
    const [primitive] = primitives(document);
    const count = scene.target.positions.length / 3;
    const buffer = document.getRoot().listBuffers()[0]!;
    const accessor = (type: 'VEC2' | 'VEC3' | 'VEC4', size: number) =>
      document
        .createAccessor()
        .setType(type)
        .setArray(new Float32Array(size * count).fill(0.25))
        .setBuffer(buffer);
    primitive!.setAttribute(
      'TANGENT',
      accessor('VEC4', 4).setArray(new Float32Array(4 * count).map((_, i) => Number(i % 4 === 0 || i % 4 === 3))),
    );
    primitive!.addTarget(
      document
        .createPrimitiveTarget()
        .setAttribute('POSITION', accessor('VEC3', 3))
        .setAttribute('TANGENT', accessor('VEC3', 3))
        .setAttribute('TEXCOORD_0', accessor('VEC2', 2)),
    );
    primitive!.addTarget(document.createPrimitiveTarget().setAttribute('TEXCOORD_0', accessor('VEC2', 2)));
    await io.write(at('morphs.glb'), document);
    writeFileSync(at('morph-cage.glb'), glbOf(scene.cage));
    assert.equal(
      cagecast(
        'transfer',
        at('morphs.glb'),
        '--cage',
        at('morph-cage.glb'),
        '--texture',
        at('paint.png'),
        '-o',
        at('morphs-command.glb'),
      ).status,
      0,
    );
    await document.transform(cagecastTransform({ cage: scene.cage, texture: paint }));
    await io.write(at('morphs-function.glb'), document);
    for (const name of ['morphs-command.glb', 'morphs-function.glb']) {
      assert.deepEqual(await validate(at(name)), [], name);
      const overlay = primitives(await io.read(at(name)))[1]!;
      assert.deepEqual(
        overlay.listTargets().map((target) => target.listSemantics()),
        [['POSITION'], ['POSITION']],
      );
      assert.ok(
        overlay
          .listTargets()[1]!
          .getAttribute('POSITION')!
          .getArray()!
          .every((delta: number) => delta === 0),
      );
    }
  });

  test('a skinned mesh is where its skeleton holds it, whatever the unit it is stored in', async () => {
    const maker = new GlbMaker();
    const mesh = maker.mesh({ ...scene.target, positions: scene.target.positions.map((x) => 128 * x) });
    const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
    const vertices = scene.target.positions.length / 3;
    attributes['JOINTS_0'] = maker.accessor(new Uint8Array(4 * vertices), 'VEC4');
    attributes['WEIGHTS_0'] = maker.accessor(
      new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
      'VEC4',
    );
    const inverse = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -256, 0, 0, 128].map((x) => x / 128);
    maker.json.skins = [{ joints: [1], inverseBindMatrices: maker.accessor(Float32Array.from(inverse), 'MAT4') }];
    maker.node({ mesh, skin: 0, translation: [9, 9, 9] });
    maker.node({ name: 'bone', translation: [2, 0, 0] });
    let uvs: Float32Array | undefined;
    const document = await documentOf(maker.finish());
    await document.transform(cagecastTransform({ cage: scene.cage, onResult: (result) => (uvs = result.uvs) }));
    assert.deepEqual(uvs, transfer(scene.cage, { ...scene.target, groups: undefined }).uvs);
  });

  test('a joint that is below itself, as in a damaged file, is taken for one at the origin', async () => {
    const maker = new GlbMaker();
    const mesh = maker.mesh(scene.target);
    const { attributes } = maker.json.meshes[mesh]!.primitives[0]!;
    const vertices = scene.target.positions.length / 3;
    attributes['JOINTS_0'] = maker.accessor(new Uint8Array(4 * vertices), 'VEC4');
    attributes['WEIGHTS_0'] = maker.accessor(new Float32Array(4 * vertices).fill(0.25), 'VEC4');
    maker.json.skins = [{ joints: [1] }];
    maker.node({ mesh, skin: 0 });
    maker.json.nodes.push({ children: [2] }, { children: [1], translation: [2, 0, 0] });
    const document = await documentOf(maker.finish());
    let uvs: Float32Array | undefined;
    await document.transform(cagecastTransform({ cage: scene.cage, onResult: (result) => (uvs = result.uvs) }));
    assert.deepEqual(uvs, transfer(scene.cage, { ...scene.target, groups: undefined }).uvs);
  });

  test('all meshes of a posed figure are taken in its bind pose, as the command takes them', async () => {
    /** Skin held by hips and head, and an eye held by a joint on the head. @param times  How much larger they are stored. */
    const figure = (isPosed: boolean, times: readonly [skin: number, eye: number]) => {
      const maker = new GlbMaker();
      const places = [0, 0.2, 0.5]; // along z, of the joints 0, 1 and 2
      maker.node({ name: 'hips', children: [1] });
      const turned = isPosed ? { rotation: [0, Math.sin(0.2), 0, Math.cos(0.2)] } : {};
      maker.node({ name: 'head', translation: [0, 0, 0.2], ...turned, children: [2] }, false);
      maker.node({ name: 'eye', translation: [0, 0, 0.3] }, false);
      const skinned = (mesh: Mesh, joints: number[], jointAt: (z: number) => number, scale: number) => {
        const vertices = mesh.positions.length / 3;
        const [held, weights] = [new Uint8Array(4 * vertices), new Float32Array(4 * vertices)];
        for (let v = 0; v < vertices; ++v) {
          held[4 * v] = jointAt(mesh.positions[3 * v + 2]!);
          weights[4 * v] = 1;
        }
        const inverses = joints.flatMap((joint) =>
          [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -scale * places[joint]!, scale].map((x) => x / scale),
        );
        const number = maker.mesh({ ...mesh, positions: mesh.positions.map((x) => scale * x) });
        Object.assign(maker.json.meshes[number]!.primitives[0]!.attributes, {
          JOINTS_0: maker.accessor(held, 'VEC4'),
          WEIGHTS_0: maker.accessor(weights, 'VEC4'),
        });
        maker.json.skins ??= [];
        const inverseBindMatrices = maker.accessor(Float32Array.from(inverses), 'MAT4');
        const skin = maker.json.skins.push({ joints, inverseBindMatrices }) - 1;
        maker.node({ mesh: number, skin, translation: [9, 9, 9] });
      };
      skinned(scene.target, [0, 1], (z) => (z > 0.2 ? 1 : 0), times[0]);
      // Tools that quantise give each mesh a copy of the whole skin, others only the joints that hold it.
      const ofEye = times[1] === 1 ? [2] : [0, 1, 2];
      const eye = ball([0.4, 0.1, 0.5], () => 0.2, 6, 9);
      skinned(eye, ofEye, () => ofEye.length - 1, times[1]);
      return maker.finish();
    };
    writeFileSync(at('cage.glb'), glbOf(scene.cage));
    const transferred = async (glb: Uint8Array) => {
      const document = await documentOf(glb);
      await document.transform(cagecastTransform({ cage: scene.cage }));
      writeFileSync(at('figure.glb'), glb);
      const run = cagecast('transfer', at('figure.glb'), '--cage', at('cage.glb'), '-o', at('figure-out.glb'));
      assert.equal(run.status, 0, run.stderr);
      const [ours, theirs] = [document, await io.read(at('figure-out.glb'))].map((each) =>
        primitives(each).map((primitive) =>
          ['_NCZ', 'TEXCOORD_1'].map((semantic) => [...arrayOf(primitive, semantic)]),
        ),
      );
      assert.deepEqual(ours, theirs, 'the function and the command');
      return ours;
    };
    for (const times of [[1, 1] as const, [64, 32] as const])
      assert.deepEqual(
        await transferred(figure(true, times)),
        await transferred(figure(false, times)),
        `stored ${times} times as large`,
      );
  });

  test('skins and morph targets go with the overlay', async () => {
    const maker = new GlbMaker();
    const mesh = maker.mesh(scene.target);
    const primitive = maker.json.meshes[mesh]!.primitives[0]!;
    const vertices = scene.target.positions.length / 3;
    primitive.attributes['JOINTS_0'] = maker.accessor(new Uint8Array(4 * vertices), 'VEC4');
    primitive.attributes['WEIGHTS_0'] = maker.accessor(
      new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
      'VEC4',
    );
    primitive.attributes['COLOR_0'] = maker.accessor(new Float32Array(3 * vertices).fill(1), 'VEC3');
    primitive.targets = [
      {
        POSITION: maker.accessor(
          scene.target.positions.map((x) => 0.1 * x),
          'VEC3',
        ),
      },
    ];
    maker.json.meshes[mesh]!.weights = [0.5];
    maker.json.skins = [{ joints: [1] }];
    maker.node({ mesh, skin: 0, translation: [9, 9, 9] }); // which a skin ignores
    maker.node({ name: 'bone' });
    const document = await documentOf(maker.finish());
    await document.transform(cagecastTransform({ cage: scene.cage, texture: paint }));
    const [base, overlay] = primitives(document) as [Primitive, Primitive];
    for (const semantic of ['JOINTS_0', 'WEIGHTS_0'])
      assert.equal(overlay.getAttribute(semantic), base.getAttribute(semantic));
    assert.equal(overlay.getAttribute('COLOR_0'), null);
    assert.deepEqual(overlay.listTargets(), base.listTargets());
    assert.ok(overlay.getIndices()!.getCount() > 0);
    await io.write(at('skinned.glb'), document);
    assert.deepEqual(await validate(at('skinned.glb')), []);
  });

  test('applied again, it takes the model alone, and its overlay and UVs take the place of those before', async () => {
    const document = await documentOf(glbOf(scene.target));
    const step = cagecastTransform({ cage: scene.cage, texture: paint });
    await document.transform(step);
    const first = primitives(document)[0]!;
    const [zones, vertices] = [first.getAttribute('_NCZ')!.getArray(), first.getAttribute('POSITION')!.getCount()];
    const sets = first.listSemantics().filter((semantic) => semantic.startsWith('TEXCOORD'));
    const lists = [document.getRoot().listMaterials().length, document.getRoot().listTextures().length];
    await document.transform(step);
    assert.deepEqual(
      primitives(document).map((primitive) => primitive.listSemantics().includes('_NCZ')),
      [true, false],
    );
    assert.deepEqual(
      primitives(document)[0]!
        .listSemantics()
        .filter((semantic) => semantic.startsWith('TEXCOORD')),
      sets,
    );
    assert.deepEqual([document.getRoot().listMaterials().length, document.getRoot().listTextures().length], lists);
    assert.deepEqual(
      [
        primitives(document)[0]!.getAttribute('_NCZ')!.getArray(),
        primitives(document)[0]!.getAttribute('POSITION')!.getCount(),
      ],
      [zones, vertices],
    );
  });

  test('the overlays of an earlier transfer are known after their primitives were joined', async () => {
    const document = await documentOf(glbOf(scene.target));
    const whole = primitives(document)[0]!;
    const corners = whole.getIndices()!.getArray()!;
    const half = 3 * Math.floor(corners.length / 6);
    const other = whole.clone().setIndices(whole.getIndices()!.clone().setArray(corners.slice(half)));
    whole.setIndices(whole.getIndices()!.clone().setArray(corners.slice(0, half)));
    const node = document.createNode().setMesh(document.createMesh().addPrimitive(other));
    document.getRoot().getDefaultScene()!.addChild(node);
    const painted: number[] = [];
    const onResult = ({ cosmeticTriangles }: TransferResult) => {
      painted.push(cosmeticTriangles.filter(Boolean).length);
    };
    const step = cagecastTransform({ cage: scene.cage, texture: paint, onResult });
    await document.transform(step);
    const overlays = () => primitives(document).filter((one) => one.getMaterial()?.getName() === 'Cagecast overlay');
    assert.equal(overlays().length, 2, 'an overlay for each half');
    await document.transform(joinMeshes());
    assert.deepEqual(
      [primitives(document).length, overlays().length],
      [2, 1],
      'the halves and the overlays are joined',
    );
    await io.write(at('joined.glb'), document);
    await document.transform(step);
    assert.deepEqual([primitives(document).length, overlays().length], [2, 1]);
    assert.equal(painted[1], painted[0]);
    writeFileSync(at('joined-cage.glb'), glbOf(scene.cage));
    const { stdout } = cagecast('transfer', at('joined.glb'), '--cage', at('joined-cage.glb'), '-o', at('again.glb'));
    assert.match(stdout, /; took away 1 overlay of an earlier transfer\n/);
  });

  test('unusable input is one error, and the document stays unchanged', async () => {
    const fails = async (
      make: () => Promise<Partial<CagecastOptions> & { target?: Uint8Array }>,
      code: string,
      message: RegExp,
    ) => {
      const { target = glbOf(scene.target), cage = scene.cage, ...more } = await make();
      const document = await documentOf(target);
      const before = await io.writeJSON(document);
      await assert.rejects(document.transform(cagecastTransform({ cage, ...more })), (error) => {
        assert.ok(error instanceof CagecastError);
        assert.equal(error.code, code);
        assert.match(error.message, message);
        return true;
      });
      assert.deepEqual((await io.writeJSON(document)).json, before.json);
    };
    const broken = scene.target.positions.slice();
    broken[16] = NaN;
    await fails(
      async () => ({ target: glbOf({ ...scene.target, positions: broken }) }),
      'badArgument',
      /^cagecast: target: meshes\[0\]\.primitives\[0\]: POSITION of vertex 5 has NaN/,
    );
    await fails(
      async () => ({ cage: await documentOf(glbOf({ positions: scene.cage.positions, indices: scene.cage.indices })) }),
      'missingUvs',
      /cage\.uvs is missing/,
    );
    await fails(async () => ({ cage: new Document() }), 'emptyMesh', /cage has no vertices/);
    await fails(
      async () => ({ texture: new Uint8Array(100) }),
      'badArgument',
      /^cagecast: texture: is neither a PNG nor a JPEG image/,
    );
    await fails(async () => ({ texture: paint.subarray(0, 50) }), 'badArgument', /^cagecast: texture: is truncated/);
    await fails(async () => ({ threshold: 2 }), 'badOption', /threshold = 2/);
    await fails(
      async () => ({ cage: 'cage.glb' as unknown as Mesh }),
      'badArgument',
      /^cagecast: cage is "cage\.glb", not a document or a mesh/,
    );
    await fails(async () => ({ cage: null as unknown as Mesh }), 'badArgument', /^cagecast: cage is null/);
    assert.throws(
      () => (cagecastTransform as unknown as () => void)(),
      (error) =>
        error instanceof CagecastError && /^cagecast: the argument is undefined, not an object/.test(error.message),
    );
    await fails(
      async () => ({ texture: paint.buffer as unknown as Uint8Array }),
      'badArgument',
      /^cagecast: texture is of type ArrayBuffer, not a Uint8Array$/,
    );
    const never = { width: 1, height: 1, data: new Uint8Array(4) };
    await fails(
      async () => ({ maskImages: { nevr: never } as object }),
      'badArgument',
      /^cagecast: maskImages is .*, not \{ never, always \}/,
    );
    const refused = () => {
      throw new CagecastError('badArgument', '', 'not for this model');
    };
    await fails(async () => ({ onResult: refused }), 'badArgument', /^not for this model$/);
  });

  test('real compressed files can be targets', {
    skip: process.env['CAGECAST_ASSETS'] === undefined && 'CAGECAST_ASSETS is not set',
  }, async () => {
    const path = join(process.env['CAGECAST_ASSETS']!, 'formats/cat_meshopt_quantized.glb');
    assert.ok(existsSync(path));
    const { MeshoptDecoder, MeshoptEncoder } = await import('meshoptimizer');
    await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
    const reader = new NodeIO()
      .registerExtensions(ALL_EXTENSIONS)
      .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'meshopt.encoder': MeshoptEncoder });
    const document = await reader.readBinary(new Uint8Array(readFileSync(path)));
    await document.transform(cagecastTransform({ cage: scene.cage }));
    assert.ok(primitives(document).every((primitive) => primitive.getAttribute('_NCZ') !== null));
  });
});
