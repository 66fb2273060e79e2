// What toGlb writes is valid, however odd the numbers in the file are.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { getBounds, NodeIO } from '@gltf-transform/core';
import { toGlb } from 'cagecast/gltf';
import { pngOf } from '../../support/files/costly.js';
import { usdaOf } from '../../support/files/costly-formats.js';
import { validate } from '../../support/gltf.js';
import { fbxNode, fbxOf } from '../../support/models.js';
import { head } from '../scenes.js';

const io = new NodeIO();

/** The GLB of a text, which has no error, as a document. */
async function documentOf(text: string | Uint8Array, beside: Record<string, string | Uint8Array> = {}) {
  const read = async (name: string) => {
    const found = beside[name];
    return found === undefined ? undefined : new Uint8Array(Buffer.from(found as string));
  };
  const glb = await toGlb(new Uint8Array(Buffer.from(text as string)), { read });
  assert.deepEqual(await validate(glb), []);
  return (await io.readBinary(glb)).getRoot();
}

const plyOf = (properties: string, vertices: readonly string[], faces: readonly string[]): string =>
  `ply\nformat ascii 1.0\nelement vertex ${vertices.length}\n${properties}\nelement face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n${[...vertices, ...faces].join('\n')}\n`;
const kPlace = 'property float x\nproperty float y\nproperty float z';
const kCorners = ['0 0 0', '1 0 0', '0 1 0', '0 0 1'];

test('triangles whose corners are not there, or nowhere, are left out, and their vertices', async () => {
  for (const bad of ['3 0 1 9', '3 0 1 -1', '3 0 1 70000', '3 4 1 2']) {
    const root = await documentOf(plyOf(kPlace, [...kCorners, 'nan 0 0'], ['3 0 1 2', bad]));
    const [primitive] = root.listMeshes()[0]!.listPrimitives();
    assert.deepEqual([...primitive!.getIndices()!.getArray()!], [0, 1, 2], bad);
    assert.equal(primitive!.getAttribute('POSITION')!.getCount(), 3);
  }
  for (const place of ['nan 0 0', 'inf 0 0', '1e300 0 0'])
    for (const text of [
      plyOf(kPlace, [place, '1 0 0', '0 1 0'], ['3 0 1 2']),
      `v 0 0 1\nv ${place}\nv 1 0 0\nv 0 1 0\nf 2 3 4\n`,
      `solid a\nfacet normal 0 0 1\nouter loop\nvertex ${place}\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n`,
    ])
      await assert.rejects(toGlb(Buffer.from(text)), /file without any triangle/, text);
  await assert.rejects(toGlb(Buffer.from('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 7 8 9\n')), /OBJ file without any triangle/);
});

/** The sum of the areas of all triangles in the plane z = 0, and of their UVs: more than the polygon's where they overlap. */
async function areasOf(file: string | Uint8Array): Promise<[triangles: number, area: number, ofUvs: number]> {
  const [primitive] = (await documentOf(file)).listMeshes()[0]!.listPrimitives();
  const indices = [...primitive!.getIndices()!.getArray()!];
  const [places, uvs] = ['POSITION', 'TEXCOORD_0'].map((name) => primitive!.getAttribute(name));
  const areaIn = (points: typeof places): number =>
    indices.reduce((sum, _, c) => {
      if (c % 3 !== 0 || !points) return sum;
      const [a, b, d] = [0, 1, 2].map((k) => points.getElement(indices[c + k]!, [] as number[])) as [
        number[],
        number[],
        number[],
      ];
      return sum + Math.abs((b[0]! - a[0]!) * (d[1]! - a[1]!) - (b[1]! - a[1]!) * (d[0]! - a[0]!)) / 2;
    }, 0);
  return [indices.length / 3, areaIn(places), areaIn(uvs)];
}

