import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { setFlagsFromString } from 'node:v8';
import { classify, init, inspect, type Mesh, project, type TransferResult, transfer, Zone } from 'cagecast';
import {
  type ApplyOptions,
  applyTransfer,
  applyTransferAsync,
  cageModel,
  deserialize,
  extract,
  inspectModel,
  type Loaded,
  type LoadedCage,
  prepareTransfer,
  serialize,
} from 'cagecast/three';
import { terminate } from 'cagecast/worker';
import {
  ArrowHelper,
  BackSide,
  BatchedMesh,
  Bone,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Float16BufferAttribute,
  Float32BufferAttribute,
  Group,
  InstancedBufferGeometry,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  type Matrix3,
  MeshNormalMaterial,
  MeshStandardMaterial,
  type Object3D,
  ShaderLib,
  Skeleton,
  SkinnedMesh,
  Texture,
  Mesh as ThreeMesh,
  Uint16BufferAttribute,
  Vector3,
  type WebGLProgramParametersWithUniforms,
  type WebGLRenderer,
} from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { gltfFiles } from '../support/gltf-files.js';
import { allocatedBy, frame, renderer } from '../support/no-renderer.js';
import { ball, cagedFigure, head, isOfCage, join3d, kCagedParts } from './scenes.js';

before(init);
Object.assign(globalThis, { self: globalThis }); // which GLTFLoader expects

const scene = head(3, 10);
const vertices = scene.target.positions.length / 3;
const ungrouped = { ...scene.target, groups: undefined };
const geometryOf = ({ positions, indices, uvs }: Mesh): BufferGeometry => {
  const geometry = new BufferGeometry()
    .setIndex(new BufferAttribute(Uint32Array.from(indices), 1))
    .setAttribute('position', new BufferAttribute(positions.slice(), 3));
  return uvs ? geometry.setAttribute('uv', new BufferAttribute(uvs.slice(), 2)) : geometry;
};
const meshOf = (mesh: Mesh): ThreeMesh<BufferGeometry, MeshStandardMaterial> =>
  new ThreeMesh(geometryOf(mesh), new MeshStandardMaterial({ roughness: 0.3 }));
const unpaintable = () => new ThreeMesh(geometryOf(scene.target), new MeshNormalMaterial());
const cage = () => meshOf(scene.cage);
const attribute = (geometry: BufferGeometry, name: string) => geometry.getAttribute(name).array as Float32Array;
const arraysOf = ({ geometry }: ThreeMesh): Record<string, object> => ({
  ...Object.fromEntries(Object.entries(geometry.attributes).map(([name, { array }]) => [name, array])),
  index: geometry.index!.array,
});
/** The verdicts at a threshold that nothing reaches by chance. */
const strict = () => classify(project(scene.cage, ungrouped), { threshold: 1 });
const isPatched = (material: MeshStandardMaterial) => Object.hasOwn(material, 'onBeforeCompile');
/** What a material gives three.js when it is compiled. */
const compiled = (material: MeshStandardMaterial) => {
  const shader = { uniforms: {} as Record<string, { value: unknown }>, vertexShader: '', fragmentShader: '' };
  material.onBeforeCompile(shader as never, undefined as never);
  return shader.uniforms;
};

