import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { setFlagsFromString } from 'node:v8';
import { CagecastError, classify, init, type Mesh, project, type TransferResult, transfer, Zone } from 'cagecast';
import { type ApplyOptions, applyTransfer, applyTransferAsync, deserialize, extract, serialize } from 'cagecast/three';
import { createLayers, Edits, History, LayerStack } from 'cagecast/three/paint';
import { createPainter } from 'cagecast/three/paint';
import { terminate } from 'cagecast/worker';
import {
  BatchedMesh,
  Bone,
  BoxGeometry,
  BufferAttribute,
  BufferGeometry,
  Float16BufferAttribute,
  Float32BufferAttribute,
  Group,
  InstancedBufferGeometry,
  InstancedMesh,
  InterleavedBuffer,
  InterleavedBufferAttribute,
  type Matrix3,
  Matrix4,
  MeshNormalMaterial,
  MeshStandardMaterial,
  Quaternion,
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
import { ball, head, join3d } from './scenes.js';

before(init);

const scene = head(3, 10);
const geometryOf = ({ positions, indices, uvs }: Mesh): BufferGeometry => {
  const geometry = new BufferGeometry()
    .setIndex(new BufferAttribute(Uint32Array.from(indices), 1))
    .setAttribute('position', new BufferAttribute(positions.slice(), 3));
  return uvs ? geometry.setAttribute('uv', new BufferAttribute(uvs.slice(), 2)) : geometry;
};
const meshOf = (mesh: Mesh): ThreeMesh<BufferGeometry, MeshStandardMaterial> =>
  new ThreeMesh(geometryOf(mesh), new MeshStandardMaterial({ roughness: 0.3 }));
const attribute = (geometry: BufferGeometry, name: string) => geometry.getAttribute(name).array as Float32Array;
const geometries = (mesh: ThreeMesh) => ({
  ...Object.fromEntries(Object.entries(mesh.geometry.attributes).map(([name, { array }]) => [name, array])),
  index: mesh.geometry.index!.array,
});

describe('extract', () => {
  test('a geometry, a mesh and a scene give the arrays that transfer takes', () => {
    const single = {
      positions: scene.target.positions,
      indices: scene.target.indices,
      uvs: scene.target.uvs,
      groups: new Uint32Array(scene.target.positions.length / 3),
    };
    assert.deepEqual(extract(geometryOf(scene.target)).mesh, single);
    assert.deepEqual(extract(meshOf(scene.target)).mesh, single);
    assert.deepEqual(extract(new Group().add(meshOf(scene.target))).mesh, single);
  });

  test('UVs are of the channel of the base colour texture, the first ones without a texture', () => {
    const mesh = meshOf(scene.cage);
    mesh.geometry.setAttribute(
      'uv1',
      new BufferAttribute(
        scene.cage.uvs!.map((x) => x / 2),
        2,
      ),
    );
    assert.deepEqual(extract(mesh).mesh.uvs, scene.cage.uvs);
    mesh.material.map = new Texture();
    assert.deepEqual(extract(mesh).mesh.uvs, scene.cage.uvs);
    mesh.material.map.channel = 1;
    assert.deepEqual(extract(mesh).mesh.uvs, mesh.geometry.getAttribute('uv1').array);
    mesh.material.map.channel = 2;
    assert.equal(extract(mesh).mesh.uvs, undefined);
  });

  test('meshes of a scene are joined and moved, with a group each; mirrored ones keep their outside', () => {
    const small = ball([0, 0, 0], () => 0.2, 6, 9);
    const left = meshOf(small);
    left.position.x = -0.6;
    left.name = 'left';
    const right = meshOf(small);
    right.position.x = 0.6;
    right.scale.x = -1;
    const { mesh, parts } = extract(new Group().add(left, right));
    const vertices = small.positions.length / 3;
    assert.deepEqual(
      parts.map(({ firstVertex, vertexCount }) => [firstVertex, vertexCount]),
      [
        [0, vertices],
        [vertices, vertices],
      ],
    );
    assert.equal(parts[0]!.name, 'left');
    assert.deepEqual([...new Set(mesh.groups)], [0, 1]);
    for (let t = 0; t < mesh.indices.length / 3; ++t) {
      // Outside is away from the centre of each ball.
      const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromArray(mesh.positions, 3 * mesh.indices[3 * t + k]!)) as [
        Vector3,
        Vector3,
        Vector3,
      ];
      const normal = b.clone().sub(a).cross(c.clone().sub(a));
      const centre = new Vector3(t < mesh.indices.length / 6 ? -0.6 : 0.6, 0, 0);
      assert.ok(normal.dot(a.add(b).add(c).divideScalar(3).sub(centre)) >= 0, `triangle ${t}`);
    }
  });

  test('material groups are groups', () => {
    const box = new ThreeMesh(
      new BoxGeometry(),
      Array.from({ length: 6 }, () => new MeshStandardMaterial()),
    );
    assert.deepEqual([...new Set(extract(box).mesh.groups)], [0, 1, 2, 3, 4, 5]);
    assert.deepEqual(
      [...new Set(extract(new ThreeMesh(new BoxGeometry(), new MeshStandardMaterial())).mesh.groups)],
      [0],
    );
  });

  test('not indexed, interleaved and normalised attributes are read', () => {
    const flat = geometryOf(scene.target).toNonIndexed();
    assert.equal(extract(flat).mesh.indices.length, scene.target.indices.length);
    const quantised = new BufferGeometry().setAttribute(
      'position',
      new BufferAttribute(Int16Array.from([0, 0, 0, 32767, 0, 0, 0, 32767, 0]), 3, true),
    );
    assert.deepEqual([...extract(quantised).mesh.positions], [0, 0, 0, 1, 0, 0, 0, 1, 0]);
  });

  test('an error names what cannot be read', () => {
    const bad = geometryOf({ positions: new Float32Array(9), indices: new Uint32Array([0, 1, 7]) });
    bad.name = 'broken';
    assert.throws(
      () => extract(bad),
      (error) =>
        error instanceof CagecastError &&
        /target: "broken" has indices\[2\] = 7, which is out of range \(3 vertices\)/.test(error.message),
    );
    const odd = new BufferGeometry().setAttribute('position', new Float32BufferAttribute([0, 0, 0, 1, 0, 0], 3));
    assert.throws(() => extract(odd, 'cage'), /cage: "geometry" has 2 corners, not 3 per triangle/);
    assert.throws(
      () => applyTransfer(new Group(), meshOf(scene.cage)),
      (error) => error instanceof CagecastError && error.code === 'emptyMesh',
    );
    const flat = new BufferGeometry().setAttribute('position', new Float32BufferAttribute([0, 0, 1, 0, 0, 1], 2));
    assert.throws(() => extract(flat), /target: "geometry" has positions of 2 numbers, not 3/);
    const short = geometryOf(scene.cage).setAttribute('uv', new Float32BufferAttribute([0, 0, 1, 1], 2));
    assert.throws(
      () => extract(short, 'cage'),
      new RegExp(`cage: "geometry" has 2 uv for ${scene.cage.positions.length / 3} vertices`),
    );
  });

  test('arguments of the wrong type are errors', () => {
    const fails = (message: RegExp, ...args: unknown[]) =>
      assert.throws(
        () => (applyTransfer as (...args: unknown[]) => unknown)(...args),
        (error) => error instanceof CagecastError && message.test(error.message),
        String(message),
      );
    const [target, cage] = [meshOf(scene.target), meshOf(scene.cage)];
    fails(
      /cagecast\/three: target is an object, not a scene, mesh or geometry \(of a loaded glTF, take \.scene\)/,
      { scene: target },
      cage,
    );
    fails(/cagecast\/three: cage is undefined, not a scene/, target);
    fails(
      /cagecast\/three: options\.result\.zones is not an array, the target needs \d+; extract it before/,
      target,
      cage,
      {
        result: {},
      },
    );
    fails(/cagecast\/three: options\.result\.uvs is not an array/, target, cage, {
      result: { ...transfer(scene.cage, { ...scene.target, groups: undefined }), uvs: undefined },
    });
  });
});

