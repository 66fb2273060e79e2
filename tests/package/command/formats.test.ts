// Models of other formats: the same triangles are painted as of the same model in a GLB.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import type { Mesh as Arrays, CagecastError } from 'cagecast';
import { toGlb } from 'cagecast/gltf';
import { BufferAttribute, BufferGeometry, Group, Mesh, MeshStandardMaterial } from 'three';
import { OBJExporter } from 'three/addons/exporters/OBJExporter.js';
import { PLYExporter } from 'three/addons/exporters/PLYExporter.js';
import { STLExporter } from 'three/addons/exporters/STLExporter.js';
import { USDZExporter } from 'three/addons/exporters/USDZExporter.js';
import { fails, ok } from '../../support/command.js';
import { isOverlay, primitivesOf, unpackGlb, validate } from '../../support/gltf.js';
import { fbxNode, fbxOf, flipped } from '../../support/models.js';
import { io, png, workplace, write } from './workplace.js';

const { cage, target } = workplace('formats');

/** A scene of three.js. @param isUpright  Whether images have their first row at v = 0, as of glTF; else at v = 1. */
function sceneOf({ positions, indices, uvs }: Arrays, isUpright = false): Group {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  if (uvs) geometry.setAttribute('uv', new BufferAttribute(isUpright ? uvs : flipped(uvs), 2));
  geometry.computeVertexNormals();
  const mesh = new Mesh(geometry, new MeshStandardMaterial({ name: 'skin' }));
  mesh.name = 'head';
  return new Group().add(mesh);
}

/** A file of each format, and whether it has UVs. */
const makers: Record<string, (mesh: Arrays) => Promise<Uint8Array | string>> = {
  obj: async (mesh) => new OBJExporter().parse(sceneOf(mesh)),
  fbx: async (mesh) => fbxOf(mesh),
  // It turns the UVs of glTF.
  usdz: (mesh) => new USDZExporter().parseAsync(sceneOf(mesh, true)),
  ply: async (mesh) => new PLYExporter().parse(sceneOf(mesh), null as never, {})!,
  'binary.ply': async (mesh) =>
    new Uint8Array(new PLYExporter().parse(sceneOf(mesh), null as never, { binary: true, littleEndian: true })!),
  stl: async (mesh) => new STLExporter().parse(sceneOf(mesh)),
  'binary.stl': async (mesh) => {
    const { buffer, byteOffset, byteLength } = new STLExporter().parse(sceneOf(mesh), { binary: true });
    return new Uint8Array(buffer as ArrayBuffer, byteOffset, byteLength);
  },
};

/** The centres of the triangles of a file's overlays. */
async function painted(name: string): Promise<string[]> {
  const document = await io.read(name);
  return primitivesOf(document)
    .filter(isOverlay)
    .flatMap((primitive) => {
      const positions = primitive.getAttribute('POSITION')!;
      const corners = [...primitive.getIndices()!.getArray()!].map((v) => positions.getElement(v, []));
      return Array.from({ length: corners.length / 3 }, (_, t) =>
        [0, 1, 2].map((k) => ([0, 1, 2].reduce((sum, c) => sum + corners[3 * t + c]![k]!, 0) / 3).toFixed(3)).join(),
      );
    })
    .map((centre) => centre.replaceAll('-0.000', '0.000'))
    .sort();
}

/** The UVs that a file got. */
const uvsOf = async (name: string): Promise<number[]> => [
  ...primitivesOf(await io.read(name))[0]!
    .getAttribute('TEXCOORD_1')!
    .getArray()!,
];

for (const [format, make] of Object.entries(makers))
  test(`${format}: as a target, and as a cage if the format has UVs, it paints what its GLB does`, async () => {
    write(`target.${format}`, await make(target));
    write(`cage.${format}`, await make(cage));
    await ok('transfer target.glb --cage cage.glb --texture paint.png -o expected.glb');
    const expected = await painted('expected.glb');
    assert.ok(expected.length > 50);
    await ok(`transfer target.${format} --cage cage.glb --texture paint.png -o as-target.glb`);
    assert.deepEqual(await painted('as-target.glb'), expected);
    assert.deepEqual(await validate('as-target.glb'), []);
    if (format.includes('stl')) {
      await fails(1, /^cagecast: cage\..*stl: meshes\[0\].*no TEXCOORD_0/, `transfer target.glb --cage cage.${format}`);
      return;
    }
    await ok(`transfer target.glb --cage cage.${format} --texture paint.png -o as-cage.glb`);
    assert.deepEqual(await painted('as-cage.glb'), expected);
    const [own, others] = await Promise.all(['expected.glb', 'as-cage.glb'].map(uvsOf));
    own!.forEach((x, i) => assert.ok(Math.abs(x - others![i]!) <= 8, `UV ${i}: ${x}, ${others![i]}`));
  });