describe('extract', () => {
  test('a geometry, a mesh and a scene give the arrays that transfer takes', () => {
    const { positions, indices, uvs } = scene.target;
    const single = { positions, indices, uvs, groups: new Uint32Array(vertices) };
    for (const object of [geometryOf(scene.target), meshOf(scene.target), new Group().add(meshOf(scene.target))])
      assert.deepEqual({ ...extract(object).mesh, names: undefined }, { ...single, names: undefined });
    const other = meshOf(scene.target);
    other.material.map = Object.assign(new Texture(), { channel: 2 });
    assert.equal(extract(other).mesh.uvs, undefined, 'it has no UVs of this channel');
  });

  test('material groups are groups', () => {
    const box = (materials: number) =>
      extract(
        new ThreeMesh(
          new BoxGeometry(),
          Array.from({ length: materials }, () => new MeshStandardMaterial()),
        ),
      );
    assert.deepEqual([...new Set(box(6).mesh.groups)], [0, 1, 2, 3, 4, 5]);
    const one = extract(new ThreeMesh(new BoxGeometry(), new MeshStandardMaterial()));
    assert.deepEqual([...new Set(one.mesh.groups)], [0]);
  });

  test('what three.js does not draw is left out, unless the option parts says otherwise', () => {
    const skin = meshOf(scene.target);
    const part = (change: (mesh: typeof skin) => void, around?: Object3D) => {
      const mesh = meshOf(scene.target);
      change(mesh);
      return around?.add(mesh) ?? mesh;
    };
    const root = new Group().add(
      skin,
      part((mesh) => void (mesh.visible = false)),
      part(() => {}, Object.assign(new Group(), { visible: false })),
      part(({ material }) => void (material.visible = false)),
      part(({ material }) => void Object.assign(material, { transparent: true, opacity: 0 })),
      part(({ material }) => void Object.assign(material, { alphaTest: 0.5, opacity: 0.4 })),
      part(({ geometry, material }) => {
        const clear = new Uint8Array(4 * geometry.attributes['position']!.count);
        geometry.setAttribute('color', new BufferAttribute(clear, 4, true));
        Object.assign(material, { transparent: true, vertexColors: true });
      }),
      part((mesh) => void Object.assign(mesh.scale.setScalar(1.01) && mesh.material, { side: BackSide })),
      part((mesh) => void (mesh.name = 'Head_OuterCage')),
      part(() => {}, new ArrowHelper()),
    );
    // Who gives a root means it.
    root.visible = false;
    const { mesh, leftOut } = extract(root);
    assert.deepEqual(mesh, extract(skin).mesh);
    const reasons = [...new Set(leftOut.map(({ why }) => why))];
    const counts = reasons.map((reason) => [reason, leftOut.filter(({ why }) => why === reason).length]);
    assert.deepEqual(counts, [
      ['hidden', 3],
      ['transparent', 3],
      ['outline', 1],
      ['name', 1],
    ]);
    const all = applyTransfer(root, { cage: cage(), parts: { keep: ['*'] } });
    assert.equal(all.parts.length, 9);
    const { parts, leftOut: others } = applyTransfer(root, {
      cage: cage(),
      parts: { ignore: [0], keep: ['head_outercage'] },
    });
    assert.deepEqual([parts.length, others[0]!.why, others[0]!.mesh === skin], [1, 'ignored', true]);
    assert.equal(
      extract(
        part((one) => void (one.name = 'Head_OuterCage')),
        'cage',
      ).parts.length,
      1,
    );
  });

  test('grounds and backdrops are left out', () => {
    const skin = meshOf(scene.target);
    const { positions } = extract(skin).mesh;
    const low = (k: number) => positions.reduce((least, x, i) => (i % 3 === k ? Math.min(least, x) : least), Infinity);
    const sheet = (x: number, y: number, z: number) =>
      new ThreeMesh(new BoxGeometry(x, y, z), new MeshStandardMaterial());
    const size = 100 * Math.max(...positions.map(Math.abs));
    const [ground, wall] = [sheet(size, 1e-3, size), sheet(size, size, 1e-3)];
    ground.position.y = low(1);
    wall.position.z = low(2) - 1;
    const root = new Group().add(skin, ground, wall);
    const { mesh, leftOut } = extract(root);
    assert.deepEqual(mesh, extract(skin).mesh);
    assert.deepEqual(
      leftOut.map(({ why }) => why),
      ['backdrop', 'backdrop'],
    );
  });

  test('accessories stay bare, unless all is such or they are kept', () => {
    const [skin, hat] = [meshOf(scene.target), meshOf(ball([0, 0.9, 0], () => 0.05, 8, 12))];
    hat.name = 'Wolf3D_Headwear';
    const painted = (target: Object3D, options = {}) => {
      const { result, parts } = applyTransfer(target, { cage: cage(), ...options });
      return parts.map(({ firstVertex }) => result.segmentStats[result.segments[firstVertex]!]!.culledBy);
    };
    const both = () => new Group().add(skin.clone(), hat.clone());
    assert.deepEqual(painted(both()).at(-1), 'lock');
    assert.notEqual(painted(both(), { parts: { keep: ['*headwear'] } }).at(-1), 'lock');
    assert.notEqual(painted(hat.clone())[0], 'lock');
    // What a cage was made without stays bare, too.
    const around = cage();
    around.userData['bare'] = [(skin.name = 'skin')];
    const { result } = applyTransfer(new Group().add(skin, meshOf(ball([0, 0.9, 0], () => 0.05, 8, 12))), {
      cage: around,
    });
    for (const { group, culledBy } of result.segmentStats) assert.equal(culledBy === 'lock', group === 0);
  });

  test('without a cage, the cages in a model are taken, each for the part of its name', async () => {
    const { scene: model } = await new GLTFLoader().parseAsync(Uint8Array.from(cagedFigure()).buffer, '');
    const { result, parts } = applyTransfer(model);
    assert.deepEqual(
      parts.map(({ name }) => name),
      kCagedParts,
    );
    for (const [p, { firstVertex, vertexCount }] of parts.entries())
      for (let v = firstVertex; v < firstVertex + vertexCount; ++v) assert.ok(isOfCage(result.uvs[2 * v]!, p));
    assert.ok(result.cosmeticTriangles.every((one) => one === 1));
    assert.equal(extract(model, 'cage').parts.length, 3);
    model.children[0]!.name = model.children[0]!.userData['name'] = 'Foot_Geo';
    assert.throws(() => applyTransfer(model), /target: "Foot_Geo" has no cage: none is named Foot_OuterCage/);
  });

  test('posed and placed figures are taken in their bind pose, wherever they stand', async () => {
    const load = async (name: string) => {
      const { bytes } = gltfFiles.find((file) => file.name === name)!;
      return (await new GLTFLoader().parseAsync(Uint8Array.from(bytes).buffer, '')).scene;
    };
    const places: Record<string, (of: Object3D) => unknown> = {
      'in another place': (of) => of.position.set(5, 0, 0),
      'turned and larger': (of) => of.position.set(1, 2, 3) && of.rotation.set(0, 2, 0) && of.scale.setScalar(2),
      'in a group': (of) => new Group().add(of).position.set(0, 3, 0),
    };
    for (const [where, place] of Object.entries(places)) {
      const [rest, posed] = await Promise.all(['skin-at-rest', 'skin-that-is-posed'].map(load));
      for (const one of [rest!, posed!]) place(one);
      const root = (of: Group) => of.parent ?? of;
      assert.deepEqual(extract(root(posed!)).mesh, extract(root(rest!)).mesh, where);
    }
    // So what was saved of a model is accepted while an animation plays.
    const [rest, posed] = await Promise.all(['skin-at-rest', 'skin-that-is-posed'].map(load));
    const around = meshOf(ball([0, 0, 0], () => 1.5, 12, 18));
    const saved = deserialize(serialize(applyTransfer(rest!, { cage: around })));
    assert.equal(applyTransfer(posed!, { saved }).parts.length, 2);
  });

  test('a figure that was bound where it stands, or has its bones inside, is taken there', () => {
    const { positions } = scene.target;
    const skinned = () => {
      const geometry = geometryOf(scene.target);
      const [slots, weights] = [new Uint16Array(4 * vertices), new Float32Array(4 * vertices)];
      for (let v = 0; v < vertices; ++v) [slots[4 * v], weights[4 * v]] = [v % 2, 1];
      geometry.setAttribute('skinIndex', new BufferAttribute(slots, 4));
      geometry.setAttribute('skinWeight', new BufferAttribute(weights, 4));
      const [hips, neck] = [new Bone(), new Bone()];
      return { mesh: new SkinnedMesh(geometry, new MeshStandardMaterial()), hips: hips.add(neck), neck };
    };
    const moved = positions.map((value, i) => (i % 3 === 0 ? value + 5 : value));
    const inside = skinned();
    inside.mesh.add(inside.hips);
    inside.mesh.bind(new Skeleton([inside.hips, inside.neck]));
    inside.mesh.position.x = 5;
    inside.neck.rotation.x = 0.5;
    assert.deepEqual(extract(new Group().add(inside.mesh)).mesh.positions, moved);
    for (const bindMode of ['attached', 'detached'] as const) {
      const beside = skinned();
      const group = new Group().add(beside.mesh, beside.hips);
      group.position.x = bindMode === 'attached' ? 5 : 0;
      group.updateMatrixWorld(true);
      beside.mesh.bindMode = bindMode;
      beside.mesh.bind(new Skeleton([beside.hips, beside.neck]));
      beside.neck.rotation.x = 0.5;
      // Detached, the mesh alone says where it is.
      if (bindMode === 'detached') beside.mesh.position.x = 5;
      assert.deepEqual(extract(group).mesh.positions, moved, bindMode);
    }
  });
});

test('arguments that are none, and models that cannot be read, are errors that name them', () => {
  const target = meshOf(scene.target);
  const result = transfer(scene.cage, ungrouped);
  const flat = new BufferGeometry().setAttribute('position', new Float32BufferAttribute([0, 0, 1, 0, 0, 1], 2));
  const few = geometryOf(scene.target).setAttribute('heat', new BufferAttribute(new Float32Array(5), 1));
  const instanced = new InstancedBufferGeometry().copy(geometryOf(scene.target) as InstancedBufferGeometry);
  few.name = `long ${'name '.repeat(20)}`;
  const apply = applyTransfer as (...args: unknown[]) => ReturnType<typeof applyTransfer>;
  const applied = applyTransfer(meshOf(scene.target), { cage: cage(), texture: new Texture() });
  const whole = /make each instance a mesh of its own/;
  const cases: [() => unknown, RegExp, string?][] = [
    [
      () => apply({ scene: {} }),
      /^cagecast\/three: target is of type Object, not a loaded glTF, a scene, a mesh or a geo/,
    ],
    [() => apply(scene.target, { cage: cage() }), /target is of type Object, not a loaded glTF/],
    [
      () => apply(target, { cage: 'cage.glb' }),
      /: cage is "cage\.glb", not a loaded glTF, .* or a cage of cagecast\/cages$/,
    ],
    [() => apply(target), /^applyTransfer: options\.cage is undefined, and no mesh of target is named as/, 'badOption'],
    [
      () => apply(target, { cage: cage(), result: {} }),
      /^prepareParts: options\.result\.uvs is undefined, not a Float32Array$/,
    ],
    [
      () => apply(target, { cage: cage(), result: { ...result, uvs: 1 } }),
      /options\.result\.uvs is 1, not a Float32Array/,
    ],
    [() => apply(new Group(), { cage: cage() }), /has no vertices/, 'emptyMesh'],
    [() => extract(flat), /target: "geometry" has positions of 2 numbers, not 3/],
    [() => extract(few), /target: "long name [^"]*…" has 5 heat for \d+ vertices/],
    [
      () => extract(new Group().add(Object.assign(meshOf(scene.target), { visible: false, name: 'head' }))),
      /^cagecast\/three: target: all parts are left out: "head" \(hidden\); name what counts in parts.keep$/,
    ],
    [() => apply(target, { cage: cage(), parts: 'head' }), /options\.parts is "head", not an object/, 'badOption'],
    [() => extract(new Group().add(new BatchedMesh(2, 99, 99, target.material))), whole],
    [() => extract(new ThreeMesh(instanced, target.material)), whole],
    [() => applied.setOpacity(2), /^setOpacity: opacity is 2, not a number from 0 to 1/],
    [() => applied.setTexture('paint.png' as never), /^setTexture: texture is "paint\.png", not a Texture/],
    [() => applied.paint(undefined as never), /^paint: material is undefined, not a Material/],
    [
      () => applied.setClassification({ ...strict(), segmentStats: undefined } as never),
      /classification\.segmentStats is not an/,
    ],
    [() => applied.setClassification(null as never), /classification\.zones is not an array/],
    [() => serialize({} as never), /^serialize: applied is not what applyTransfer returned/],
  ];
  const order =
    /^applyTransfer: options is a model; give the cage as options\.cage: applyTransfer\(target, \{ cage \}\)$/;
  for (const given of [cage(), cage().geometry, { scene: cage() }, scene.cage])
    cases.push([() => apply(target, given), order, 'badOption']);
  for (const given of [target, { scene: target }])
    cases.push([
      () => transfer(given as never, scene.target),
      /^transfer: cage is a model of three\.js; give extract\(cage, 'cage'\)\.mesh/,
    ]);
  for (const [call, message, code = 'badArgument'] of cases)
    assert.throws(call, { name: 'CagecastError', code, message });
});