test('wrong options are one error of both calls, which names the function, the option and its value', async () => {
  const [target, cage] = [meshOf(scene.target), meshOf(scene.cage)];
  const calls = {
    applyTransfer: async (options: ApplyOptions) => applyTransfer(target, cage, options),
    applyTransferAsync: (options: ApplyOptions) => applyTransferAsync(target, cage, options),
  };
  const refuses = (fn: keyof typeof calls, options: unknown, reason: string) =>
    assert.rejects(
      calls[fn](options as ApplyOptions),
      { name: 'CagecastError', code: 'badOption', argument: 'options', fn, message: `${fn}: ${reason}` },
      `${fn}: ${reason}`,
    );
  for (const [options, reason] of [
    [null, 'options is null, not an object'],
    [7, 'options is 7, not an object'],
    ['paint.png', 'options is "paint.png", not an object'],
    [{ texture: 'paint.png' }, 'options.texture is "paint.png", not a Texture'],
    [{ material: {} }, 'options.material is an object, not a Material'],
    [{ channel: 7 }, 'options.channel is 7, not 1, 2 or 3'],
    [{ opacity: 2 }, 'options.opacity is 2, not a number from 0 to 1'],
    [{ feather: Number.NaN }, 'options.feather is NaN, not a number from 0 to 1'],
    [{ saved: {} }, 'options.saved is an object, not what deserialize returned'],
    [{ borders: 'round' }, 'options.borders = "round" is unknown; there are: "triangle", "cut"'],
  ] as const)
    for (const fn of Object.keys(calls) as (keyof typeof calls)[]) await refuses(fn, options, reason);
  await refuses('applyTransferAsync', { signal: 'soon' }, 'options.signal is "soon", not an AbortSignal');
  await refuses('applyTransferAsync', { signal: {} }, 'options.signal is an object, not an AbortSignal');
  await refuses('applyTransferAsync', { signal: false }, 'options.signal is false, not an AbortSignal');
  await refuses('applyTransferAsync', { onProgress: false }, 'options.onProgress is false, not a function');
});

/** Asserts that a geometry shows the UV and zone of a result at each corner, and is what it was, with copies of vertices at the end. */
function assertSplit(geometry: BufferGeometry, before: BufferGeometry, result: TransferResult): void {
  const vertices = before.getAttribute('position').count;
  const corners = [...geometry.index!.array];
  const source = new Map<number, number>();
  corners.forEach((vertex, i) => {
    const old = before.index!.getX(i);
    assert.equal(source.get(vertex) ?? old, old);
    source.set(vertex, old);
    if (vertex < vertices) assert.equal(vertex, old);
    const uv = geometry.getAttribute('uv1');
    assert.deepEqual(
      [uv.getX(vertex) + 0, uv.getY(vertex) + 0],
      [result.cornerUvs[2 * i]! + 0, result.cornerUvs[2 * i + 1]! + 0],
    );
    assert.equal(geometry.getAttribute('_ncz').getX(vertex), result.zones[old]);
  });
  const elements = ({ itemSize }: { itemSize: number }) => Array.from({ length: itemSize }, (_, k) => k);
  for (const [vertex, old] of source) {
    for (const [name, attribute] of Object.entries(before.attributes)) {
      for (const k of elements(attribute))
        assert.equal(geometry.getAttribute(name).getComponent(vertex, k), attribute.getComponent(old, k), name);
    }
    for (const [name, morphs] of Object.entries(before.morphAttributes)) {
      morphs!.forEach((morph, m) => {
        for (const k of elements(morph))
          assert.equal(
            geometry.morphAttributes[name as 'position']![m]!.getComponent(vertex, k),
            morph.getComponent(old, k),
            name,
          );
      });
    }
  }
}