test('an OBJ has the materials of its MTL, with the bytes of the images beside it, and goes without what is not there', async () => {
  const obj = new OBJExporter().parse(sceneOf(target));
  const image = png(90);
  write('skin.png', image);
  write('painted.mtl', 'newmtl skin\nKd 1 1 1\nmap_Kd C:\\models\\skin.png\n');
  write('painted.obj', `mtllib painted.mtl\n${obj}`);
  await ok('transfer painted.obj --cage cage.glb -o painted.glb');
  const { json, bin } = unpackGlb(readFileSync('painted.glb'));
  const { byteOffset = 0, byteLength } = json.bufferViews![json.images![0]!.bufferView!]!;
  assert.deepEqual(Buffer.from(bin.subarray(byteOffset, byteOffset + byteLength)), image);
  assert.equal(json.materials![0]!.name, 'skin');
  write('bare.obj', `mtllib none.mtl\n${obj}`);
  assert.match(await ok('transfer bare.obj --cage cage.glb -o bare.glb'), /\nmissing: "none\.mtl": it was not found\n/);
  assert.equal(unpackGlb(readFileSync('bare.glb')).json.images, undefined);
  write('lost.mtl', 'newmtl skin\nKd 1 1 1\nmap_Kd C:\\models\\lost.png\nmap_Bump skin.tga\n');
  write('skin.tga', new Uint8Array(30));
  write('lost.obj', `mtllib lost.mtl\n${obj}`);
  const said = 'missing: "C:/models/lost.png": it was not found, "skin.tga": it is no PNG, JPEG or WebP image\n';
  for (const command of ['transfer lost.obj --cage cage.glb -o lost.glb', 'thumbnail lost.obj -o lost.png'])
    assert.ok((await ok(command)).includes(`\n${said}`), command);
  assert.equal(unpackGlb(readFileSync('lost.glb')).json.images, undefined);
  const missing: string[][] = [];
  await toGlb(readFileSync('lost.obj'), { onMissing: (...one) => void missing.push(one) });
  assert.deepEqual(missing, [['lost.mtl', 'it was not found']]);
});

test('an MTL is read as programs write it', async () => {
  const obj = `mtllib said.mtl\n${['a', 'b', 'c', 'd'].map((name) => `o ${name}\nusemtl ${name}\nf 1/1 2/2 3/3\n`).join('')}`;
  const vertices = 'v +0.0 0 0\nv +1.0 0 0\nv 0 +1e0 0\nvt 0 0\nvt 1 0\nvt 0 1\n';
  const mtl = `newmtl a
\tmap_Kd\t-blendu on -clamp off -mm 0 1 -s 1 1 "my  skin.png"
newmtl b
Tr 1.0
d 1.0
newmtl c
map_Kd -s 2 2 skin.png
newmtl d
d 0.5
map_Kd -o 0.5 0 0 -texres 512 -type sphere skin.png
`;
  const asked: string[] = [];
  const files: Record<string, Uint8Array> = { 'said.mtl': Buffer.from(mtl), 'skin.png': png(9), 'my skin.png': png(9) };
  const glb = await toGlb(Buffer.from(vertices + obj), {
    read: async (name) => {
      asked.push(name);
      return files[name];
    },
  });
  assert.deepEqual([...new Set(asked)].sort(), ['my skin.png', 'said.mtl', 'skin.png']);
  const { json } = unpackGlb(glb);
  const of = (name: string) => json.materials!.find((one) => one.name === name)!;
  assert.ok(of('a').pbrMetallicRoughness!.baseColorTexture && of('c').pbrMetallicRoughness!.baseColorTexture);
  assert.deepEqual([of('b').alphaMode, of('d').alphaMode], [undefined, 'BLEND']);
  assert.deepEqual(json.accessors!.find(({ max }) => max)!.max, [1, 1, 0]);
});