test('wrong options are one error of both calls, which names the function, the option and its value', async () => {
  const [target, around] = [meshOf(scene.target), cage()];
  const withCage = (options: ApplyOptions) => (Object(options) === options ? { cage: around, ...options } : options);
  const calls = {
    applyTransfer: async (options: ApplyOptions) => applyTransfer(target, withCage(options)),
    applyTransferAsync: (options: ApplyOptions) => applyTransferAsync(target, withCage(options)),
  };
  const ofBoth: [unknown, string][] = [
    [null, 'options is null, not an object'],
    [7, 'options is 7, not an object'],
    [{ texture: 'paint.png' }, 'options.texture is "paint.png", not a Texture'],
    [{ texture: 'a'.repeat(99) }, `options.texture is "${'a'.repeat(40)}…", not a Texture`],
    [{ material: {} }, 'options.material is of type Object, not a Material'],
    [{ channel: 7 }, 'options.channel is 7, not 1, 2 or 3'],
    [{ opacity: 2 }, 'options.opacity is 2, not a number from 0 to 1'],
    [{ feather: Number.NaN }, 'options.feather is NaN, not a number from 0 to 1'],
    [{ saved: {} }, 'options.saved is of type Object, not what prepareTransfer or deserialize returned'],
    [{ borders: 'round' }, 'options.borders = "round" is unknown; there are: "triangle", "cut"'],
  ];
  const ofAsync: [unknown, string][] = [
    [{ signal: 'soon' }, 'options.signal is "soon", not an AbortSignal'],
    [{ signal: false }, 'options.signal is false, not an AbortSignal'],
    [{ onProgress: false }, 'options.onProgress is false, not a function'],
  ];
  for (const call of Object.values(calls))
    await assert.rejects(call({ textur: new Texture() } as ApplyOptions), {
      code: 'badOption',
      message:
        /^(applyTransfer|applyTransferAsync): options\.textur is not an option; \1 takes: cage, cageUvs, texture, .*threshold/,
    });
  for (const [fn, call] of Object.entries(calls))
    for (const [options, reason] of fn === 'applyTransfer' ? ofBoth : [...ofBoth, ...ofAsync]) {
      const error = { name: 'CagecastError', code: 'badOption', argument: 'options', fn, message: `${fn}: ${reason}` };
      await assert.rejects(call(options as ApplyOptions), error, `${fn}: ${reason}`);
    }
});

/** Asserts that a geometry shows the UV and zone of a result at each corner, and is what it was, with copies of vertices at the end. */
function assertSplit(geometry: BufferGeometry, before: BufferGeometry, result: TransferResult): void {
  const source = new Map<number, number>();
  for (const [i, vertex] of [...geometry.index!.array].entries()) {
    const old = before.index!.getX(i);
    assert.equal(source.get(vertex) ?? old, old);
    source.set(vertex, old);
    if (vertex < vertices) assert.equal(vertex, old);
    const uv = geometry.getAttribute('uv1');
    const expected = [...result.cornerUvs.subarray(2 * i, 2 * i + 2)];
    assert.deepEqual([uv.getX(vertex) + 0, uv.getY(vertex) + 0], [expected[0]! + 0, expected[1]! + 0]);
    assert.equal(geometry.getAttribute('_ncz').getX(vertex), result.zones[old]);
  }
  const listOf = ({ attributes, morphAttributes }: BufferGeometry) => [
    ...Object.entries(attributes),
    ...Object.entries(morphAttributes).flatMap(([name, list]) => list!.map((one) => [`morph ${name}`, one] as const)),
  ];
  const now = new Map(listOf(geometry));
  for (const [name, old] of listOf(before))
    for (const [vertex, from] of source)
      for (let k = 0; k < old.itemSize; ++k)
        assert.equal(now.get(name)!.getComponent(vertex, k), old.getComponent(from, k), name);
}