describe('applyTransfer', () => {
  test('splits vertices with all their attributes at the seams of the texture', () => {
    const vertices = scene.target.positions.length / 3;
    const target = meshOf(scene.target);
    const { geometry } = target;
    const interleaved = new InterleavedBuffer(
      Float32Array.from({ length: 5 * vertices }, (_, i) => i),
      5,
    );
    geometry.setAttribute('normal', new InterleavedBufferAttribute(interleaved, 3, 1));
    geometry.setAttribute(
      'skinIndex',
      new Uint16BufferAttribute(
        Uint16Array.from({ length: 4 * vertices }, (_, i) => i % 999),
        4,
      ),
    );
    geometry.setAttribute(
      'color',
      new BufferAttribute(
        Uint8Array.from({ length: 3 * vertices }, (_, i) => i % 255),
        3,
        true,
      ),
    );
    geometry.setAttribute(
      'half',
      new Float16BufferAttribute(
        Uint16Array.from({ length: vertices }, (_, i) => i % 999),
        1,
      ),
    );
    geometry.morphAttributes['position'] = [
      new BufferAttribute(
        scene.target.positions.map((x) => 0.5 * x),
        3,
      ),
    ];
    const before = geometry.clone();
    let disposed = 0;
    geometry.addEventListener('dispose', () => ++disposed);
    const { result, splitVertices } = applyTransfer(target, meshOf(scene.cage));
    assert.ok(splitVertices > 0 && disposed === 1);
    assert.equal(target.geometry, geometry);
    assert.equal(geometry.getAttribute('position').count, vertices + splitVertices);
    assertSplit(geometry, before, result);
  });

  test('a mirrored mesh is split as it is seen', () => {
    const target = meshOf({
      ...scene.target,
      positions: scene.target.positions.map((x, i) => (i % 3 === 0 ? -x : x)),
      indices: scene.target.indices.slice().reverse(),
    });
    target.scale.x = -1;
    const before = target.geometry.clone();
    const { result, splitVertices } = applyTransfer(target, meshOf(scene.cage));
    assert.ok(splitVertices > 0);
    // In the arrays of the result the second and third corners of mirrored triangles have changed places.
    const cornerUvs = Float32Array.from(
      result.cornerUvs,
      (_, i) => result.cornerUvs[i - (i % 6) + [0, 1, 4, 5, 2, 3][i % 6]!]!,
    );
    assertSplit(target.geometry, before, { ...result, cornerUvs });
  });

  test("seams: 'vertex' adds uv1 and _ncz, as transfer answers", () => {
    const target = meshOf(scene.target);
    const { result, overlays, splitVertices } = applyTransfer(target, meshOf(scene.cage), { seams: 'vertex' });
    assert.equal(splitVertices, 0);
    const expected = transfer(scene.cage, { ...scene.target, groups: undefined });
    assert.deepEqual(result.zones, expected.zones);
    assert.deepEqual(attribute(target.geometry, 'uv1'), expected.uvs);
    assert.deepEqual([...attribute(target.geometry, '_ncz')], [...expected.zones]);
    assert.deepEqual(attribute(target.geometry, 'uv'), scene.target.uvs);
    assert.deepEqual([overlays.length, target.children.length], [0, 0]);
  });

  test('with a texture the material shows it on the cosmetic triangles; the texture stays as it is', () => {
    const target = meshOf(scene.target);
    const { geometry, material } = target;
    const texture = new Texture();
    const before = { ...texture };
    const { version } = material;
    const { result, overlays, update, setTexture, setOpacity, dispose, splitVertices } = applyTransfer(
      target,
      meshOf(scene.cage),
      {
        texture,
      },
    );
    assert.deepEqual([overlays.length, target.children.length, target.material], [0, 0, material]);
    assert.deepEqual({ ...texture }, before);
    assert.ok(material.version > version);

    /** Asserts that a triangle is painted if and only if it is cosmetic: by the rule of the shader. */
    const assertPainted = (cosmetic: Uint8Array) => {
      const [paint, uv] = [geometry.getAttribute('_cagecast_paint'), geometry.getAttribute('uv1')];
      const corners = geometry.index!.array;
      cosmetic.forEach((one, t) => {
        const vertices = [...corners.subarray(3 * t, 3 * t + 3)];
        assert.equal(vertices.every((v) => paint.getZ(v) === 0) ? 1 : 0, one, `triangle ${t}`);
        for (const v of vertices)
          assert.deepEqual([paint.getX(v), paint.getY(v), paint.getW(v)], [uv.getX(v), uv.getY(v), 2]);
      });
    };
    assertPainted(result.cosmeticTriangles);
    assert.ok(splitVertices > 0);

    // Another threshold.
    const decided = classify(project(scene.cage, { ...scene.target, groups: undefined }), { threshold: 1 });
    update(decided);
    assertPainted(decided.cosmeticTriangles);
    assert.deepEqual([...attribute(geometry, '_ncz')].slice(0, decided.zones.length), [...decided.zones]);
    const { zones, cosmeticTriangles } = decided;
    assert.throws(
      // @ts-expect-error that is half a decision
      () => update({ zones, cosmeticTriangles }),
      (error) =>
        error instanceof CagecastError &&
        error.code === 'badArgument' &&
        /classification\.segmentStats is not an array/.test(error.message),
    );
    // What no segment passes has no paint, and its material is as it was.
    const none = Uint8Array.from(zones, () => Zone.Culled);
    update({ ...decided, zones: none, cosmeticTriangles: new Uint8Array(cosmeticTriangles.length) });
    assert.ok(!Object.hasOwn(material, 'onBeforeCompile'));
    update(result);
    assert.ok(Object.hasOwn(material, 'onBeforeCompile'));
    // Without a texture it stays ready for one, whose shader is compiled already.
    setTexture(undefined);
    assert.ok(Object.hasOwn(material, 'onBeforeCompile'));
    setTexture(new Texture());
    setOpacity(0.5);
    assert.throws(() => setOpacity(2), /setOpacity: 2 is not a number from 0 to 1/);
    assert.throws(() => setTexture('paint.png' as unknown as Texture), /setTexture: "paint\.png" is not a Texture/);
    dispose();
    assert.ok(!Object.hasOwn(material, 'onBeforeCompile') && !Object.hasOwn(material, 'customProgramCacheKey'));
    assert.ok(!geometry.hasAttribute('_cagecast_paint') && geometry.hasAttribute('uv1'));
  });

  for (const shows of ['texture', 'material'] as const) {
    test(`triangles in another order and UVs changed by others leave later updates right (${shows})`, () => {
      const mesh = () => meshOf(scene.target);
      const options = shows === 'texture' ? { texture: new Texture() } : { material: new MeshStandardMaterial() };
      const [plain, sorted] = [mesh(), mesh()];
      const [first, second] = [plain, sorted].map((target) => applyTransfer(target, meshOf(scene.cage), options));
      const bytes = serialize(second!);
      // As three-mesh-bvh does, in place.
      const { array } = sorted.geometry.index!;
      const triangles = Array.from({ length: array.length / 3 }, (_, t) => [...array.subarray(3 * t, 3 * t + 3)]);
      array.set(triangles.reverse().flat());
      attribute(sorted.geometry, 'uv1').fill(0.5);
      assert.deepEqual(serialize(second!), bytes);
      const decided = classify(project(scene.cage, { ...scene.target, groups: undefined }), { threshold: 1 });
      for (const one of [first!, second!]) one.update(decided);
      for (const one of [first!, second!]) one.update(one.result);
      if (shows === 'texture')
        assert.deepEqual(attribute(sorted.geometry, '_cagecast_paint'), attribute(plain.geometry, '_cagecast_paint'));
      else assert.deepEqual(second!.overlays[0]!.geometry.index!.array, first!.overlays[0]!.geometry.index!.array);
    });
  }

  test('painted materials keep one hidden class, so that a renderer reads them as fast as others', () => {
    setFlagsFromString('--allow-natives-syntax');
    const isAlike = new Function('a', 'b', 'return %HaveSameMap(a, b)') as (a: object, b: object) => boolean;
    const model = new Group().add(...[0, 1, 2, 3].map(() => meshOf(scene.target)));
    applyTransfer(model, meshOf(scene.cage), { texture: new Texture() });
    // The first ones show V8 what the fields hold.
    const [, , third, fourth] = model.children.map((mesh) => (mesh as ReturnType<typeof meshOf>).material);
    assert.equal(third!.customProgramCacheKey(), fourth!.customProgramCacheKey());
    assert.equal(isAlike(third!, fourth!), true);
  });

  test('of two copies of the module on a page, the one that paints last is seen, by programs of its own', async () => {
    const url = import.meta.resolve('cagecast/three');
    const copy = (await import(`${url}?copy`)) as typeof import('cagecast/three');
    const target = meshOf(scene.target);
    const [first, second] = [new Texture(), new Texture()];
    const before = applyTransfer(target, meshOf(scene.cage), { texture: first });
    const firstKey = target.material.customProgramCacheKey();
    copy.applyTransfer(target, meshOf(scene.cage), { texture: second });
    const { vertexShader, fragmentShader, uniforms } = ShaderLib.standard;
    const shader = { vertexShader, fragmentShader, uniforms: { ...uniforms } } as WebGLProgramParametersWithUniforms;
    target.material.onBeforeCompile(shader, undefined as unknown as WebGLRenderer);
    assert.equal(shader.uniforms['cagecastMap']!.value, second);
    const other = meshOf(scene.target);
    copy.applyTransfer(other, meshOf(scene.cage), { texture: second });
    assert.notEqual(other.material.customProgramCacheKey(), firstKey);
    before.dispose();
  });

  test('a material that two models show is painted for the first and copied for the second', () => {
    const [one, two] = [meshOf(scene.target), meshOf(scene.target)];
    two.material = one.material;
    const [first, second] = [one, two].map((mesh) =>
      applyTransfer(mesh, meshOf(scene.cage), { texture: new Texture() }),
    );
    const { material } = one;
    assert.notEqual(two.material, material);
    second!.dispose();
    assert.equal(two.material, material);
    assert.ok(Object.hasOwn(material, 'onBeforeCompile'));
    // Applied to the same mesh again, the later paint is the one that stays.
    const again = applyTransfer(one, meshOf(scene.cage), { texture: new Texture() });
    assert.equal(one.material, material);
    first!.dispose();
    assert.ok(Object.hasOwn(material, 'onBeforeCompile') && one.geometry.hasAttribute('_cagecast_paint'));
    again.dispose();
    assert.ok(!Object.hasOwn(material, 'onBeforeCompile'));
  });

  test('a texture on a node material is an error, and nothing is changed', () => {
    const target = meshOf(scene.target);
    Object.assign(target.material, { isNodeMaterial: true, name: 'skin' });
    const before = Object.keys(target.geometry.attributes);
    assert.throws(
      () => applyTransfer(target, meshOf(scene.cage), { texture: new Texture() }),
      (error) => error instanceof CagecastError && /has a node material, .* give options\.material/.test(error.message),
    );
    assert.deepEqual(Object.keys(target.geometry.attributes), before);
    const { overlays } = applyTransfer(target, meshOf(scene.cage), { material: new MeshStandardMaterial() });
    assert.equal(overlays.length, 1);
  });

  test('a soft border: distances from the border of the paint, 0 on it, growing by no more than the edges', () => {
    const target = meshOf(ball([0, 0, 0], () => 1, 24, 36));
    const around = ball([0, 0, 0], () => 1.1, 24, 36);
    const open = around.indices.filter((_, i) => around.positions[3 * around.indices[i - (i % 3)]! + 1]! < 0.5);
    const applied = applyTransfer(target, meshOf({ ...around, indices: open }), {
      texture: new Texture(),
      feather: 0.1,
    });
    const { geometry } = target;
    const paint = geometry.getAttribute('_cagecast_paint');
    const corners = geometry.index!.array;
    const bare = new Set([...corners].filter((_, i) => applied.result.cosmeticTriangles[Math.floor(i / 3)] === 0));
    const place = (v: number) => new Vector3().fromBufferAttribute(geometry.getAttribute('position'), v);
    geometry.computeBoundingBox();
    const size = geometry.boundingBox!.getSize(new Vector3()).length();
    let [atBorder, inside] = [0, 0];
    for (let i = 0; i < corners.length; i += 3) {
      if (applied.result.cosmeticTriangles[i / 3] === 0) continue;
      const [a, b] = [corners[i]!, corners[i + 1]!];
      if (bare.has(a)) {
        ++atBorder;
        assert.equal(paint.getW(a), 2);
      }
      if (paint.getW(a) > 2.05) ++inside;
      const [d, e] = [paint.getW(a), paint.getW(b)];
      if (Math.min(d, e) < 2.1) assert.ok(Math.abs(d - e) * size <= place(a).distanceTo(place(b)) + 1e-5);
    }
    assert.ok(atBorder > 10 && inside > 10, `${atBorder}, ${inside}`);
  });

  test('with a material it lays the cosmetic triangles over each mesh, sharing its vertices', () => {
    const target = meshOf(scene.target);
    const material = new MeshStandardMaterial();
    const { result, overlays, update, dispose, channel } = applyTransfer(target, meshOf(scene.cage), {
      material,
      channel: 2,
    });
    const [overlay] = overlays as [ThreeMesh<BufferGeometry, MeshStandardMaterial>];
    assert.equal(overlay.parent, target);
    assert.equal(channel, 2);
    assert.equal(overlay.material, material);
    assert.equal(overlay.geometry.getAttribute('position'), target.geometry.getAttribute('position'));
    assert.equal(overlay.geometry.getAttribute('uv2'), target.geometry.getAttribute('uv2'));
    const corners = [...target.geometry.index!.array].filter(
      (_, i) => result.cosmeticTriangles[Math.floor(i / 3)] === 1,
    );
    assert.deepEqual([...overlay.geometry.index!.array], corners);
    const decided = classify(project(scene.cage, { ...scene.target, groups: undefined }), { threshold: 1 });
    update(decided);
    assert.equal(overlay.geometry.index!.count, 3 * decided.cosmeticTriangles.filter((one) => one === 1).length);
    // The renderer frees what a geometry has when it goes.
    let freed: unknown[] = [target.geometry.getAttribute('position')];
    overlay.geometry.addEventListener('dispose', () => (freed = Object.values(overlay.geometry.attributes)));
    dispose();
    assert.deepEqual(freed, []);
    assert.equal(target.children.length, 0);
  });

  test('another texture reaches the overlay on a material that cannot be painted', () => {
    const target = new ThreeMesh(geometryOf(scene.target), new MeshNormalMaterial());
    const [red, green] = [new Texture(), new Texture()];
    const { overlays, setTexture } = applyTransfer(target, meshOf(scene.cage), { texture: red });
    const shader = { uniforms: {} as Record<string, { value: unknown }>, vertexShader: '', fragmentShader: '' };
    (overlays[0]!.material as MeshStandardMaterial).onBeforeCompile(shader as never, undefined as never);
    assert.equal(shader.uniforms['cagecastMap']!.value, red);
    for (const texture of [green, undefined, red, null, red]) {
      setTexture(texture);
      assert.equal(overlays[0]!.parent, texture ? target : null);
      if (texture) assert.equal(shader.uniforms['cagecastMap']!.value, texture);
    }
  });

  test('a texture or a material that is null is none', () => {
    const [target, other] = [meshOf(scene.target), new ThreeMesh(geometryOf(scene.target), new MeshNormalMaterial())];
    const plain = applyTransfer(meshOf(scene.target), meshOf(scene.cage));
    const bare = applyTransfer(target, meshOf(scene.cage), { texture: null, material: null });
    assert.equal(bare.splitVertices, plain.splitVertices);
    assert.ok(!Object.hasOwn(target.material, 'onBeforeCompile'), 'the material is as it was');
    const painted = applyTransfer(other, meshOf(scene.cage), { texture: new Texture() });
    applyTransfer(other, meshOf(scene.cage), { texture: null });
    assert.deepEqual(other.children, painted.overlays);
  });

  test('a later transfer takes away the overlays whose paint it replaces', () => {
    const target = new ThreeMesh(geometryOf(scene.target), new MeshNormalMaterial());
    const materials = [1, 2, 3].map(() => new MeshStandardMaterial());
    const show = (options: ApplyOptions) => applyTransfer(target, meshOf(scene.cage), options);
    show({ texture: new Texture() });
    const painted = show({ texture: new Texture() });
    assert.deepEqual(target.children, painted.overlays);
    show({});
    assert.deepEqual(target.children, painted.overlays);
    show({ material: materials[0]! });
    const other = show({ material: materials[1]! });
    assert.deepEqual(target.children, other.overlays);
    // Both can be seen if each has UVs of its own.
    const beside = show({ material: materials[2]!, channel: 2 });
    assert.deepEqual(target.children, [...other.overlays, ...beside.overlays]);
    painted.dispose();
    const { overlays } = show({ texture: new Texture() });
    assert.deepEqual(target.children, overlays);
    other.update(other.result);
    assert.deepEqual(target.children, overlays, 'what is replaced does not come back');
  });

  test('an update frees the triangles that an overlay had, but not what is of its base', () => {
    const target = meshOf(scene.target);
    const { overlays, update, result } = applyTransfer(target, meshOf(scene.cage), {
      material: new MeshStandardMaterial(),
    });
    const { geometry } = overlays[0]!;
    const copy = target.clone().children[0] as ThreeMesh;
    const freed: string[][] = [];
    geometry.addEventListener('dispose', () => freed.push(Object.keys(geometry.attributes)));
    update(result);
    assert.deepEqual(freed, [[]]);
    // A copy of the model goes on showing them.
    assert.equal(copy.geometry, geometry);
    assert.equal(geometry.getAttribute('position'), target.geometry.getAttribute('position'));
  });

  test('a UV set that a model has of its own stays, also when it is transferred again', () => {
    const target = meshOf(scene.target);
    const own = new BufferAttribute(new Float32Array((2 * scene.target.positions.length) / 3), 2);
    target.geometry.setAttribute('uv1', own);
    for (let i = 0; i < 2; ++i) {
      const texture = new Texture();
      const applied = applyTransfer(target, meshOf(scene.cage), { texture, seams: 'vertex' });
      applied.dispose();
      assert.deepEqual([applied.channel, texture.channel], [2, 0]);
      assert.equal(target.geometry.getAttribute('uv1'), own);
      assert.equal(target.geometry.hasAttribute('uv3'), false);
    }
    target.geometry.setAttribute('uv2', own.clone()).setAttribute('uv3', own.clone());
    applyTransfer(target, meshOf(scene.cage), { channel: 3, seams: 'vertex' });
    const other = meshOf(scene.target);
    for (const name of ['uv1', 'uv2', 'uv3']) other.geometry.setAttribute(name, own);
    assert.throws(() => applyTransfer(other, meshOf(scene.cage)), /has uv1, uv2 and uv3 of its own/);
  });

  test('an instanced mesh is where its first instance is; batches are an error', () => {
    const { geometry, material } = meshOf(scene.target);
    const instanced = new InstancedMesh(geometry, material, 2);
    instanced.setMatrixAt(0, new Matrix4().makeTranslation(-3, 0, 0));
    instanced.setMatrixAt(1, new Matrix4().makeTranslation(100, 0, 0));
    instanced.position.x = 3;
    const { parts, mesh } = extract(new Group().add(instanced));
    assert.equal(parts.length, 1);
    assert.deepEqual(mesh.positions, scene.target.positions);
    const { result } = applyTransfer(instanced, meshOf(scene.cage), { texture: new Texture() });
    assert.deepEqual(result.zones, transfer(scene.cage, { ...scene.target, groups: undefined }).zones);
    assert.throws(
      () => extract(new Group().add(new BatchedMesh(2, 99, 99, material))),
      /make each instance a mesh of its own/,
    );
    assert.throws(
      () => extract(new ThreeMesh(new InstancedBufferGeometry().copy(geometry as InstancedBufferGeometry), material)),
      /make each instance a mesh of its own/,
    );
    const few = geometry.clone().setAttribute('heat', new BufferAttribute(new Float32Array(5), 1));
    assert.throws(() => extract(few), /"geometry" has 5 heat for \d+ vertices/);
  });

  test('overlays that are in its file are no part of a model', () => {
    const [overlay, joined] = [meshOf(scene.target), meshOf(scene.target)];
    overlay.geometry.userData = { cagecastOverlay: true }; // as GLTFLoader hands on what the command writes
    joined.material = new MeshStandardMaterial({ userData: { cagecastOverlay: true } }); // what is left when overlays were joined
    assert.equal(extract(new Group().add(meshOf(scene.target), overlay, joined)).parts.length, 1);
  });

  test('applied again, it ignores its own overlays', () => {
    const target = new Group().add(meshOf(scene.target));
    applyTransfer(target, meshOf(scene.cage), { texture: new Texture() });
    assert.equal(applyTransfer(target, meshOf(scene.cage)).parts.length, 1);
  });

  test('a result from elsewhere is used as it is', () => {
    const target = meshOf(scene.target);
    const known = transfer(extract(meshOf(scene.cage), 'cage').mesh, extract(target).mesh);
    const applied = applyTransfer(target, meshOf(scene.cage), { result: known });
    assert.equal(applied.result, known);
    assert.ok(applied.splitVertices > 0);
    // It is not of what the target has become.
    assert.throws(
      () => applyTransfer(target, meshOf(scene.cage), { result: known }),
      (error) =>
        error instanceof CagecastError &&
        /options\.result\.zones has \d+ entries, the target needs \d+; extract it before/.test(error.message),
    );
    // Of which a transfer of its own splits no vertex again.
    assert.equal(applyTransfer(target, meshOf(scene.cage)).splitVertices, 0);
  });

  test('a geometry that two meshes show is copied for the second', () => {
    const geometry = geometryOf(ball([0, 0, 0], () => 0.2, 6, 9));
    const meshes = [-0.6, 0.6].map((x) => {
      const mesh = new ThreeMesh(geometry, new MeshStandardMaterial());
      mesh.position.x = x;
      return mesh;
    });
    applyTransfer(new Group().add(...meshes), meshOf(scene.cage), { texture: new Texture() });
    assert.equal(meshes[0]!.geometry, geometry);
    assert.notEqual(meshes[1]!.geometry, geometry);
    assert.notDeepEqual(attribute(meshes[0]!.geometry, 'uv1'), attribute(meshes[1]!.geometry, 'uv1'));
  });

  test('morph targets go with the overlay', () => {
    const target = meshOf(scene.target);
    target.geometry.morphAttributes['position'] = [
      new BufferAttribute(
        scene.target.positions.map((x) => 0.5 * x),
        3,
      ),
    ];
    target.geometry.morphTargetsRelative = true;
    target.updateMorphTargets();
    const {
      overlays: [overlay],
    } = applyTransfer(target, meshOf(scene.cage), { material: new MeshStandardMaterial() });
    const vertex = overlay!.geometry.index!.getX(0);
    for (const weight of [0, 1]) {
      target.morphTargetInfluences![0] = weight;
      const [a, b] = [target, overlay!].map((mesh) => mesh.getVertexPosition(vertex, new Vector3()));
      assert.deepEqual(b, a);
      assert.ok(
        Math.abs(
          a!.length() - (1 + 0.5 * weight) * new Vector3().fromArray(scene.target.positions, 3 * vertex).length(),
        ) < 1e-6,
      );
    }
  });

  test('a skinned mesh is where its bones hold it, whatever the unit it is stored in', () => {
    const vertices = scene.target.positions.length / 3;
    const geometry = geometryOf({ ...scene.target, positions: scene.target.positions.map((x) => 128 * x) })
      .setAttribute(
        'skinIndex',
        new BufferAttribute(
          Uint16Array.from({ length: 4 * vertices }, (_, i) => (i % 4 === 0 ? (i / 4) % 2 : 0)),
          4,
        ),
      )
      .setAttribute(
        'skinWeight',
        new BufferAttribute(
          new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
          4,
        ),
      );
    const [rig, tip] = [new Bone(), new Bone()];
    rig.add(tip);
    tip.position.x = 0.5;
    const target = new SkinnedMesh(geometry, new MeshStandardMaterial());
    target.position.x = 100;
    const inverse = (x: number) => new Matrix4().makeTranslation(x, 0, 0).scale(new Vector3(1 / 128, 1 / 128, 1 / 128));
    target.bind(new Skeleton([rig, tip], [inverse(0), inverse(-0.5)]), new Matrix4());
    const { result } = applyTransfer(new Group().add(rig, target), meshOf(scene.cage));
    assert.deepEqual(result.uvs, transfer(scene.cage, { ...scene.target, groups: undefined }).uvs);
  });

  test('skins go with the overlay; the target is taken in its bind pose', () => {
    const vertices = scene.target.positions.length / 3;
    const geometry = geometryOf(scene.target)
      .setAttribute(
        'skinIndex',
        new BufferAttribute(
          Uint16Array.from({ length: 4 * vertices }, (_, i) => (i === 4 * vertices - 4 ? 1 : 0)),
          4,
        ),
      )
      .setAttribute(
        'skinWeight',
        new BufferAttribute(
          new Float32Array(4 * vertices).map((_, i) => (i % 4 === 0 ? 1 : 0)),
          4,
        ),
      );
    const [bone, still] = [new Bone(), new Bone()];
    const target = new SkinnedMesh(geometry, new MeshStandardMaterial());
    const root = new Group().add(bone, still, target);
    target.bind(new Skeleton([bone, still]));
    bone.quaternion.copy(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), 1));
    root.updateMatrixWorld(true);
    const { result, overlays } = applyTransfer(root, meshOf(scene.cage), { material: new MeshStandardMaterial() });
    assert.deepEqual(result.uvs, transfer(scene.cage, { ...scene.target, groups: undefined }).uvs);
    const [overlay] = overlays as [SkinnedMesh];
    assert.equal(overlay.skeleton, target.skeleton);
    root.updateMatrixWorld(true);
    const vertex = overlay.geometry.index!.getX(0);
    const [rest, posed, painted] = [
      new Vector3().fromArray(scene.target.positions, 3 * vertex),
      target.getVertexPosition(vertex, new Vector3()),
      overlay.getVertexPosition(vertex, new Vector3()),
    ];
    assert.ok(posed.distanceTo(rest) > 0.1);
    assert.ok(painted.distanceTo(posed) < 1e-9);
  });

  /**
   * A figure as GLTFLoader makes it: its skin is held by hips and head, its eyes by a bone of their own on the head.
   * @param times  How much larger skin and eyes are stored than they are shown.
   */
  const figure = (times: [skin: number, eyes: number] = [1, 1]) => {
    const [hips, neck, eye] = [new Bone(), new Bone(), new Bone()];
    neck.position.z = 0.2;
    eye.position.set(0.3, 0.1, 0.3);
    const scene3d = new Group().add(hips.add(neck.add(eye)));
    scene3d.updateMatrixWorld(true);
    const skinned = (mesh: Mesh, bones: Bone[], jointAt: (z: number) => number, scale: number) => {
      const vertices = mesh.positions.length / 3;
      const [held, weights] = [new Uint16Array(4 * vertices), new Float32Array(4 * vertices)];
      for (let v = 0; v < vertices; ++v) {
        held[4 * v] = jointAt(mesh.positions[3 * v + 2]!);
        weights[4 * v] = 1;
      }
      const geometry = geometryOf({ ...mesh, positions: mesh.positions.map((x) => scale * x) })
        .setAttribute('skinIndex', new BufferAttribute(held, 4))
        .setAttribute('skinWeight', new BufferAttribute(weights, 4));
      const child = new SkinnedMesh(geometry, new MeshStandardMaterial());
      child.position.set(9, 9, 9); // which glTF ignores
      const inverses = bones.map((bone) =>
        bone.matrixWorld
          .clone()
          .invert()
          .scale(new Vector3().setScalar(1 / scale)),
      );
      child.bind(new Skeleton(bones, inverses), new Matrix4());
      scene3d.add(child);
    };
    skinned(scene.target, [hips, neck], (z) => (z > 0.2 ? 1 : 0), times[0]);
    // Tools that quantise give each mesh a copy of the whole skin, others only the bones that hold it.
    const ofEyes = times[1] === 1 ? [eye] : [hips, neck, eye];
    const eyes = ball([0.4, 0.1, 0.5], () => 0.2, 6, 9);
    skinned(eyes, ofEyes, () => ofEyes.length - 1, times[1]);
    return { scene3d, hips, neck, eye };
  };
  const poses: Record<string, (of: ReturnType<typeof figure>) => void> = {
    'the head turned': ({ neck }) => neck.rotation.set(0.3, 0.4, 0),
    'the eyes turned as well': ({ neck, eye }) => [neck, eye].forEach((bone) => bone.rotation.set(0.1, 0.4, 0)),
    'all in motion': ({ hips, neck, eye }) => {
      hips.position.set(0.02, 0, 0.05);
      [hips, neck, eye].forEach((bone) => bone.rotation.set(0.1, 0.2, 0));
    },
  };

  test('all meshes of a posed figure are taken in its bind pose, wherever it stands', () => {
    const places: Record<string, (of: Group) => void> = {
      'at the origin': () => undefined,
      'in another place': (of) => of.position.set(5, 0, 0),
      'turned and larger': (of) => of.position.set(1, 2, 3) && of.rotation.set(0, 2, 0) && of.scale.setScalar(2),
    };
    for (const [where, place] of Object.entries(places))
      for (const [how, pose] of Object.entries(poses)) {
        const [rest, posed] = [figure(), figure()];
        pose(posed);
        for (const { scene3d } of [rest, posed]) place(scene3d);
        assert.deepEqual(extract(posed.scene3d).mesh, extract(rest.scene3d).mesh, `${how}, ${where}`);
        const around = [rest, posed].map(({ scene3d }) => new Group().add(scene3d));
        for (const group of around) group.position.y = 3;
        const [still, moved] = around.map((group) => extract(group).mesh);
        assert.deepEqual(moved, still, `${how}, ${where}, in a group`);
      }
  });

  test('so are those that are stored in another unit', () => {
    for (const how of ['the head turned', 'the eyes turned as well']) {
      const [rest, posed] = [figure([64, 32]), figure([64, 32])];
      poses[how]!(posed);
      const [expected, seen] = [rest, posed].map(({ scene3d }) => extract(scene3d).mesh.positions);
      assert.ok(
        seen!.every((x, i) => Math.abs(x - expected![i]!) < 1e-6),
        how,
      );
    }
  });

  test('what was saved of a model is accepted while an animation plays', () => {
    const [rest, posed] = [figure(), figure()];
    const cage = meshOf(scene.cage);
    const bytes = serialize(applyTransfer(rest.scene3d, cage));
    posed.neck.rotation.x = 0.1;
    const { result } = applyTransfer(posed.scene3d, undefined, { saved: deserialize(bytes) });
    assert.deepEqual(result.uvs, applyTransfer(figure().scene3d, cage).result.uvs);
  });

  test('a figure that was bound where it stands, or has its bones inside, is taken there', () => {
    const { positions } = scene.target;
    const skinned = () => {
      const geometry = geometryOf(scene.target)
        .setAttribute(
          'skinIndex',
          new BufferAttribute(
            Uint16Array.from({ length: (4 * positions.length) / 3 }, (_, i) => (i % 8 === 0 ? 1 : 0)),
            4,
          ),
        )
        .setAttribute(
          'skinWeight',
          new BufferAttribute(
            Float32Array.from({ length: (4 * positions.length) / 3 }, (_, i) => (i % 4 === 0 ? 1 : 0)),
            4,
          ),
        );
      const [hips, neck] = [new Bone(), new Bone()];
      return { mesh: new SkinnedMesh(geometry, new MeshStandardMaterial()), hips: hips.add(neck), neck };
    };
    const moved = (x: number) => positions.map((value, i) => (i % 3 === 0 ? value + x : value));
    const inside = skinned();
    inside.mesh.add(inside.hips);
    inside.mesh.bind(new Skeleton([inside.hips, inside.neck]));
    inside.mesh.position.x = 5;
    inside.neck.rotation.x = 0.5;
    assert.deepEqual(extract(new Group().add(inside.mesh)).mesh.positions, moved(5));
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
      assert.deepEqual(extract(group).mesh.positions, moved(5), bindMode);
    }
  });

  test('the parts of a scene keep their own zones', () => {
    const skin = ball([0, 0, 0], () => 1, 12, 20);
    const tongue = ball([0, 0, 0], () => 0.3, 6, 9);
    const target = new Group().add(meshOf(skin), meshOf(tongue));
    const { result } = applyTransfer(target, meshOf(ball([0, 0, 0], () => 1.1, 10, 16)));
    assert.deepEqual(
      result.zones,
      transfer(
        ball([0, 0, 0], () => 1.1, 10, 16),
        join3d(skin, tongue),
      ).zones,
    );
    const [outer, inner] = target.children as [ThreeMesh, ThreeMesh];
    assert.ok(attribute(outer.geometry, '_ncz').every((zone) => zone === Zone.Cosmetic));
    assert.ok(attribute(inner.geometry, '_ncz').every((zone) => zone === Zone.Occluded));
  });
});

