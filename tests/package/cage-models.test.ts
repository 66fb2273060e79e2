import assert from 'node:assert/strict';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { describe, test } from 'node:test';
import { Document, NodeIO } from '@gltf-transform/core';
import { init } from 'cagecast';
import { cageGlb, fitCage, loadTemplate } from 'cagecast/cages';
import * as gltf from 'cagecast/gltf';
import * as three from 'cagecast/three';
import type { Bone } from 'three';
import { GLTFLoader, type GLTF as Loaded } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { GlbMaker, validate } from '../support/gltf.js';
import { ball } from './scenes.js';

const near = (a: ArrayLike<number>, b: readonly number[], what: string) => {
  for (const [k, x] of b.entries()) assert.ok(Math.abs(a[k]! - x) < 1e-5, `${what}: ${[...Array.from(a)]}, not ${b}`);
};

/** A column-major matrix that scales and moves. */
const matrix = (scale: number, x: number, y: number, z: number) => [
  scale,
  0,
  0,
  0,
  0,
  scale,
  0,
  0,
  0,
  0,
  scale,
  0,
  x,
  y,
  z,
  1,
];

/**
 * A figure in centimetres under a node that makes metres of them, with hips at (0, 1, 0) and a head at (0, 1.5, 0.1) in the scene, and
 * a node between the two that is no joint.
 * @param extensions  Of the file.
 */
function figure(extensions: object = {}): Buffer {
  const maker = new GlbMaker();
  const body = ball([0, 120, 0], () => 30, 6, 12);
  const vertices = body.positions.length / 3;
  const mesh = maker.mesh(body);
  Object.assign(maker.json.meshes[mesh]!.primitives[0]!.attributes, {
    JOINTS_0: maker.accessor(new Uint8Array(4 * vertices), 'VEC4'),
    WEIGHTS_0: maker.accessor(
      Float32Array.from({ length: 4 * vertices }, (_, i) => Number(i % 4 === 0)),
      'VEC4',
    ),
  });
  const inverses = maker.accessor(Float32Array.from([...matrix(1, 0, -100, 0), ...matrix(1, 0, -150, -10)]), 'MAT4');
  const holder = maker.node({ name: 'body', mesh, skin: 0 }, false); // 0
  const head = maker.node({ name: 'J_Head', translation: [0, 30, 10] }, false); // 1
  const spine = maker.node({ name: 'spine', translation: [0, 20, 0], children: [head] }, false); // 2
  const hips = maker.node({ name: 'J_Hips', translation: [0, 100, 0], children: [spine] }, false); // 3
  maker.node({ name: 'Armature', scale: [0.01, 0.01, 0.01], children: [holder, hips] });
  maker.json.skins = [{ joints: [hips, head], inverseBindMatrices: inverses }];
  Object.assign(maker.json, { extensions, extensionsUsed: Object.keys(extensions) });
  return maker.finish();
}

const vrm1 = { VRMC_vrm: { humanoid: { humanBones: { hips: { node: 3 }, head: { node: 1 } } } } };
const vrm0 = {
  VRM: {
    humanoid: {
      humanBones: [
        { bone: 'hips', node: 3 },
        { bone: 'head', node: 1 },
      ],
    },
  },
};

const read = (bytes: Uint8Array) => new NodeIO().readBinary(new Uint8Array(bytes));
// What GLTFLoader expects of a page.
Object.assign(globalThis, { self: globalThis });
const load = (bytes: Buffer): Promise<Loaded> =>
  new GLTFLoader().parseAsync(new Uint8Array(bytes).buffer as ArrayBuffer, '');