/** A USD of one triangle. @param lines  More of its mesh. */
const usd = (...lines: string[]) => `#usda 1.0
def Mesh "head"
{
  int[] faceVertexCounts = [3]
  int[] faceVertexIndices = [0, 1, 2]
  point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
${lines.map((line) => `  ${line}\n`).join('')}}
`;
const vectors = (points: readonly (readonly number[])[]) =>
  `[${points.map((point) => `(${point.join(', ')})`).join(', ')}]`;

test('a USD whose triangles are clockwise is turned, and its UVs are the set st', async () => {
  const [own, light] = [
    vectors([
      [0, 0],
      [1, 0],
      [0, 1],
    ]),
    vectors([
      [0.5, 0.5],
      [0.6, 0.5],
      [0.5, 0.6],
    ]),
  ];
  const set = (name: string, values: string) =>
    `texCoord2f[] primvars:${name} = ${values} (\n    interpolation = "vertex"\n  )`;
  const read = async (...lines: string[]) => {
    const [primitive] = primitivesOf(await io.readBinary(await toGlb(Buffer.from(usd(...lines)))));
    const [positions, uvs] = ['POSITION', 'TEXCOORD_0'].map((one) => primitive!.getAttribute(one)!);
    return [...primitive!.getIndices()!.getArray()!].map((v) =>
      [...positions!.getElement(v, []).slice(0, 2), ...uvs!.getElement(v, [])].map((x: number) => +x.toFixed(3)),
    );
  };
  const right = await read(set('st1', light), set('st', own));
  assert.deepEqual(right, [
    [0, 0, 0, 1],
    [1, 0, 1, 1],
    [0, 1, 0, 0],
  ]);
  const left = await read('uniform token orientation = "leftHanded"', set('st1', light), set('st', own));
  assert.deepEqual(left, [right[0], right[2], right[1]]);
});

test('names in two Unicode forms are the name of one file', async () => {
  const [composed, parted] = ['h\u00e4ut', 'ha\u0308ut'];
  write(`${parted}.png`, png(9));
  write(`${composed}.mtl`, `newmtl skin\nmap_Kd ${composed}.png\n`);
  write('forms.obj', `mtllib ${parted}.mtl\n${new OBJExporter().parse(sceneOf(target))}`);
  assert.doesNotMatch(await ok('transfer forms.obj --cage cage.glb -o forms.glb'), /missing/);
});