describe('applyTransfer', () => {
  test('a note says why nothing may be painted, and what helps', () => {
    assert.equal(applyTransfer(meshOf(ungrouped), { cage: cage() }).note, undefined);
    const target = Object.assign(meshOf(ungrouped), { name: 'head' });
    const { note } = applyTransfer(target, { cage: cage(), parts: { exclude: ['head'] } });
    assert.equal(note, 'nothing may be painted: "head" is excluded by choice; lift the lock');
    const exchanged = 'nothing may be painted: target and cage seem to be exchanged; exchange them';
    assert.equal(applyTransfer(cage(), { cage: meshOf(ball([0, 0, 0], () => 0.5, 40, 60)) }).note, exchanged);
  });

  test('models and cages are taken as they are loaded, and cages as arrays', () => {
    const painted = (target: Loaded, around: LoadedCage) =>
      applyTransfer(target, { cage: around }).result.cosmeticTriangles.filter(Boolean).length;
    const expected = painted(meshOf(ungrouped), cage());
    const loaded = (mesh: ThreeMesh) => ({ scene: new Group().add(mesh) });
    for (const around of [loaded(cage()), cage().geometry, scene.cage])
      assert.equal(painted(loaded(meshOf(ungrouped)), around), expected);
  });

  test('far from the origin', () => {
    const painted = (x: number) => {
      const [object, around] = [meshOf(ungrouped), cage()];
      for (const one of [object, around]) one.position.set(x, -x, 0);
      return applyTransfer(object, { cage: around }).result.cosmeticTriangles.filter(Boolean).length;
    };
    assert.equal(painted(1e7), painted(0));
  });

  test('splits vertices with all their attributes at the seams of the texture', () => {
    const target = meshOf(scene.target);
    const { geometry } = target;
    const numbers = (size: number, below: number) => Array.from({ length: size * vertices }, (_, i) => i % below);
    const interleaved = new InterleavedBuffer(Float32Array.from(numbers(5, 1e9)), 5);
    geometry.setAttribute('normal', new InterleavedBufferAttribute(interleaved, 3, 1));
    geometry.setAttribute('skinIndex', new Uint16BufferAttribute(numbers(4, 999), 4));
    geometry.setAttribute('color', new BufferAttribute(Uint8Array.from(numbers(3, 255)), 3, true));
    geometry.setAttribute('half', new Float16BufferAttribute(Uint16Array.from(numbers(1, 999)), 1));
    geometry.morphAttributes['position'] = [new Float32BufferAttribute(numbers(3, 77), 3)];
    const before = geometry.clone();
    let disposed = 0;
    geometry.addEventListener('dispose', () => ++disposed);
    const { result, splitVertices } = applyTransfer(target, { cage: cage() });
    assert.ok(splitVertices > 0 && disposed === 1);
    assert.equal(target.geometry, geometry);
    assert.equal(geometry.getAttribute('position').count, vertices + splitVertices);
    assertSplit(geometry, before, result);
  });

  test('whole numbers of attributes that the format does not know are not averaged where borders are cut', () => {
    const target = meshOf(scene.target);
    const ids = Float32Array.from({ length: vertices }, (_, v) => 1000 * v);
    for (const name of ['_feature_id_0', 'batchId'])
      target.geometry.setAttribute(name, new BufferAttribute(ids.slice(), 1));
    target.geometry.setAttribute('heat', new BufferAttribute(Float32Array.from(ids, Math.sin), 1));
    assert.ok(applyTransfer(target, { cage: cage(), borders: 'cut' }).cutTriangles > 0);
    const isOld = (name: string, old: Float32Array) => {
      const known = new Set(old);
      return attribute(target.geometry, name).every((x) => known.has(x));
    };
    assert.deepEqual(
      ['_feature_id_0', 'batchId', 'heat'].map((name) => isOld(name, name === 'heat' ? ids.map(Math.sin) : ids)),
      [true, true, false],
    );
  });

  test('a mirrored mesh is split as it is seen', () => {
    const target = meshOf({
      ...scene.target,
      positions: scene.target.positions.map((x, i) => (i % 3 === 0 ? -x : x)),
      indices: scene.target.indices.slice().reverse(),
    });
    target.scale.x = -1;
    const before = target.geometry.clone();
    const { result, splitVertices } = applyTransfer(target, { cage: cage() });
    assert.ok(splitVertices > 0);
    // In the arrays of the result the second and third corners of mirrored triangles have changed places.
    const swapped = [0, 1, 4, 5, 2, 3];
    const cornerUvs = result.cornerUvs.map((_, i, uvs) => uvs[i - (i % 6) + swapped[i % 6]!]!);
    assertSplit(target.geometry, before, { ...result, cornerUvs });
  });

  test("seams: 'vertex' adds uv1 and _ncz, as transfer answers", () => {
    const target = meshOf(scene.target);
    const { result, overlays, splitVertices } = applyTransfer(target, { cage: cage(), seams: 'vertex' });
    const expected = transfer(scene.cage, ungrouped);
    assert.deepEqual(result.zones, expected.zones);
    assert.deepEqual(attribute(target.geometry, 'uv1'), expected.uvs);
    assert.deepEqual([...attribute(target.geometry, '_ncz')], [...expected.zones]);
    assert.deepEqual(attribute(target.geometry, 'uv'), scene.target.uvs);
    assert.deepEqual([splitVertices, overlays.length, target.children.length], [0, 0, 0]);
  });

  test('the parts of a scene keep their own zones', () => {
    const [skin, tongue] = [ball([0, 0, 0], () => 1, 12, 20), ball([0, 0, 0], () => 0.3, 6, 9)];
    const around = ball([0, 0, 0], () => 1.1, 10, 16);
    const target = new Group().add(meshOf(skin), meshOf(tongue));
    const { result } = applyTransfer(target, { cage: meshOf(around) });
    assert.deepEqual(result.zones, transfer(around, join3d(skin, tongue)).zones);
    const [outer, inner] = target.children as [ThreeMesh, ThreeMesh];
    assert.ok(attribute(outer.geometry, '_ncz').every((zone) => zone === Zone.Cosmetic));
    assert.ok(attribute(inner.geometry, '_ncz').every((zone) => zone === Zone.Occluded));
  });

  test('with a texture the material shows it on the cosmetic triangles; the texture stays as it is', () => {
    const target = meshOf(scene.target);
    const { geometry, material } = target;
    const texture = new Texture();
    const before = { ...texture };
    const { version } = material;
    const { result, overlays, setClassification, setTexture, dispose, splitVertices } = applyTransfer(target, {
      cage: cage(),
      texture,
    });
    assert.deepEqual([overlays.length, target.children.length, target.material], [0, 0, material]);
    assert.deepEqual({ ...texture }, before);
    assert.ok(material.version > version && splitVertices > 0);

    /** Asserts that a triangle is painted if and only if it is cosmetic: by the rule of the shader. */
    const assertPainted = (cosmetic: Uint8Array) => {
      const [paint, uv] = [geometry.getAttribute('_cagecast_paint'), geometry.getAttribute('uv1')];
      cosmetic.forEach((one, t) => {
        const corners = [...geometry.index!.array.subarray(3 * t, 3 * t + 3)];
        assert.equal(corners.every((v) => paint.getZ(v) === 0) ? 1 : 0, one, `triangle ${t}`);
        for (const v of corners)
          assert.deepEqual([paint.getX(v), paint.getY(v), paint.getW(v)], [uv.getX(v), uv.getY(v), 2]);
      });
    };
    assertPainted(result.cosmeticTriangles);
    const decided = strict();
    setClassification(decided);
    assertPainted(decided.cosmeticTriangles);
    assert.deepEqual([...attribute(geometry, '_ncz')].slice(0, vertices), [...decided.zones]);
    // What no segment passes has no paint, and its material is as it was.
    const { zones, cosmeticTriangles } = decided;
    setClassification({
      ...decided,
      zones: zones.slice().fill(Zone.Culled),
      cosmeticTriangles: cosmeticTriangles.slice().fill(0),
    });
    assert.ok(!isPatched(material));
    setClassification(result);
    assert.ok(isPatched(material));
    setTexture(undefined);
    assert.ok(isPatched(material), 'it stays ready for a texture, whose shader is compiled already');
    dispose();
    assert.ok(!isPatched(material) && !Object.hasOwn(material, 'customProgramCacheKey'));
    assert.ok(!geometry.hasAttribute('_cagecast_paint') && !geometry.hasAttribute('uv1'));
  });

  for (const shows of ['texture', 'material'] as const) {
    test(`triangles in another order and UVs changed by others leave later updates right (${shows})`, () => {
      const options = shows === 'texture' ? { texture: new Texture() } : { material: new MeshStandardMaterial() };
      const [plain, sorted] = [meshOf(scene.target), meshOf(scene.target)];
      const applied = [plain, sorted].map((target) => applyTransfer(target, { cage: cage(), ...options }));
      const bytes = serialize(applied[1]!);
      // As three-mesh-bvh does, in place.
      const { array } = sorted.geometry.index!;
      const triangles = Array.from({ length: array.length / 3 }, (_, t) => [...array.subarray(3 * t, 3 * t + 3)]);
      array.set(triangles.reverse().flat());
      attribute(sorted.geometry, 'uv1').fill(0.5);
      assert.deepEqual(serialize(applied[1]!), bytes);
      for (const one of applied) one.setClassification(strict());
      for (const one of applied) one.setClassification(one.result);
      const shown = ({ geometry }: ThreeMesh, { overlays }: (typeof applied)[0]) =>
        shows === 'texture' ? attribute(geometry, '_cagecast_paint') : overlays[0]!.geometry.index!.array;
      assert.deepEqual(shown(sorted, applied[1]!), shown(plain, applied[0]!));
    });
  }

  test('a material of which nothing may be painted stays as it is, also beside one that is painted', () => {
    const { cosmeticTriangles } = applyTransfer(meshOf(ungrouped), { cage: cage() }).result;
    const order = [...cosmeticTriangles.keys()].sort((a, b) => cosmeticTriangles[b]! - cosmeticTriangles[a]!);
    const indices = Uint32Array.from(order.flatMap((t) => [...ungrouped.indices.subarray(3 * t, 3 * t + 3)]));
    const painted = cosmeticTriangles.filter(Boolean).length;
    const geometry = geometryOf({ ...ungrouped, indices });
    geometry.addGroup(0, 3 * painted, 0);
    geometry.addGroup(3 * painted, Number.POSITIVE_INFINITY, 1);
    const materials = [new MeshStandardMaterial(), new MeshStandardMaterial()];
    const applied = applyTransfer(new ThreeMesh(geometry, materials), { cage: cage(), texture: new Texture() });
    assert.deepEqual(materials.map(isPatched), [true, false]);
    const all = { ...applied.result, cosmeticTriangles: new Uint8Array(order.length).fill(1) };
    applied.setClassification({ ...all, zones: new Uint8Array(vertices) });
    assert.deepEqual(materials.map(isPatched), [true, true]);
  });

  test('painted materials keep one hidden class, so that a renderer reads them as fast as others', () => {
    setFlagsFromString('--allow-natives-syntax');
    const isAlike = new Function('a', 'b', 'return %HaveSameMap(a, b)') as (a: object, b: object) => boolean;
    const model = new Group().add(...[0, 1, 2, 3].map(() => meshOf(scene.target)));
    applyTransfer(model, { cage: cage(), texture: new Texture() });
    // The first ones show V8 what the fields hold.
    const [, , third, fourth] = model.children.map((mesh) => (mesh as ReturnType<typeof meshOf>).material);
    assert.equal(third!.customProgramCacheKey(), fourth!.customProgramCacheKey());
    assert.equal(isAlike(third!, fourth!), true);
  });

  test('of two copies of the module on a page, the one that paints last is seen, by programs of its own', async () => {
    const copy = (await import(`${import.meta.resolve('#three')}?copy`)) as typeof import('#three');
    const [target, other] = [meshOf(scene.target), meshOf(scene.target)];
    const [first, second] = [new Texture(), new Texture()];
    const before = applyTransfer(target, { cage: cage(), texture: first });
    const firstKey = target.material.customProgramCacheKey();
    copy.applyTransfer(target, { cage: cage(), texture: second });
    const { vertexShader, fragmentShader, uniforms } = ShaderLib.standard;
    const shader = { vertexShader, fragmentShader, uniforms: { ...uniforms } } as WebGLProgramParametersWithUniforms;
    target.material.onBeforeCompile(shader, undefined as never);
    assert.equal(shader.uniforms['cagecastMap']!.value, second);
    copy.applyTransfer(other, { cage: cage(), texture: second });
    assert.notEqual(other.material.customProgramCacheKey(), firstKey);
    before.dispose();
  });

  test('a texture on a node material is an error, and nothing is changed', () => {
    const target = meshOf(scene.target);
    Object.assign(target.material, { isNodeMaterial: true, name: 'skin' });
    const before = Object.keys(target.geometry.attributes);
    const apply = () => applyTransfer(target, { cage: cage(), texture: new Texture() });
    assert.throws(apply, { code: 'badOption', message: /has a node material, .* give options\.material/ });
    assert.deepEqual(Object.keys(target.geometry.attributes), before);
    assert.equal(applyTransfer(target, { cage: cage(), material: new MeshStandardMaterial() }).overlays.length, 1);
  });

  test('a soft border: distances from the border of the paint, 0 on it, growing by no more than the edges', () => {
    const target = meshOf(ball([0, 0, 0], () => 1, 24, 36));
    const around = ball([0, 0, 0], () => 1.1, 24, 36);
    const indices = around.indices.filter((_, i) => around.positions[3 * around.indices[i - (i % 3)]! + 1]! < 0.5);
    const options = { texture: new Texture(), feather: 0.1 };
    const { result } = applyTransfer(target, { cage: meshOf({ ...around, indices }), ...options });
    const { geometry } = target;
    const paint = geometry.getAttribute('_cagecast_paint');
    const corners = geometry.index!.array;
    const bare = new Set([...corners].filter((_, i) => result.cosmeticTriangles[Math.floor(i / 3)] === 0));
    const place = (v: number) => new Vector3().fromBufferAttribute(geometry.getAttribute('position'), v);
    geometry.computeBoundingBox();
    const size = geometry.boundingBox!.getSize(new Vector3()).length();
    let [atBorder, inside] = [0, 0];
    for (let i = 0; i < corners.length; i += 3) {
      if (result.cosmeticTriangles[i / 3] === 0) continue;
      const [a, b] = [corners[i]!, corners[i + 1]!];
      const [d, e] = [paint.getW(a), paint.getW(b)];
      if (bare.has(a)) {
        ++atBorder;
        assert.equal(d, 2);
      }
      if (d > 2.05) ++inside;
      if (Math.min(d, e) < 2.1) assert.ok(Math.abs(d - e) * size <= place(a).distanceTo(place(b)) + 1e-5);
    }
    assert.ok(atBorder > 10 && inside > 10, `${atBorder}, ${inside}`);
  });
});