describe('saved transfers', () => {
  const texture = new Texture();

  for (const borders of ['triangle', 'cut'] as const) {
    test(`give the same geometry and the same result, without a cage (borders: ${borders})`, () => {
      const [first, second] = [meshOf(scene.target), meshOf(scene.target)];
      const applied = applyTransfer(first, meshOf(scene.cage), { texture, borders });
      const again = applyTransfer(second, undefined, { texture, saved: deserialize(serialize(applied)) });
      assert.deepEqual(geometries(second), geometries(first));
      assert.deepEqual(again.result, applied.result);
      assert.deepEqual([again.splitVertices, again.cutTriangles], [applied.splitVertices, applied.cutTriangles]);
      const decided = classify(project(scene.cage, { ...scene.target, groups: undefined }), { threshold: 1 });
      for (const one of [applied, again]) one.update(decided);
      assert.deepEqual(geometries(second), geometries(first));
      assert.deepEqual(serialize(again), serialize(applied));
    });
  }

  test('have a key that depends on target, cage and options', () => {
    const keyOf = (target: Mesh, cage: Mesh, options = {}) =>
      deserialize(serialize(applyTransfer(meshOf(target), meshOf(cage), options))).key;
    const moved = { ...scene.cage, positions: scene.cage.positions.map((x) => 1.001 * x) };
    const small = { ...scene.target, positions: scene.target.positions.map((x) => 0.999 * x) };
    const keys = [
      keyOf(scene.target, scene.cage),
      keyOf(scene.target, moved),
      keyOf(small, scene.cage),
      keyOf(scene.target, scene.cage, { threshold: 0.3 }),
      keyOf(scene.target, scene.cage, { borders: 'cut' }),
    ];
    assert.equal(new Set(keys).size, keys.length);
    assert.equal(keyOf(scene.target, scene.cage), keys[0]);
    assert.equal(keyOf(scene.target, scene.cage, { texture, opacity: 0.5 }), keys[0]);
  });

  test('bytes in a Buffer of Node are read as well, and copied', () => {
    const bytes = serialize(applyTransfer(meshOf(scene.target), meshOf(scene.cage)));
    const large = Buffer.concat([Buffer.alloc(5), bytes]);
    const read = deserialize(large.subarray(5));
    large.fill(255);
    assert.deepEqual(read, deserialize(bytes));
  });

  test('of another target, damaged ones and others are errors', () => {
    const bytes = serialize(applyTransfer(meshOf(scene.target), meshOf(scene.cage)));
    const other = meshOf({ ...scene.target, positions: scene.target.positions.map((x) => 0.999 * x) });
    assert.throws(() => applyTransfer(other, undefined, { saved: deserialize(bytes) }), /saved is of another target/);
    const moved = meshOf(scene.target);
    moved.position.x = 1;
    assert.throws(() => applyTransfer(moved, undefined, { saved: deserialize(bytes) }), /load and place it as it was$/);
    const refuses = (wrong: Uint8Array, message: RegExp) =>
      assert.throws(
        () => deserialize(wrong),
        (error) => error instanceof CagecastError && error.code === 'badArgument' && message.test(error.message),
      );
    refuses(new Uint8Array(3), /is nothing that serialize wrote \(3 bytes\)/);
    refuses(bytes.subarray(0, bytes.length - 1), /is damaged or not whole/);
    refuses(
      bytes.map((byte, i) => (i === 5000 ? byte ^ 1 : byte)),
      /is damaged or not whole/,
    );
    // Of the length of its text.
    for (const bit of [1, 128])
      refuses(
        bytes.map((byte, i) => (i === 8 ? byte ^ bit : byte)),
        /is damaged or not whole/,
      );
    refuses(
      bytes.map((byte, i) => (i === 4 ? 9 : byte)),
      /has version 9 of the format; this one reads version 2/,
    );
    refuses('bytes' as unknown as Uint8Array, /bytes is "bytes", not a Uint8Array/);
    assert.throws(() => serialize({} as never), /applied is not what applyTransfer returned/);
    assert.throws(
      () => applyTransfer(meshOf(scene.target), undefined, { saved: {} as never }),
      /options\.saved is an object, not what deserialize returned/,
    );
  });
});