test('what a USD does not draw is left out by name', async () => {
  const lines = (name: string, ...more: string[]) =>
    usd(...more)
      .replace(/^#usda.*\n/, '')
      .replace('head', name);
  const hidden = ['visibility = "invisible"', 'purpose = "guide"', 'purpose = "proxy"'];
  const others = hidden.map((line, i) =>
    lines(`off${i}`, line.replace(/^(visibility)/, 'token $1').replace(/^(purpose)/, 'uniform token $1')),
  );
  const above = `def Xform "stand"\n{\n  uniform token purpose = "proxy"\n${lines('below')}}\n`;
  write('hidden.usda', `#usda 1.0\n${lines('head')}${others.join('')}${above}`);
  const out = await ok('transfer hidden.usda --cage cage.glb -o hidden.glb');
  assert.match(out, /left out.*off0.*off1.*off2.*below/s);
});

test('skins and morph targets of an FBX are kept, by their names', async () => {
  const list = (name: string, values: readonly number[]) =>
    fbxNode(`${name}: *${values.length}`, `a: ${values.join(',')}`);
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const bound = [...identity.slice(0, 12), 0, 2, 0, 1]; // the bone is at y = 2
  const at = (y: number) => `P: "Lcl Translation", "Lcl Translation", "", "A",0,${y},0`;
  const fbx = [
    '; FBX 7.4.0 project file',
    fbxNode('FBXHeaderExtension: ', 'FBXHeaderVersion: 1003', 'FBXVersion: 7400'),
    fbxNode(
      'Objects: ',
      fbxNode(
        'Geometry: 10, "Geometry::head", "Mesh"',
        list('Vertices', [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]),
        list('PolygonVertexIndex', [0, 2, -2, 0, 1, -4, 0, 3, -3, 1, 2, -4]),
      ),
      fbxNode('Model: 20, "Model::head", "Mesh"', 'Version: 232'),
      fbxNode('Model: 40, "Model::neck", "LimbNode"', 'Version: 232', fbxNode('Properties70: ', at(2))),
      fbxNode('Deformer: 30, "Deformer::", "Skin"', 'Version: 101'),
      fbxNode(
        'Deformer: 31, "SubDeformer::", "Cluster"',
        list('Indexes', [0, 1, 2, 3]),
        list('Weights', [1, 1, 1, 1]),
        list('Transform', identity),
        list('TransformLink', bound),
      ),
      fbxNode('Deformer: 50, "Deformer::", "BlendShape"', 'Version: 100'),
      fbxNode(
        'Deformer: 51, "SubDeformer::smile", "BlendShapeChannel"',
        'DeformPercent: 0',
        list('FullWeights', [100]),
      ),
      fbxNode('Geometry: 52, "Geometry::smile", "Shape"', list('Indexes', [1]), list('Vertices', [0.5, 0, 0])),
    ),
    fbxNode(
      'Connections: ',
      ...['20,0', '40,0', '10,20', '30,10', '31,30', '40,31', '50,10', '51,50', '52,51'].map((one) => `C: "OO",${one}`),
    ),
    '',
  ].join('\n');
  const glb = await toGlb(new TextEncoder().encode(fbx));
  assert.deepEqual(await validate(glb), []);
  const root = (await io.readBinary(glb)).getRoot();
  const [primitive] = root.listMeshes()[0]!.listPrimitives();
  const [skin] = root.listSkins();
  assert.deepEqual(
    skin!.listJoints().map((joint) => joint.getName()),
    ['neck'],
  );
  assert.deepEqual(skin!.getInverseBindMatrices()!.getElement(0, []).slice(12), [0, -2, 0, 1]);
  assert.equal(primitive!.getAttribute('POSITION')!.getCount(), 4); // as many as are different
  assert.deepEqual(root.listMeshes()[0]!.getExtras(), { targetNames: ['smile'] });
  const [target] = primitive!.listTargets();
  const moved = [...target!.getAttribute('POSITION')!.getArray()!].filter((x) => x !== 0);
  assert.deepEqual(moved, [0.5]);
  assert.equal(
    root
      .listNodes()
      .find((node) => node.getSkin())!
      .getName(),
    'head',
  );
});

test('what is no model is named as what it is, with what to do', async () => {
  const files: [name: string, text: string | Uint8Array, message: RegExp][] = [
    [
      'pointer.glb',
      'version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n',
      /a pointer of Git LFS.*git lfs pull/,
    ],
    ['page.glb', '<!DOCTYPE html><title>404</title>', /is a web page; what was meant did not download/],
    ['scene.blend', 'BLENDER-v300', /is a Blender file; open it in Blender and choose File, Export, glTF 2\.0/],
    ['models.zip', new Uint8Array([0x50, 0x4b, 3, 4, ...new Array(40).fill(0)]), /is a ZIP archive; unpack it/],
    ['head.dae', '<?xml version="1.0"?><COLLADA>', /is a Collada file; import it into Blender/],
    ['paint.glb', png(1), /is an image; a model is needed here/],
    ['broken.fbx', '; FBX 6.1.0 project file\nFBXVersion: 6100\n', /is an FBX file, but cannot be read \(.*6100/],
    [
      'points.ply',
      'ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n',
      /is a PLY file without any triangle/,
    ],
    ['nothing.glb', 'nothing', /is neither a GLB or glTF file nor one of FBX/],
  ];
  for (const [name, text, message] of files) {
    write(name, text);
    await fails(1, new RegExp(`^cagecast: ${name}: .*${message.source}`), `transfer ${name} --cage cage.glb`);
  }
});

test('toGlb says what cannot be converted', async () => {
  await assert.rejects(toGlb(new Uint8Array(png(1))), (error: CagecastError) => {
    assert.deepEqual([error.code, error.argument], ['badArgument', 'bytes']);
    assert.match(error.message, /^toGlb: is an image; /);
    return true;
  });
  await assert.rejects(toGlb('x' as never), /toGlb: bytes is "x", not a Uint8Array/);
});