describe('overlays', () => {
  test('a material lies on the cosmetic triangles of each mesh, and shares its vertices', () => {
    const target = meshOf(scene.target);
    const material = new MeshStandardMaterial();
    const { result, overlays, setClassification, dispose, channel } = applyTransfer(target, {
      cage: cage(),
      material,
      channel: 2,
    });
    const [overlay] = overlays as [ThreeMesh<BufferGeometry, MeshStandardMaterial>];
    assert.deepEqual([overlay.parent, channel, overlay.material], [target, 2, material]);
    for (const name of ['position', 'uv2'])
      assert.equal(overlay.geometry.getAttribute(name), target.geometry.getAttribute(name));
    const isPainted = (_: number, i: number) => result.cosmeticTriangles[Math.floor(i / 3)] === 1;
    assert.deepEqual([...overlay.geometry.index!.array], [...target.geometry.index!.array].filter(isPainted));
    // Another classification frees its own triangles, but neither those of its base nor those a copy of the model shows.
    const { geometry } = overlay;
    const copy = target.clone().children[0] as ThreeMesh;
    let freed: unknown[] = ['nothing yet'];
    geometry.addEventListener('dispose', () => (freed = Object.values(geometry.attributes)));
    const decided = strict();
    setClassification(decided);
    assert.equal(overlay.geometry.index!.count, 3 * decided.cosmeticTriangles.filter((one) => one === 1).length);
    assert.deepEqual([freed, copy.geometry], [[], geometry]);
    assert.equal(geometry.getAttribute('position'), target.geometry.getAttribute('position'));
    dispose();
    assert.equal(target.children.length, 0);
  });

  test('another texture reaches the one on a material that cannot be painted', () => {
    const target = unpaintable();
    const [red, green] = [new Texture(), new Texture()];
    const { overlays, setTexture } = applyTransfer(target, { cage: cage(), texture: red });
    const [overlay] = overlays as [ThreeMesh<BufferGeometry, MeshStandardMaterial>];
    const uniforms = compiled(overlay.material);
    for (const texture of [red, green, undefined, red, null, red]) {
      setTexture(texture);
      assert.equal(overlay.parent, texture ? target : null);
      if (texture) assert.equal(uniforms['cagecastMap']!.value, texture);
    }
  });

  test('a texture or a material that is null is none', () => {
    const [target, other] = [meshOf(scene.target), unpaintable()];
    const plain = applyTransfer(meshOf(scene.target), { cage: cage() });
    const bare = applyTransfer(target, { cage: cage(), texture: null, material: null });
    assert.equal(bare.splitVertices, plain.splitVertices);
    assert.ok(!isPatched(target.material));
    applyTransfer(other, { cage: cage(), texture: new Texture() });
    applyTransfer(other, { cage: cage(), texture: null });
    assert.deepEqual(other.children, []);
  });

  test('a later transfer takes away those whose paint it replaces, and takes none of them for a part', () => {
    const target = unpaintable();
    const materials = [1, 2, 3].map(() => new MeshStandardMaterial());
    const show = (options: ApplyOptions) => applyTransfer(target, { cage: cage(), ...options });
    show({ texture: new Texture() });
    const painted = show({ texture: new Texture() });
    assert.deepEqual([target.children, painted.parts.length], [painted.overlays, 1]);
    show({});
    assert.deepEqual(target.children, []);
    show({ material: materials[0]! });
    const other = show({ material: materials[1]! });
    assert.deepEqual(target.children, other.overlays);
    // Both can be seen if each has UVs of its own.
    const beside = show({ material: materials[2]!, channel: 2 });
    assert.deepEqual(target.children, [...other.overlays, ...beside.overlays]);
    painted.dispose();
    const { overlays } = show({ texture: new Texture() });
    assert.deepEqual(target.children, overlays);
    other.setClassification(other.result);
    assert.deepEqual(target.children, overlays, 'what is replaced does not come back');
  });

  test('morph targets and skins go with them', () => {
    const geometry = geometryOf(scene.target);
    geometry.morphAttributes['position'] = [
      new Float32BufferAttribute(
        scene.target.positions.map((x) => 0.5 * x),
        3,
      ),
    ];
    geometry.morphTargetsRelative = true;
    const weights = new Float32Array(4 * vertices).map((_, i) => Number(i % 4 === 0));
    geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(4 * vertices), 4));
    geometry.setAttribute('skinWeight', new BufferAttribute(weights, 4));
    const bone = new Bone();
    const target = new SkinnedMesh(geometry, new MeshStandardMaterial());
    const root = new Group().add(bone, target);
    target.bind(new Skeleton([bone]));
    const [overlay] = applyTransfer(root, { cage: cage(), material: new MeshStandardMaterial() }).overlays as [
      SkinnedMesh,
    ];
    assert.equal(overlay.skeleton, target.skeleton);
    const vertex = overlay.geometry.index!.getX(0);
    const rest = new Vector3().fromArray(scene.target.positions, 3 * vertex);
    target.morphTargetInfluences![0] = 1;
    bone.position.x = 1;
    root.updateMatrixWorld(true);
    const expected = rest.multiplyScalar(1.5).add(new Vector3(1, 0, 0));
    for (const mesh of [target, overlay])
      assert.ok(mesh.getVertexPosition(vertex, new Vector3()).distanceTo(expected) < 1e-6);
  });
});