describe('applyTransferAsync', () => {
  test('gives what applyTransfer gives, and its errors', async () => {
    const [first, second] = [meshOf(scene.target), meshOf(scene.target)];
    const options = { texture: new Texture(), borders: 'cut' } as const;
    const applied = applyTransfer(first, meshOf(scene.cage), options);
    const shares: [number, string][] = [];
    const later = await applyTransferAsync(second, meshOf(scene.cage), {
      ...options,
      onProgress: (...share) => shares.push(share),
    });
    for (const name of ['uv1', '_ncz', '_cagecast_paint', 'position'])
      assert.deepEqual(attribute(second.geometry, name), attribute(first.geometry, name));
    assert.deepEqual(later.result.zones, applied.result.zones);
    assert.deepEqual(
      shares.map(([, stage]) => stage),
      ['transfer', 'geometry', 'done'],
    );
    await assert.rejects(applyTransferAsync(new Group(), meshOf(scene.cage)), { code: 'emptyMesh' });
    await assert.rejects(applyTransferAsync(first, meshOf(scene.cage), { texture: 7 as never }), /not a Texture/);
    await assert.rejects(
      applyTransferAsync(meshOf(scene.target), meshOf(scene.cage), { signal: AbortSignal.abort(new Error('no')) }),
      /^Error: no$/,
    );
    terminate();
  });

  test('a geometry that is replaced meanwhile is an error', async () => {
    const target = meshOf(scene.target);
    const work = applyTransferAsync(target, meshOf(scene.cage), { texture: new Texture() });
    target.geometry = geometryOf(scene.target);
    await assert.rejects(work, /was changed meanwhile/);
    terminate();
  });

  for (const [name, during] of Object.entries<ApplyOptions>({
    'splits vertices': { texture: new Texture() },
    'cuts triangles': { borders: 'cut' },
  })) {
    test(`a transfer meanwhile that ${name} makes it an error, and stays as it is`, async () => {
      const [target, other] = [meshOf(scene.target), meshOf(scene.target)];
      const work = applyTransferAsync(target, meshOf(scene.cage), {
        texture: new Texture(),
        onProgress: (_, stage) => stage === 'geometry' && applyTransfer(target, meshOf(scene.cage), during),
      });
      await assert.rejects(work, { code: 'badArgument', message: /was changed meanwhile/ });
      applyTransfer(other, meshOf(scene.cage), during);
      assert.deepEqual(geometries(target), geometries(other));
      terminate();
    });
  }

  for (const borders of ['triangle', 'cut'] as const) {
    test(`models that share a geometry may be painted at the same time (borders: ${borders})`, async () => {
      const options = { texture: new Texture(), borders };
      const [first, alone] = [meshOf(scene.target), meshOf(scene.target)];
      const second = first.clone();
      await Promise.all([first, second].map((target) => applyTransferAsync(target, meshOf(scene.cage), options)));
      applyTransfer(alone, meshOf(scene.cage), options);
      assert.notEqual(first.geometry, second.geometry);
      for (const { geometry } of [first, second])
        for (const [name, array] of Object.entries(geometries(alone)))
          assert.deepEqual(name === 'index' ? geometry.index!.array : attribute(geometry, name), array);
      terminate();
    });
  }

  test('attributes that are added while others are copied make it an error', async () => {
    const target = meshOf(scene.target);
    const { geometry } = target;
    const heat = new BufferAttribute(new Float32Array(geometry.getAttribute('position').count), 1);
    const values = heat.array;
    let isFirst = true;
    Object.defineProperty(heat, 'array', {
      get() {
        if (isFirst) {
          isFirst = false;
          applyTransfer(target, meshOf(scene.cage), { seams: 'vertex', channel: 2 });
        }
        return values;
      },
    });
    geometry.setAttribute('heat', heat);
    const work = applyTransferAsync(target, meshOf(scene.cage), { texture: new Texture() });
    await assert.rejects(work, { code: 'badArgument', message: /was changed meanwhile/ });
    assert.ok(geometry.hasAttribute('uv2') && !geometry.hasAttribute('uv1'));
    for (const one of Object.values(geometry.attributes)) assert.equal(one.count, heat.count);
    terminate();
  });
});