test('faces of PLY and OBJ may have any number of corners, be concave, and have UVs at their corners', async () => {
  // An arrow: a fan from its first corner would cover what is outside.
  const arrow = ['2 1 0', '0 2 0', '0 3 0', '-1 1.5 0', '0 0 0', '0 1 0'];
  const uvs = ['1 0', '.5 1', '0 1', '0 .5', '0 0', '.5 0'];
  const text = (faces: string[], more = '') =>
    plyOf(kPlace, [...arrow, '5 0 0', '6 0 0', '5 1 0'], faces).replace('end_header', `${more}end_header`);
  const outline = arrow.map((place) => place.split(' ').map(Number) as [number, number]);
  const areaOf = (points: readonly [number, number][]): number =>
    points.reduce((sum, [x, y], i) => {
      const [nextX, nextY] = points[(i + 1) % points.length]!;
      return sum + (x * nextY - y * nextX) / 2;
    }, 0);
  const [triangles, area] = await areasOf(text(['6 0 1 2 3 4 5', '3 6 7 8']));
  assert.deepEqual([triangles, area.toFixed(6)], [5, (areaOf(outline) + 0.5).toFixed(6)]);
  const withUvs = text(
    [`6 0 1 2 3 4 5 12 ${uvs.join(' ')}`, '3 6 7 8 6 0 0 1 0 0 1'],
    'property list uchar float texcoord\n',
  );
  const ofUvs = areaOf(uvs.map((uv) => uv.split(' ').map(Number) as [number, number]));
  assert.deepEqual(
    (await areasOf(withUvs)).map((x) => x.toFixed(5)),
    [5, areaOf(outline) + 0.5, ofUvs + 0.5].map((x) => x.toFixed(5)),
  );
  await assert.rejects(documentOf(text(['3 0 1 2', '7 0 1 2 3'])), /ends within face 2 of 2/);
  const lines = (first: number) => [
    ...arrow.map((place) => `v ${place}`),
    ...uvs.map((uv) => `vt ${uv}`),
    `f ${uvs.map((_, k) => `${k + first}/${k + first}`).join(' ')}`,
  ];
  // By places from the end, too, with a line that goes on below, and a quad that is not convex.
  for (const obj of [lines(1), lines(-6), ['v 9 9 9', ...lines(-6)]])
    assert.deepEqual(
      (await areasOf(`${obj.join('\n').replace(/ (\S+)$/, ' \\\n $1')}\n`)).map((x) => x.toFixed(5)),
      [4, areaOf(outline), ofUvs].map((x) => x.toFixed(5)),
    );
  assert.equal((await areasOf('v 1 0 0\nv 0 3 0\nv -1 0 0\nv 0 1 0\nf 1 2 3 4\n'))[1].toFixed(5), '2.00000');
  const binary = (isLittle: boolean, lineEnd: string): Uint8Array => {
    const header = text(['x'], 'property uchar red\nproperty uchar green\nproperty uchar blue\n')
      .replace('ascii', isLittle ? 'binary_little_endian' : 'binary_big_endian')
      .replace(/end_header[\s\S]*/, 'end_header\n');
    const view = new DataView(new ArrayBuffer(9 * 12 + 1 + 6 * 4 + 3));
    const places = [...outline, [5, 0], [6, 0], [5, 1]] as const;
    places.forEach(([x, y], v) => {
      view.setFloat32(12 * v, x, isLittle);
      view.setFloat32(12 * v + 4, y, isLittle);
    });
    view.setUint8(108, 6);
    for (let k = 0; k < 6; ++k) view.setInt32(109 + 4 * k, k, isLittle);
    view.setUint8(133, 255);
    return Buffer.concat([Buffer.from(header.replaceAll('\n', lineEnd)), new Uint8Array(view.buffer)]);
  };
  for (const [isLittle, lineEnd] of [
    [true, '\n'],
    [false, '\r\n'],
  ] as const) {
    const file = binary(isLittle, lineEnd);
    const [count, size] = await areasOf(file);
    assert.deepEqual([count, size.toFixed(6)], [4, areaOf(outline).toFixed(6)]);
    const [primitive] = (await documentOf(file)).listMeshes()[0]!.listPrimitives();
    assert.deepEqual(primitive!.getAttribute('COLOR_0')!.getElement(0, []).slice(0, 3), [1, 0, 0]);
  }
});

test('normals, UVs and colours that are no numbers get their defaults, others are brought into range', async () => {
  const properties = `${kPlace}\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\nproperty float red\nproperty float green\nproperty float blue`;
  const odd = ['nan', '1e300', '-5', '0', '1e-44'];
  const vertices = odd.map((x, i) => `${kCorners[i % 4]} ${`${x} `.repeat(8)}`);
  const root = await documentOf(plyOf(properties, vertices, ['3 0 1 2', '3 2 3 4']));
  const [primitive] = root.listMeshes()[0]!.listPrimitives();
  for (const semantic of ['NORMAL', 'TEXCOORD_0', 'COLOR_0'])
    assert.ok([...primitive!.getAttribute(semantic)!.getArray()!].every(Number.isFinite), semantic);
  assert.deepEqual(primitive!.getAttribute('NORMAL')!.getElement(0, []), [0, 0, 1]);
});