describe('geometries', () => {
  test('keep a UV set of their own, also when they are transferred again', () => {
    const target = meshOf(scene.target);
    const own = new BufferAttribute(new Float32Array(2 * vertices), 2);
    target.geometry.setAttribute('uv1', own);
    for (let i = 0; i < 2; ++i) {
      const texture = new Texture();
      const applied = applyTransfer(target, { cage: cage(), texture, seams: 'vertex' });
      applied.dispose();
      assert.deepEqual([applied.channel, texture.channel], [2, 0]);
      assert.equal(target.geometry.getAttribute('uv1'), own);
      assert.equal(target.geometry.hasAttribute('uv3'), false);
    }
    const other = meshOf(scene.target);
    for (const name of ['uv1', 'uv2', 'uv3']) other.geometry.setAttribute(name, own);
    assert.throws(() => applyTransfer(other, { cage: cage() }), /has uv1, uv2 and uv3 of its own/);
    applyTransfer(other, { cage: cage(), channel: 3, seams: 'vertex' });
  });

  test('of two meshes are copied for the second', () => {
    const geometry = geometryOf(ball([0, 0, 0], () => 0.2, 6, 9));
    const meshes = [-0.6, 0.6].map((x) => {
      const mesh = new ThreeMesh(geometry, new MeshStandardMaterial());
      mesh.position.x = x;
      return mesh;
    });
    applyTransfer(new Group().add(...meshes), { cage: cage(), texture: new Texture() });
    const [first, second] = meshes.map((mesh) => mesh.geometry);
    assert.deepEqual([first === geometry, second === geometry], [true, false]);
    assert.notDeepEqual(attribute(first!, 'uv1'), attribute(second!, 'uv1'));
  });

  test('leave what a mesh elsewhere shows as it is, also where both share a geometry', () => {
    const first = meshOf(scene.target);
    const second = first.clone();
    second.position.x = 0.2;
    applyTransfer(first, { cage: cage(), texture: new Texture() });
    const shown = structuredClone(arraysOf(first));
    applyTransfer(second, { cage: cage(), texture: new Texture() });
    assert.deepEqual(arraysOf(first), shown);
    assert.notDeepEqual(attribute(second.geometry, 'uv1'), attribute(first.geometry, 'uv1'));
  });

  test('are what they were, to begin with and in the end, however many transfers there are', async () => {
    for (const borders of ['triangle', 'cut'] as const) {
      const target = meshOf(scene.target);
      target.geometry.morphAttributes.position = [new Float32BufferAttribute(scene.target.positions, 3)];
      const own = { ...target.geometry.attributes };
      const { index, morphAttributes } = target.geometry;
      const morphs = { ...morphAttributes };
      const extracted = extract(target).mesh;
      const show = () => applyTransfer(target, { cage: cage(), borders, texture: new Texture() });
      const all = [show()];
      const first = structuredClone(arraysOf(target));
      const saved = deserialize(serialize(all[0]!));
      for (let i = 0; i < 7; ++i) all.push(show());
      assert.deepEqual(arraysOf(target), first);
      assert.deepEqual(extract(target).mesh, extracted);
      assert.deepEqual((await cageModel(target)).positions, extracted.positions);
      show();
      assert.deepEqual(arraysOf(target), first, 'and after it was read');
      applyTransfer(target, { saved, texture: new Texture() }).dispose();
      assert.deepEqual([target.geometry.attributes, target.geometry.index], [own, index]);
      assert.deepEqual(target.geometry.morphAttributes, morphs);
      for (const one of all) one.dispose();
      assert.deepEqual(target.geometry.attributes, own);
    }
  });

  test('keep what others have added or changed since', () => {
    const target = meshOf(scene.target);
    const { geometry } = target;
    applyTransfer(target, { cage: cage(), borders: 'cut' });
    geometry.computeVertexNormals();
    const normals = attribute(geometry, 'normal').slice(0, 3 * vertices);
    const positions = geometry.getAttribute('position');
    for (let v = 0; v < positions.count; ++v) positions.setX(v, positions.getX(v) + 0.001);
    positions.needsUpdate = true;
    const moved = attribute(geometry, 'position').slice(0, 3 * vertices);
    const applied = applyTransfer(target, { cage: cage(), borders: 'cut' });
    assert.deepEqual(extract(target).mesh.positions, moved);
    applied.dispose();
    assert.deepEqual([attribute(geometry, 'position'), attribute(geometry, 'normal')], [moved, normals]);
    assert.deepEqual(Object.keys(geometry.attributes).sort(), ['normal', 'position', 'uv']);
  });

  test('have one channel on top of another, and lose both together where one is asked for no more', () => {
    const target = meshOf(scene.target);
    const first = applyTransfer(target, { cage: cage(), texture: new Texture(), borders: 'cut' });
    const count = () => target.geometry.getAttribute('position').count;
    const alone = count();
    for (let i = 0; i < 3; ++i) applyTransfer(target, { cage: cage(), channel: 2, borders: 'cut' });
    const both = count();
    const second = applyTransfer(target, { cage: cage(), channel: 2, borders: 'cut' });
    assert.equal(count(), both);
    assert.ok(isPatched(target.material));
    assert.equal(target.geometry.getAttribute('_cagecast_paint').count, both, 'the first is still shown');
    first.dispose();
    assert.equal(count(), both, 'the second is made of the first');
    second.dispose();
    assert.equal(count(), vertices);
    assert.ok(alone > vertices && both >= alone);
  });

  test('take a result from elsewhere as it is, but not one of what they were', () => {
    const target = meshOf(scene.target);
    const result = transfer(extract(cage(), 'cage').mesh, extract(target).mesh);
    const applied = applyTransfer(target, { cage: cage(), result });
    assert.equal(applied.result, result);
    assert.ok(applied.splitVertices > 0);
    const again = applyTransfer(target, { cage: cage(), result });
    assert.equal(again.splitVertices, applied.splitVertices);
    target.geometry = target.geometry.clone();
    assert.throws(() => applyTransfer(target, { cage: cage(), result }), {
      message: /uvs has \d+ entries, the target needs/,
    });
  });
});