/** Bytes that a call allocates once it is compiled, as the median of several rounds, for garbage may be collected in one. */
function allocatedBy(call: () => void): number {
  const calls = 2000;
  for (let i = 0; i < 100 * calls; ++i) call();
  const rounds = Array.from({ length: 9 }, () => {
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < calls; ++i) call();
    return (process.memoryUsage().heapUsed - before) / calls;
  });
  return rounds.sort((a, b) => a - b)[4]!;
}

const frame = { frame: 0 };
const gl = new Proxy({}, { get: () => () => undefined });
const nothing = (): void => {};
/** Draws nothing. */
const renderer = {
  info: { render: frame },
  domElement: new EventTarget(),
  xr: {},
  properties: { get: () => ({}) },
  state: { bindFramebuffer: nothing, setScissorTest: nothing },
  getContext: () => gl,
  getRenderTarget: () => null,
  getActiveCubeFace: () => 0,
  getActiveMipmapLevel: () => 0,
  setRenderTarget: nothing,
  render: nothing,
} as unknown as WebGLRenderer;

describe('a frame', () => {
  for (const matrixAutoUpdate of [true, false])
    test(`allocates nothing for paint (matrixAutoUpdate: ${matrixAutoUpdate})`, () => {
      const target = meshOf(scene.target);
      const texture = Object.assign(new Texture(), { matrixAutoUpdate });
      texture.offset.set(0.25, 0.5);
      applyTransfer(target, meshOf(scene.cage), { texture });
      const { material } = target;
      const shader = { uniforms: {} as Record<string, { value: Matrix3 }>, vertexShader: '', fragmentShader: '' };
      material.onBeforeCompile(shader as never, undefined as never);
      const draw = () => {
        ++frame.frame;
        (material.onBeforeRender as (renderer: WebGLRenderer) => void)(renderer);
      };
      const bytes = allocatedBy(draw);
      assert.ok(bytes < 16, `${bytes} bytes`);
      const x = () => shader.uniforms['cagecastMatrix']!.value.elements[6];
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

  test('allocates nothing for layers that have not changed', () => {
    const layers = createLayers({ renderer });
    const textures = [1, 2, 3].map(() => new Texture());
    for (const texture of textures) layers.add(texture);
    assert.deepEqual([layers.update(), layers.update()], [true, false]);
    const bytes = allocatedBy(() => layers.update());
    assert.ok(bytes < 16, `${bytes} bytes`);
    for (const texture of textures) {
      texture.needsUpdate = true;
      assert.deepEqual([layers.update(), layers.update()], [true, false]);
    }
    layers.remove(layers.list[0]!);
    assert.deepEqual([layers.update(), layers.update()], [true, false]);
    layers.dispose();
  });
});

describe('layers', () => {
  test('a base layer that undo brings back is the base again, unless there is a newer one', () => {
    const [stack, history] = [new LayerStack(), new History()];
    const edits = new Edits(stack, history);
    const sheet = { texture: new Texture() };
    const setBase = (name: string): void => edits.do(name, () => stack.setBase(name, sheet));
    const removeBase = (): void => edits.do('removing', () => stack.remove(stack.base!.id));
    const state = () => [stack.base?.name, stack.layers.map(({ name }) => name)];
    setBase('first');
    removeBase();
    assert.deepEqual(state(), [undefined, []]);
    setBase('second');
    for (let step = 0; step < 2; step++) history.undo();
    assert.deepEqual(state(), ['first', ['first']]);
    for (let step = 0; step < 2; step++) history.redo();
    assert.deepEqual(state(), ['second', ['second']]);
    for (let step = 0; step < 2; step++) history.undo();
    setBase('third');
    assert.deepEqual(state(), ['third', ['third']]);

    // Of another model, which is no step.
    removeBase();
    stack.setBase('newer', sheet);
    history.undo();
    assert.deepEqual(state(), ['newer', ['newer', 'third']]);
  });

  test('options of layers and painters that are null, and a camera that is none, are reported, and change nothing', () => {
    const layers = createLayers({ renderer });
    const layer = layers.add(new Texture());
    const painter = createPainter({ layers, applied: [], cage: meshOf(scene.cage) });
    const wrong = null as never;
    for (const [call, code, message] of [
      [() => createLayers(wrong), 'badArgument', 'cagecast/three/layers: options.renderer is not a WebGLRenderer'],
      [() => layers.add(new Texture(), wrong), 'badOption', 'cagecast/three/layers: style is null, not an object'],
      [() => layers.set(layer, wrong), 'badOption', 'cagecast/three/layers: style is null, not an object'],
      [
        () => createPainter(wrong),
        'badArgument',
        'cagecast/three/paint: options.applied is not what applyTransfer returned',
      ],
      [() => painter.listen(wrong), 'badArgument', 'cagecast/three/paint: camera is null, not a Camera'],
    ] as const)
      assert.throws(call, { name: 'CagecastError', code, message }, message);
    assert.deepEqual(layers.list, [layer]);
    assert.equal(layers.undo(), 'adding Layer 1');
    layers.dispose();
  });
});