test('an FBX that says its unit becomes metres', async () => {
  const { cage } = head(1, 8);
  const heightOf = async (text: string) => {
    const [scene] = (await documentOf(text)).listScenes();
    const { min, max } = getBounds(scene!);
    return max[1] - min[1];
  };
  const without = fbxOf(cage as Parameters<typeof fbxOf>[0]);
  const height = await heightOf(without);
  const unit = (centimetres: string) =>
    heightOf(
      without.replace(
        /^Objects/m,
        `${fbxNode('GlobalSettings: ', fbxNode('Properties70: ', `P: "UnitScaleFactor", "double", "Number", "",${centimetres}`))}\nObjects`,
      ),
    );
  for (const [centimetres, metres] of [
    ['1', 0.01],
    ['100', 1],
    ['2.54', 0.0254],
    ['0', 1],
    ['-1', 1],
  ] as const)
    assert.equal(((await unit(centimetres)) / height).toFixed(6), metres.toFixed(6), centimetres);
});

test('an OBJ may name several libraries in a line, with blanks and quotes; if all is clear, nothing is', async () => {
  const beside = {
    'my skin.mtl': 'newmtl skin\nKd 1 0 0\nd 0\n',
    'b.mtl': 'newmtl hair\nKd 0 1 0\nTr 1\n',
  };
  const faces = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl skin\nf 1 2 3\nusemtl hair\nf 1 3 2\n';
  const alphas = async (text: string, others: Record<string, string> = {}) =>
    (await documentOf(text, { ...beside, ...others })).listMaterials().map((one) => [one.getName(), one.getAlpha()]);
  for (const line of ['mtllib my skin.mtl b.mtl', 'mtllib "my skin.mtl" "b.mtl"', 'mtllib my skin.mtl\nmtllib ./b.mtl'])
    assert.deepEqual((await alphas(`${line}\n${faces}`)).sort(), [
      ['hair', 1],
      ['skin', 1],
    ]);
  const half = { 'b.mtl': 'newmtl hair\nKd 0 1 0\n' };
  assert.deepEqual((await alphas(`mtllib my skin.mtl b.mtl\n${faces}`, half)).sort(), [
    ['hair', 1],
    ['skin', 0],
  ]);
});

test('factors of materials', async () => {
  const obj = (name: string) => `mtllib a.mtl\nusemtl ${name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n`;
  for (const value of ['nan', '-3', '7', 'inf', '', '1e999']) {
    const lines = ['Kd', 'Ke', 'Ks', 'Ns', 'd', 'Tr'].map((key) => `${key} ${value} ${value} ${value}`);
    const map = `map_Kd -s ${value} ${value} -o ${value} ${value} a.png\nmap_Bump -bm ${value} a.png`;
    const root = await documentOf(obj('x'), {
      'a.mtl': `newmtl x\n${lines.join('\n')}\n${map}\n`,
      'a.png': pngOf(4, 4),
    });
    const [material] = root.listMaterials();
    for (const factor of [...material!.getBaseColorFactor(), ...material!.getEmissiveFactor()])
      assert.ok(factor >= 0 && factor <= 1, `${value}: ${factor}`);
  }
});

test('a mesh without UVs has no texture, beside one that has both', async () => {
  const obj = 'mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\no a\nusemtl x\nf 1 2 3\no b\nusemtl x\nf 1/1 2/1 3/1\n';
  const root = await documentOf(obj, { 'a.mtl': 'newmtl x\nKd 1 0 0\nmap_Kd a.png\n', 'a.png': pngOf(4, 4) });
  const looks = root.listMeshes().map((mesh) => mesh.listPrimitives()[0]!.getMaterial()!);
  assert.deepEqual(
    looks.map((material) => [material.getName(), material.getBaseColorTexture() !== null]),
    [
      ['x', false],
      ['x', true],
    ],
  );
});

test('triangles that go to and fro between two materials are two primitives, each with its own vertices', async () => {
  const columns = Array.from({ length: 20 }, (_, x) => x);
  const obj = [
    'mtllib a.mtl',
    ...columns.map((x) => `v ${x} 0 0\nv ${x} 1 0\nv ${x + 0.5} 0 0`),
    ...columns.map((x) => `usemtl ${x % 2 ? 'odd' : 'even'}\nf ${3 * x + 1} ${3 * x + 3} ${3 * x + 2}`),
  ].join('\n');
  const root = await documentOf(obj, { 'a.mtl': 'newmtl even\nKd 1 0 0\nnewmtl odd\nKd 0 1 0\n' });
  const places = root
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives())
    .map((primitive) => {
      const position = primitive.getAttribute('POSITION')!;
      const firsts = Array.from(primitive.getIndices()!.getArray() as Uint32Array).filter(
        (_, corner) => corner % 3 === 0,
      );
      return {
        material: primitive.getMaterial()!.getName(),
        vertices: position.getCount(),
        columns: firsts.map((vertex) => position.getElement(vertex, [])[0]),
      };
    });
  assert.deepEqual(places, [
    { material: 'even', vertices: 30, columns: columns.filter((x) => x % 2 === 0) },
    { material: 'odd', vertices: 30, columns: columns.filter((x) => x % 2 === 1) },
  ]);
});