describe('inspectModel', () => {
  after(terminate);

  test('says of loaded models what it says of their arrays, with the names of parts and the landmarks of the cage', async () => {
    const target = new Group().add(meshOf(scene.target));
    target.children[0]!.name = 'skin';
    const around = cage();
    const arrays = [extract(around, 'cage').mesh, extract(target).mesh] as const;
    const found = await inspectModel(target, { cage: around, threshold: 0.6 });
    assert.deepEqual(found, inspect(...arrays, { threshold: 0.6 }));
    assert.ok(found.segments.some(({ part }) => part === 'skin'));
    applyTransfer(target, { cage: around });
    assert.deepEqual(await inspectModel(target, { cage: around, threshold: 0.6 }), found, 'also once it is painted');
    const { positions } = extract(target).mesh;
    const top = positions.reduce((most, y, i) => (i % 3 === 1 && y > positions[3 * most + 1]! ? (i - 1) / 3 : most), 0);
    const [x, y, z] = positions.subarray(3 * top, 3 * top + 3);
    const eyes = { eye_centre_left: [x! + 0.1, y!, z!], eye_centre_right: [x! - 0.1, y!, z!] } as const;
    Object.assign(around.userData, { landmarks: eyes });
    const strict = await inspectModel(target, { cage: around, threshold: 1 });
    assert.deepEqual(strict, inspect(...arrays, { threshold: 1, landmarks: eyes }));
  });

  test('takes the cages in a file, and names what is wrong', async () => {
    const { scene: model } = await new GLTFLoader().parseAsync(Uint8Array.from(cagedFigure()).buffer, '');
    assert.notEqual((await inspectModel(model)).verdict, 'unfit');
    await assert.rejects(inspectModel(meshOf(scene.target)), /^CagecastError: inspectModel: options.cage is undefined/);
    await assert.rejects(
      inspectModel(meshOf(scene.target), { cage: cage(), tint: 1 } as never),
      /options.tint is not an option/,
    );
    const late = inspectModel(meshOf(scene.target), { cage: cage(), signal: AbortSignal.abort() });
    await assert.rejects(late, /abort/);
  });
});

describe('saved transfers', () => {
  const texture = new Texture();

  for (const borders of ['triangle', 'cut'] as const) {
    test(`give the same geometry and the same result, without a cage (borders: ${borders})`, () => {
      const [first, second] = [meshOf(scene.target), meshOf(scene.target)];
      const applied = applyTransfer(first, { cage: cage(), texture, borders });
      const again = applyTransfer(second, { texture, saved: deserialize(serialize(applied)) });
      assert.deepEqual(arraysOf(second), arraysOf(first));
      assert.deepEqual(again.result, applied.result);
      assert.deepEqual([again.splitVertices, again.cutTriangles], [applied.splitVertices, applied.cutTriangles]);
      for (const one of [applied, again]) one.setClassification(strict());
      assert.deepEqual(arraysOf(second), arraysOf(first));
      assert.deepEqual(serialize(again), serialize(applied));
    });
  }

  test('are of a model wherever it is by then, and of what prepareTransfer made, too', async () => {
    for (const borders of ['triangle', 'cut'] as const) {
      const [first, second] = [meshOf(scene.target), meshOf(scene.target)];
      const before = arraysOf(second);
      const stages: unknown[] = [];
      const onProgress = (_: number, stage: string) => stages.push(stage);
      const saved = await prepareTransfer(second, { cage: cage(), borders, onProgress });
      assert.deepEqual(arraysOf(second), before, 'it is not changed');
      assert.deepEqual(stages, ['transfer', 'done']);
      const applied = applyTransfer(first, { cage: cage(), texture, borders });
      new Group().add(second).scale.set(2, 3, 4);
      second.position.x = 1;
      const { timings: _, ...result } = applyTransfer(second, { saved, texture }).result;
      assert.deepEqual({ ...result, timings: applied.result.timings }, applied.result);
      assert.deepEqual(arraysOf(second), arraysOf(first));
      assert.equal(saved.key, deserialize(serialize(applied)).key);
    }
    await assert.rejects(prepareTransfer(meshOf(scene.target), { cage: cage(), signal: AbortSignal.abort() }), /abort/);
    terminate();
  });

  test('have a key that depends on target, cage and options', () => {
    const keyOf = (target: Mesh, around: Mesh, options = {}) =>
      deserialize(serialize(applyTransfer(meshOf(target), { cage: meshOf(around), ...options }))).key;
    const scaled = (mesh: Mesh, by: number) => ({ ...mesh, positions: mesh.positions.map((x) => by * x) });
    const { target, cage } = scene;
    const keys = [
      keyOf(target, cage),
      keyOf(target, scaled(cage, 1.001)),
      keyOf(scaled(target, 0.999), cage),
      keyOf(target, cage, { threshold: 0.3 }),
      keyOf(target, cage, { borders: 'cut' }),
    ];
    assert.equal(new Set(keys).size, keys.length);
    assert.equal(keyOf(target, cage), keys[0]);
    assert.equal(keyOf(target, cage, { texture, opacity: 0.5 }), keys[0]);
  });

  test('of another target, damaged ones and others are errors; bytes in a Buffer are read, and copied', () => {
    const bytes = serialize(applyTransfer(meshOf(scene.target), { cage: cage() }));
    const large = Buffer.concat([Buffer.alloc(5), bytes]);
    const saved = deserialize(large.subarray(5));
    large.fill(255);
    assert.deepEqual(saved, deserialize(bytes));
    const other = meshOf({ ...scene.target, positions: scene.target.positions.map((x) => 0.999 * x) });
    assert.throws(
      () => applyTransfer(other, { saved }),
      /is of another target, or .*as it was, and give the same parts$/,
    );
    const changed = (at: number, to: (byte: number) => number) => bytes.map((byte, i) => (i === at ? to(byte) : byte));
    for (const [wrong, message] of [
      [new Uint8Array(3), /is nothing that serialize wrote \(3 bytes\)/],
      [bytes.subarray(0, bytes.length - 1), /is damaged or not whole/],
      [changed(5000, (byte) => byte ^ 1), /is damaged or not whole/],
      // Of the length of its text.
      [changed(8, (byte) => byte ^ 1), /is damaged or not whole/],
      [changed(8, (byte) => byte ^ 128), /is damaged or not whole/],
      [changed(4, () => 9), /has version 9 of the format; this one reads version 2/],
      ['bytes' as never, /bytes is "bytes", not a Uint8Array/],
    ] as const)
      assert.throws(() => deserialize(wrong), { name: 'CagecastError', code: 'badArgument', message });
  });
});