describe('cageModel', () => {
  test('gives joints where the extracted mesh has them, in its own space and unit', async () => {
    for (const model of [gltf.cageModel(await read(figure())), three.cageModel(await load(figure()))]) {
      const heights = model.positions.filter((_, i) => i % 3 === 1);
      near([Math.min(...heights), Math.max(...heights)], [0.9, 1.5], 'heights');
      assert.deepEqual(
        model.joints!.map(({ name, parent }) => [name, parent]),
        [
          ['J_Hips', -1],
          ['J_Head', 0],
        ],
      );
      near(model.joints![0]!.position, [0, 1, 0], 'hips');
      near(model.joints![1]!.position, [0, 1.5, 0.1], 'head');
    }
  });

  test('gives joints of the bind pose, as the mesh is extracted, if a skeleton has moved', async () => {
    const loaded = await load(figure());
    const bone = loaded.scene.getObjectByName('J_Head') as Bone;
    const before = three.cageModel(loaded);
    bone.position.x += 50;
    const after = three.cageModel(loaded);
    assert.deepEqual(after.positions, before.positions);
    near(after.joints![1]!.position, [0, 1.5, 0.1], 'head');
  });

  test('names the joints of a VRM 0 or 1 by its bones', async () => {
    for (const extensions of [vrm1, vrm0]) {
      const bytes = figure(extensions);
      for (const model of [gltf.cageModel(await read(bytes), { extensions }), three.cageModel(await load(bytes))])
        assert.deepEqual(
          model.joints!.map(({ name }) => name),
          ['hips', 'head'],
        );
    }
    // Damaged tables are no reason to refuse a model.
    for (const extensions of [
      { VRM: 3 },
      { VRMC_vrm: { humanoid: { humanBones: { hips: null, head: { node: 99 } } } } },
    ])
      assert.equal(gltf.cageModel(await read(figure()), { extensions }).joints!.length, 2);
  });

  test('names parts by node, mesh and material', async () => {
    const maker = new GlbMaker();
    maker.json.materials = [{ name: 'skin' }, { name: 'EyeWhite' }];
    const mesh = maker.mesh(
      ball([0, 0, 0], () => 1, 4, 8),
      { material: 0 },
    );
    const eye = maker.mesh(
      ball([0, 0, 1], () => 0.2, 4, 8),
      { material: 1 },
    );
    maker.json.meshes[mesh]!.primitives.push(maker.json.meshes[eye]!.primitives[0]!);
    maker.json.meshes[mesh]!.name = 'Face.mesh';
    maker.node({ name: 'Face', mesh });
    const bytes = maker.finish();
    assert.deepEqual(gltf.cageModel(await read(bytes)).parts, [
      ['Face', 'Face.mesh', 'skin', 'Face/skin'],
      ['Face', 'Face.mesh', 'EyeWhite', 'Face/EyeWhite'],
    ]);
    const { parts } = three.cageModel(await load(bytes));
    assert.equal(parts!.length, 2);
    assert.ok(parts![0]!.includes('skin') && parts![1]!.includes('EyeWhite'));
  });
});

describe('cageTemplate', () => {
  const ballCage = ball([0, 0, 0], () => 1, 6, 12);
  const cage = {
    positions: ballCage.positions as Float32Array<ArrayBuffer>,
    uvs: ballCage.uvs as Float32Array<ArrayBuffer>,
    indices: ballCage.indices as Uint32Array<ArrayBuffer>,
    landmarks: { nose_tip: [0, 0, 1], chin: [0, -1, 0.5] },
    holes: { neck: [1, 2, 3] },
    kind: 'head',
  } as const;
  const same = (found: object) => {
    const { positions, uvs, indices, landmarks, holes, kind } = found as typeof cage;
    assert.deepEqual({ positions, uvs, indices, landmarks, holes, kind }, cage);
  };

  test('reads what cageGlb and addCage write', async () => {
    const bytes = cageGlb(cage);
    same(gltf.cageTemplate(await read(bytes)));
    same(three.cageTemplate(await load(Buffer.from(bytes))));
    const { document, node } = gltf.addCage(new Document(), cage);
    assert.equal(node.getName(), 'cage');
    same(gltf.cageTemplate(await read(await new NodeIO().writeBinary(document))));
    same(three.cageTemplate(three.cageGeometry(cage)));
    const folder = mkdtempSync(join(tmpdir(), 'cagecast-extras-'));
    try {
      writeFileSync(`${folder}/cage.glb`, bytes);
      assert.deepEqual(await validate(`${folder}/cage.glb`), []);
    } finally {
      rmSync(folder, { recursive: true });
    }
  });

  test('moves landmarks with their node', async () => {
    const { document, node } = gltf.addCage(new Document(), cage);
    node.setScale([2, 2, 2]).setTranslation([0, 5, 0]);
    near(gltf.cageTemplate(document).landmarks['chin']!, [0, 3, 1], 'chin');
    const loaded = await load(Buffer.from(await new NodeIO().writeBinary(document)));
    near(three.cageTemplate(loaded).landmarks['chin']!, [0, 3, 1], 'chin');
  });

  test('says what is wrong with extras', async () => {
    for (const [extras, says] of [
      [{ landmarks: [] }, '"cage".extras.landmarks is not an object'],
      [{ landmarks: { chin: [0, 1] } }, '"cage".extras.landmarks.chin is not 3 finite numbers [x, y, z]'],
      [{ holes: { neck: [1, 9999] } }, '"cage".extras.holes.neck is not a list of vertices (0..90)'],
    ] as const) {
      const { document, node } = gltf.addCage(new Document(), cage);
      node.setExtras(extras as unknown as Record<string, unknown>);
      assert.throws(() => gltf.cageTemplate(document), {
        name: 'CagecastError',
        code: 'badArgument',
        message: `cageTemplate: template: ${says}`,
      });
      const object = three.cageGeometry(cage);
      object.userData = { ...extras };
      assert.throws(() => three.cageTemplate(object), { message: `cageTemplate: ${says.replace('cage', 'geometry')}` });
    }
    const bare = gltf.addCage(new Document(), cage);
    bare.node.getMesh()!.listPrimitives()[0]!.setAttribute('TEXCOORD_0', null);
    assert.throws(() => gltf.cageTemplate(bare.document), { code: 'missingUvs', argument: 'template' });
    const bareObject = three.cageGeometry(cage).deleteAttribute('uv');
    assert.throws(() => three.cageTemplate(bareObject), { code: 'missingUvs', argument: 'template' });
  });
});