test('images that are cut off, or without a header, are missing', async () => {
  const obj = Buffer.from('mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n');
  const whole = pngOf(4, 4);
  const other = (at: number) => Buffer.concat([whole.subarray(0, at), Buffer.alloc(4), whole.subarray(at + 4)]);
  for (const image of [whole.subarray(0, 40), other(8), other(12)]) {
    const missing: string[][] = [];
    const read = async (name: string) => (name === 'a.mtl' ? Buffer.from('newmtl x\nmap_Kd a.png\n') : image);
    assert.deepEqual(await validate(await toGlb(obj, { read, onMissing: (...one) => missing.push(one) })), []);
    assert.deepEqual(missing, [['a.png', 'it is damaged']]);
  }
});

test('a file is refused whose images decode to more than the limit', async () => {
  const obj = Buffer.from('mtllib a.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n');
  const huge = Buffer.from(pngOf(4, 4));
  huge.writeUInt32BE(30_000, 16);
  huge.writeUInt32BE(30_000, 20);
  const read = async (name: string) => (name === 'a.mtl' ? Buffer.from('newmtl x\nmap_Kd a.png\n') : huge);
  await assert.rejects(toGlb(obj, { read }), /images\[0\] has 30,000 × 30,000 pixels.*the limit "expansion" is 100/);
});

test('places of nodes, and skins', async () => {
  const mesh =
    'def Mesh "mesh" {\npoint3f[] points = [(0,0,0), (1,0,0), (0,1,0)]\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,2]\n}';
  for (const value of ['nan', 'inf', '1e999', '-1e39', 'x']) {
    const numbers = Array(3).fill(value).join(',');
    const places = `double3 xformOp:translate = (${numbers})\nfloat3 xformOp:scale = (${numbers})\nfloat3 xformOp:rotateXYZ = (${numbers})\nuniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateXYZ", "xformOp:scale"]`;
    await documentOf(usdaOf(`def Xform "all" {\n${places}\n${mesh}\n}`));
  }
  const list = (name: string, values: readonly (number | string)[]) =>
    fbxNode(`${name}: *${values.length}`, `a: ${values.join(',')}`);
  for (const odd of ['nan', '1e400', '-1']) {
    const matrix = list('Transform', Array(16).fill(odd));
    const root = await documentOf(
      [
        '; FBX 7.4.0 project file',
        fbxNode('FBXHeaderExtension: ', 'FBXVersion: 7400'),
        fbxNode(
          'Objects: ',
          fbxNode(
            'Geometry: 10, "Geometry::head", "Mesh"',
            list('Vertices', [0, 0, 0, 1, 0, 0, 0, 1, 0]),
            list('PolygonVertexIndex', [0, 1, -3]),
          ),
          fbxNode('Model: 20, "Model::head", "Mesh"', 'Version: 232'),
          fbxNode(
            'Model: 40, "Model::neck", "LimbNode"',
            fbxNode('Properties70: ', `P: "Lcl Translation", "Lcl Translation", "", "A",${odd},${odd},0`),
          ),
          fbxNode('Deformer: 30, "Deformer::", "Skin"', 'Version: 101'),
          fbxNode(
            'Deformer: 31, "SubDeformer::", "Cluster"',
            list('Indexes', [0, 0, 1, 2]),
            list('Weights', [0.25, 0.5, odd, 1]),
            matrix,
            list('TransformLink', Array(16).fill(odd)),
          ),
          fbxNode('Deformer: 50, "Deformer::", "BlendShape"', 'Version: 100'),
          fbxNode(
            'Deformer: 51, "SubDeformer::smile", "BlendShapeChannel"',
            `DeformPercent: ${odd}`,
            list('FullWeights', [odd]),
          ),
          fbxNode('Geometry: 52, "Geometry::smile", "Shape"', list('Indexes', [1]), list('Vertices', [odd, 0, 0])),
        ),
        fbxNode(
          'Connections: ',
          ...['20,0', '40,0', '10,20', '30,10', '31,30', '40,31', '50,10', '51,50', '52,51'].map(
            (one) => `C: "OO",${one}`,
          ),
        ),
        '',
      ].join('\n'),
    );
    // A joint that is named twice counts once.
    const [primitive] = root.listMeshes()[0]!.listPrimitives();
    assert.deepEqual(primitive!.getAttribute('WEIGHTS_0')!.getElement(0, []), [1, 0, 0, 0]);
  }
});