describe('applyTransferAsync', () => {
  const texture = new Texture();

  test('gives what applyTransfer gives, and its errors', async () => {
    const [first, second] = [meshOf(scene.target), meshOf(scene.target)];
    const options = { texture, borders: 'cut' } as const;
    const applied = applyTransfer(first, { cage: cage(), ...options });
    const shares: [number, string][] = [];
    const onProgress = (...share: [number, string]) => void shares.push(share);
    const later = await applyTransferAsync(second, { cage: cage(), ...options, onProgress });
    assert.deepEqual(arraysOf(second), arraysOf(first));
    assert.deepEqual(later.result.zones, applied.result.zones);
    assert.deepEqual(
      shares.map(([, stage]) => stage),
      ['transfer', 'geometry', 'done'],
    );
    assert.ok(shares.every(([share], i) => share > (shares[i - 1]?.[0] ?? 0)) && shares.at(-1)![0] === 1);
    await assert.rejects(applyTransferAsync(new Group(), { cage: cage() }), { code: 'emptyMesh' });
    terminate();
  });

  test('works in tasks, one for each attribute if that takes long; cancelled, it leaves the model as it was', async () => {
    const many = () => {
      const mesh = meshOf(scene.target);
      const morphs = Array.from({ length: 50 }, () => new Float32BufferAttribute(scene.target.positions, 3));
      mesh.geometry.morphAttributes['position'] = morphs;
      return mesh;
    };
    const { now } = performance;
    let [clock, tasks] = [0, 0];
    const Channel = MessageChannel;
    performance.now = () => (clock += 5); // milliseconds: a task, which has 8, ends after each step
    globalThis.MessageChannel = class extends Channel {
      constructor() {
        super();
        ++tasks;
      }
    } as typeof MessageChannel;
    try {
      await applyTransferAsync(many(), { cage: cage(), texture });
      assert.ok(tasks > 50, `${tasks} tasks`);
      const left = many();
      const before = arraysOf(left);
      const controller = new AbortController();
      const onProgress = (_: number, stage: string) => stage === 'geometry' && controller.abort(new Error('enough'));
      await assert.rejects(
        applyTransferAsync(left, { cage: cage(), texture, signal: controller.signal, onProgress }),
        /enough/,
      );
      assert.deepEqual(arraysOf(left), before);
      await assert.rejects(
        applyTransferAsync(left, { cage: cage(), signal: AbortSignal.abort(new Error('no')) }),
        /^Error: no$/,
      );
    } finally {
      performance.now = now;
      globalThis.MessageChannel = Channel;
      terminate();
    }
  });

  const changes: Record<string, [change: (target: ThreeMesh) => unknown, expected: object]> = {
    'replaces the geometry': [
      (target) => (target.geometry = geometryOf(scene.target)),
      { code: 'badArgument', message: /was changed meanwhile/ },
    ],
    'splits vertices by a transfer': [
      (target) => applyTransfer(target, { cage: cage(), texture }),
      { code: 'superseded' },
    ],
    'cuts triangles by a transfer': [
      (target) => applyTransfer(target, { cage: cage(), borders: 'cut' }),
      { code: 'superseded' },
    ],
  };
  for (const [name, [change, expected]] of Object.entries(changes)) {
    test(`is an error if somebody ${name} meanwhile, whose work stays as it is`, async () => {
      const [target, other] = [meshOf(scene.target), meshOf(scene.target)];
      const onProgress = (_: number, stage: string) => stage === 'geometry' && change(target);
      const work = applyTransferAsync(target, { cage: cage(), texture, onProgress });
      await assert.rejects(work, expected);
      change(other);
      assert.deepEqual(arraysOf(target), arraysOf(other));
      terminate();
    });
  }

  for (const borders of ['triangle', 'cut'] as const) {
    test(`paints models that share a geometry at the same time (borders: ${borders})`, async () => {
      const options = { texture, borders };
      const [first, alone] = [meshOf(scene.target), meshOf(scene.target)];
      const second = first.clone();
      await Promise.all([first, second].map((target) => applyTransferAsync(target, { cage: cage(), ...options })));
      applyTransfer(alone, { cage: cage(), ...options });
      assert.notEqual(first.geometry, second.geometry);
      for (const one of [first, second]) assert.deepEqual(arraysOf(one), arraysOf(alone));
      terminate();
    });
  }

  test('the last of several calls for a model counts', async () => {
    const target = meshOf(scene.target);
    const calls = [0.2, 0.4, 0.6].map((threshold) =>
      applyTransferAsync(target, { cage: cage(), threshold, borders: 'cut' }),
    );
    const all = await Promise.all(calls);
    const alone = meshOf(scene.target);
    applyTransfer(alone, { cage: cage(), threshold: 0.6, borders: 'cut' });
    assert.deepEqual(arraysOf(target), arraysOf(alone));
    for (const one of all.reverse()) one.dispose();
    assert.deepEqual(arraysOf(target), arraysOf(meshOf(scene.target)));
    terminate();
  });

  test('is an error if attributes are added while others are copied', async () => {
    const target = meshOf(scene.target);
    const { geometry } = target;
    const heat = new BufferAttribute(new Float32Array(vertices), 1);
    const values = heat.array;
    let isFirst = true;
    Object.defineProperty(heat, 'array', {
      get() {
        if (isFirst) {
          isFirst = false;
          geometry.setAttribute('late', new BufferAttribute(new Float32Array(vertices), 1));
        }
        return values;
      },
    });
    geometry.setAttribute('heat', heat);
    const work = applyTransferAsync(target, { cage: cage(), texture });
    await assert.rejects(work, { code: 'badArgument', message: /was changed meanwhile/ });
    assert.ok(geometry.hasAttribute('late') && !geometry.hasAttribute('uv1'));
    for (const one of Object.values(geometry.attributes)) assert.equal(one.count, heat.count);
    terminate();
  });
});

for (const matrixAutoUpdate of [true, false]) {
  test(`a frame allocates nothing for paint, and shows its texture's transform (matrixAutoUpdate: ${matrixAutoUpdate})`, () => {
    const target = meshOf(scene.target);
    const texture = Object.assign(new Texture(), { matrixAutoUpdate });
    texture.offset.set(0.25, 0.5);
    applyTransfer(target, { cage: cage(), texture });
    const { material } = target;
    const { cagecastMatrix } = compiled(material) as Record<string, { value: Matrix3 }>;
    const draw = () => {
      ++frame.frame;
      (material.onBeforeRender as (renderer: WebGLRenderer) => void)(renderer);
    };
    const bytes = allocatedBy(draw);
    assert.ok(bytes < 16, `${bytes} bytes`);
    const x = () => cagecastMatrix!.value.elements[6];
    assert.equal(x(), matrixAutoUpdate ? 0.25 : 0);
    // The matrix is the caller's, and may change at any time.
    texture.matrixAutoUpdate = false;
    texture.matrix.makeTranslation(0.75, 0);
    draw();
    assert.equal(x(), 0.75);
    texture.matrixAutoUpdate = true;
    draw();
    assert.equal(x(), 0.25);
  });
}