describe('with a loaded model', () => {
  const skin = ball([0, 0, 0], () => 1, 12, 24);
  const maker = new GlbMaker();
  maker.node({ name: 'skin', mesh: maker.mesh(skin) });
  maker.node({ name: 'Eye.L', mesh: maker.mesh(ball([0.3, -0.85, 0.2], () => 0.18, 8, 16)) });
  const bytes = maker.finish();
  const options = { kind: 'head', triangles: 300, voxels: 60 } as const;

  test('what is no document is said', async () => {
    assert.throws(() => gltf.cageModel({} as never), {
      code: 'badArgument',
      message: 'cageModel: model is of type Object, not a document of glTF-Transform',
    });
    assert.throws(() => gltf.addCage({} as never, {} as never), {
      code: 'badArgument',
      message: 'addCage: document is of type Object, not a document of glTF-Transform',
    });
    const document = new Document();
    assert.throws(() => gltf.addCage(document, { cage: ball([0, 0, 0], () => 1, 5, 10) } as never), {
      code: 'badArgument',
      message: 'addCage: cage.positions is undefined, not an array',
    });
    assert.equal(document.getRoot().listBuffers().length, 0, 'nothing is added');
    await assert.rejects(async () => gltf.cagecast({ cage: {} as never })({} as never), {
      code: 'badArgument',
      message: 'cagecast: target is of type Object, not a document of glTF-Transform',
    });
    await assert.rejects(gltf.fitCage(null as never, await read(bytes)), {
      code: 'badArgument',
      message: 'fitCage: template is null, not a mesh { positions, indices, … }',
    });
  });

  test('makeCage gives the same for glTF-Transform and three.js', async () => {
    const [ofDocument, loaded] = [await gltf.makeCage(await read(bytes), options), await load(bytes)];
    const ofScene = await three.makeCage(loaded.scene, options);
    assert.deepEqual(ofScene, ofDocument);
    await init();
    const applied = three.applyTransfer(loaded.scene, three.cageGeometry(ofScene));
    assert.ok(applied.result.segmentStats.some(({ culled }) => culled));
  });
});

test('a model of two figures is refused: no cage fits both', async () => {
  const model = gltf.cageModel(await new NodeIO().read('examples/samples/human/target.glb'));
  const count = model.positions.length / 3;
  const twice = {
    ...model,
    positions: Float32Array.from([...model.positions, ...model.positions.map((x, i) => (i % 3 === 0 ? x + 0.5 : x))]),
    indices: Uint32Array.from([...model.indices, ...model.indices.map((vertex) => vertex + count)]),
    groups: Uint32Array.from([...model.groups!, ...model.groups!]),
  };
  await assert.rejects(fitCage(await loadTemplate('human-head'), twice), {
    code: 'badModel',
    message: /^fitCage: model: the template does not fit it; if there are several figures in it, exclude all but one/,
  });
});
