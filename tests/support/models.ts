import { Document, NodeIO } from '@gltf-transform/core';
import { KHRTextureTransform } from '@gltf-transform/extensions';
import type { Mesh as Arrays } from 'cagecast';
import { PNG } from 'pngjs';
import { BoxGeometry, type BufferGeometry, SphereGeometry } from 'three';
import type { Upload } from './site';
import { glb } from './site';

/** The margins around an island, as shares of its cell in the atlas: what it is painted beyond its border, and all of it. */
const kBleed = 0.1;
const kInset = 0.2;
const kCells = { columns: 3, rows: 2 };

/** Where the six sides of a cube lie in the atlas: the left lower corner of each cell. */
const cellOf = (side: number): [number, number] => [
  (side % kCells.columns) / kCells.columns,
  Math.floor(side / kCells.columns) / kCells.rows,
];

/** A cage: a closed cube about the origin, whose six sides are islands of their own in the atlas. */
export async function islandCage(halfSize: number): Promise<Upload> {
  const box = new BoxGeometry(2 * halfSize, 2 * halfSize, 2 * halfSize); // 4 vertices for each side, one after the other
  const uv = box.getAttribute('uv');
  for (let vertex = 0; vertex < uv.count; vertex++) {
    const [u, v] = cellOf(Math.floor(vertex / 4));
    const inset = (value: number): number => kInset + (1 - 2 * kInset) * value;
    uv.setXY(vertex, u + inset(uv.getX(vertex)) / kCells.columns, v + inset(uv.getY(vertex)) / kCells.rows);
  }
  const document = new Document();
  document.createBuffer();
  document.createScene().addChild(document.createNode('cage').setMesh(meshOf(document, box, true)));
  return glb('cage.glb', Buffer.from(await new NodeIO().writeBinary(document)));
}

/** A paint for that cage: green on its islands, violet between them. */
export function islandPaint(): Upload {
  const png = new PNG({ width: 384, height: 256 });
  const near = (share: number, cells: number): boolean => Math.abs(((share * cells) % 1) - 0.5) < 0.5 - kInset + kBleed;
  for (let y = 0; y < png.height; y++) {
    for (let x = 0; x < png.width; x++) {
      const inside = near((x + 0.5) / png.width, kCells.columns) && near((y + 0.5) / png.height, kCells.rows);
      png.data.set(inside ? [0, 192, 64, 255] : [200, 0, 220, 255], 4 * (y * png.width + x));
    }
  }
  return { name: 'islands.png', mimeType: 'image/png', buffer: PNG.sync.write(png) };
}

/** Where the islands of `texturedBox` are painted and where not: in texels of its texture, 1 inside, 0 beyond its margin, −1 between. */
export function islandAt(x: number, y: number, size: number, margin: number): 1 | 0 | -1 {
  const apart = ([share, cells]: readonly [number, number]): number => {
    const place = (share * cells) % 1;
    return (Math.max(kInset - place, place - (1 - kInset)) / cells) * size;
  };
  const beyond = Math.max(
    ...(
      [
        [(x + 0.5) / size, kCells.columns],
        [(y + 0.5) / size, kCells.rows],
      ] as const
    ).map(apart),
  );
  return beyond < -1 ? 1 : beyond > margin ? 0 : -1;
}

/**
 * A closed box about the origin, of half the size 0.8, with a texture of its own, on which each of its sides is an island, as on
 * `islandCage`.
 * @param mirrored Whether its left side shares the island of its right, the other way round.
 * @param moved    Whether its UVs are elsewhere: turned by a quarter, half as large and a texture further; its material brings them back.
 */
export async function texturedBox(
  texture: Buffer,
  { mirrored = false, moved = false, factor = [1, 1, 1, 1] as [number, number, number, number] } = {},
): Promise<Upload> {
  const side = 7 * 7; // vertices
  const box = new BoxGeometry(1.6, 1.6, 1.6, 6, 6, 6);
  const uv = box.getAttribute('uv');
  for (let vertex = 0; vertex < uv.count; vertex++) {
    const left = mirrored && Math.floor(vertex / side) === 1;
    const [u, v] = cellOf(left ? 0 : Math.floor(vertex / side));
    const inset = (value: number): number => kInset + (1 - 2 * kInset) * value;
    uv.setXY(
      vertex,
      u + inset(left ? 1 - uv.getX(vertex) : uv.getX(vertex)) / kCells.columns,
      v + inset(uv.getY(vertex)) / kCells.rows,
    );
  }
  const document = new Document();
  document.createBuffer();
  const mesh = meshOf(document, box, true);
  const image = document.createTexture('own').setMimeType('image/png').setImage(new Uint8Array(texture));
  const material = document
    .createMaterial('own')
    .setBaseColorTexture(image)
    .setBaseColorFactor(factor)
    .setMetallicFactor(0);
  const primitive = mesh.listPrimitives()[0]!.setMaterial(material);
  if (moved) {
    const uvs = primitive.getAttribute('TEXCOORD_0')!;
    for (let vertex = 0; vertex < uvs.getCount(); vertex++) {
      const [u = 0, v = 0] = uvs.getElement(vertex, []);
      uvs.setElement(vertex, [(1.5 - v) / 2, (u + 0.75) / 2]);
    }
    const transforms = document.createExtension(KHRTextureTransform).setRequired(true);
    // A texture further to the right, and one higher.
    const back = transforms
      .createTransform()
      .setOffset([0.25, 0.5])
      .setRotation(Math.PI / 2)
      .setScale([2, 2]);
    material.getBaseColorTextureInfo()!.setExtension('KHR_texture_transform', back);
  }
  document.createScene().addChild(document.createNode('box').setMesh(mesh));
  return glb(
    'target.glb',
    Buffer.from(await new NodeIO().registerExtensions([KHRTextureTransform]).writeBinary(document)),
  );
}

/**
 * A blue ball of radius 0.9, or of `size` times that. With `pose` it is skinned to two joints that pull it apart, and half morphed into a flat one;
 * with `animated` an animation moves one of the joints to and fro, within a second.
 */
export async function ball({ pose = false, animated = false, mirrored = false, size = 1 } = {}): Promise<Upload> {
  const document = new Document();
  const buffer = document.createBuffer();
  const sphere = new SphereGeometry(0.9, 22, 15);
  const mesh = meshOf(document, sphere, false);
  const blue = document
    .createMaterial('blue')
    .setBaseColorFactor([0.02, 0.05, 0.9, 1])
    .setRoughnessFactor(1)
    .setMetallicFactor(0);
  const primitive = mesh.listPrimitives()[0]!.setMaterial(blue);
  const node = document.createNode('ball').setMesh(mesh);
  node.setScale([mirrored ? -size : size, size, size]);
  const scene = document.createScene().addChild(node);
  if (pose || animated) {
    const positions = sphere.getAttribute('position').array as Float32Array;
    const accessor = (type: 'VEC3' | 'VEC4', array: Float32Array | Uint8Array) =>
      document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
    const flat = positions.map((value, at) => (at % 3 === 1 ? -0.8 * value : 0));
    primitive.addTarget(document.createPrimitiveTarget().setAttribute('POSITION', accessor('VEC3', flat)));
    mesh.setWeights([0.5]);
    const count = positions.length / 3;
    const weights = new Float32Array(4 * count);
    for (let vertex = 0; vertex < count; vertex++) {
      const right = Math.min(1, Math.max(0, 0.5 + positions[3 * vertex]!));
      weights.set([1 - right, right, 0, 0], 4 * vertex);
    }
    primitive.setAttribute(
      'JOINTS_0',
      accessor(
        'VEC4',
        Uint8Array.from({ length: 4 * count }, (_, at) => (at % 4 === 1 ? 1 : 0)),
      ),
    );
    primitive.setAttribute('WEIGHTS_0', accessor('VEC4', weights));
    const joints = [-0.7, 0.7].map((x) => document.createNode('joint').setTranslation([x, 0, 0]));
    const skin = document.createSkin();
    const rig = document.createNode('rig');
    scene.addChild(rig);
    for (const joint of joints) {
      skin.addJoint(joint);
      rig.addChild(joint);
    }
    node.setSkin(skin);
    if (animated) {
      const input = document
        .createAccessor()
        .setType('SCALAR')
        .setArray(Float32Array.of(0, 0.5, 1))
        .setBuffer(buffer);
      const output = accessor('VEC3', Float32Array.of(0.7, 0, 0, 0.7, 0.8, 0, 0.7, 0, 0) as Float32Array);
      const sampler = document.createAnimationSampler().setInput(input).setOutput(output);
      const channel = document
        .createAnimationChannel()
        .setTargetNode(joints[1]!)
        .setTargetPath('translation')
        .setSampler(sampler);
      document.createAnimation('wave').addSampler(sampler).addChannel(channel);
    }
  }
  return glb('ball.glb', Buffer.from(await new NodeIO().writeBinary(document)));
}

/**
 * Two blue balls, the smaller one beside the larger, that morph: `grow` makes both larger, `drop` lowers the larger one.
 * Others that `count` asks for are like that, and have no name. With `animated` an animation grows them to and fro, within a second.
 */
export async function morphingBalls({
  names = ['grow', 'drop'] as readonly string[],
  count = 2,
  animated = false,
} = {}): Promise<Upload> {
  const document = new Document();
  const buffer = document.createBuffer();
  const scene = document.createScene();
  const blue = document
    .createMaterial('blue')
    .setBaseColorFactor([0.02, 0.05, 0.9, 1])
    .setRoughnessFactor(1)
    .setMetallicFactor(0);
  const animation = animated ? document.createAnimation('breathe') : undefined;
  for (const [name, radius, x] of [
    ['large', 0.7, -0.1],
    ['small', 0.15, 0.7],
  ] as const) {
    const sphere = new SphereGeometry(radius, 22, 15);
    const mesh = meshOf(document, sphere, false);
    const primitive = mesh.listPrimitives()[0]!.setMaterial(blue);
    const positions = sphere.getAttribute('position').array as Float32Array;
    for (let morph = 0; morph < (name === 'large' ? count : 1); morph++) {
      const deltas = positions.map((value, at) => (morph === 0 ? 0.5 * value : at % 3 === 1 ? -0.3 : 0));
      const accessor = document.createAccessor().setType('VEC3').setArray(deltas).setBuffer(buffer);
      primitive.addTarget(document.createPrimitiveTarget(names[morph]).setAttribute('POSITION', accessor));
    }
    mesh.setWeights(primitive.listTargets().map(() => 0));
    const node = document.createNode(name).setMesh(mesh).setTranslation([x, 0, 0]);
    scene.addChild(node);
    if (!animation) continue;
    const times = document
      .createAccessor()
      .setType('SCALAR')
      .setArray(Float32Array.of(0, 0.5, 1))
      .setBuffer(buffer);
    const weights = document
      .createAccessor()
      .setType('SCALAR')
      .setArray(
        Float32Array.from(
          [0, 1, 0].flatMap((weight) => mesh.getWeights().map((_, morph) => (morph === 0 ? weight : 0))),
        ),
      )
      .setBuffer(buffer);
    const sampler = document.createAnimationSampler().setInput(times).setOutput(weights);
    animation
      .addSampler(sampler)
      .addChannel(document.createAnimationChannel().setTargetNode(node).setTargetPath('weights').setSampler(sampler));
  }
  return glb('target.glb', Buffer.from(await new NodeIO().writeBinary(document)));
}

/** A target of many separate balls, each a node of its own, the later the smaller. */
export async function balls(count: number): Promise<Upload> {
  const document = new Document();
  document.createBuffer();
  const mesh = meshOf(document, new SphereGeometry(0.04, 4, 3), false);
  const scene = document.createScene();
  for (let i = 0; i < count; i++) {
    const place = (digit: number): number => (Math.floor(i / digit) % 6) * 0.3 - 0.75;
    const scale = 1 - (0.5 * i) / count;
    scene.addChild(
      document
        .createNode(`ball ${i}`)
        .setMesh(mesh)
        .setTranslation([place(1), place(6), place(36)])
        .setScale([scale, scale, scale]),
    );
  }
  return glb('balls.glb', Buffer.from(await new NodeIO().writeBinary(document)));
}

/** A lumpy ball of 2 · `side`² triangles, indexed, with normals and UVs of its own. */
export async function lumpyBall(side: number): Promise<Upload> {
  const document = new Document();
  document.createBuffer();
  const sphere = new SphereGeometry(0.9, side, side + 1);
  const position = sphere.getAttribute('position');
  for (let vertex = 0; vertex < position.count; vertex++) {
    const [x, y, z] = [position.getX(vertex), position.getY(vertex), position.getZ(vertex)];
    const lump = 0.92 + 0.08 * Math.sin(9 * x) * Math.sin(7 * y + 1) * Math.sin(8 * z + 2);
    position.setXYZ(vertex, lump * x, lump * y, lump * z);
  }
  document.createScene().addChild(document.createNode('lumps').setMesh(meshOf(document, sphere, true)));
  return glb('lumps.glb', Buffer.from(await new NodeIO().writeBinary(document)));
}

function meshOf(document: Document, geometry: BufferGeometry, withUvs: boolean) {
  const buffer = document.getRoot().listBuffers()[0]!;
  const accessor = (type: 'VEC2' | 'VEC3' | 'SCALAR', array: Float32Array | Uint16Array | Uint32Array) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document
    .createPrimitive()
    .setIndices(accessor('SCALAR', geometry.index!.array as Uint16Array | Uint32Array));
  for (const [name, semantic, type] of [
    ['position', 'POSITION', 'VEC3'],
    ['normal', 'NORMAL', 'VEC3'],
    ['uv', 'TEXCOORD_0', 'VEC2'],
  ] as const) {
    if (name === 'uv' && !withUvs) continue;
    primitive.setAttribute(semantic, accessor(type, Float32Array.from(geometry.getAttribute(name).array)));
  }
  return document.createMesh(primitive.getName()).addPrimitive(primitive);
}

/** UVs for images that have their first row at the other end of v. */
export const flipped = (uvs: Float32Array): Float32Array => uvs.map((x, i) => (i % 2 === 0 ? x : 1 - x));

/** A node of an FBX of text: its line, and what is in it. Its depth is told by tabs. */
export const fbxNode = (line: string, ...inside: string[]): string =>
  `${line} {\n${inside.map((one) => one.replace(/^/gm, '\t')).join('\n')}\n}`;

/** An FBX of text. */
export function fbxOf({ positions, indices, uvs }: Arrays): string {
  const array = (name: string, values: ArrayLike<number>) =>
    fbxNode(`${name}: *${values.length}`, `a: ${Array.from(values).join(',')}`);
  // The last corner of a polygon is the complement of its vertex.
  const corners = Array.from(indices, (v, i) => (i % 3 === 2 ? -v - 1 : v));
  const layer = fbxNode(
    'LayerElementUV: 0',
    'Version: 101',
    'Name: "UVMap"',
    'MappingInformationType: "ByPolygonVertex"',
    'ReferenceInformationType: "IndexToDirect"',
    array('UV', flipped(uvs!)),
    array('UVIndex', indices),
  );
  const geometry = [array('Vertices', positions), array('PolygonVertexIndex', corners), 'GeometryVersion: 124', layer];
  return [
    '; FBX 7.4.0 project file',
    fbxNode('FBXHeaderExtension: ', 'FBXHeaderVersion: 1003', 'FBXVersion: 7400'),
    fbxNode(
      'Objects: ',
      fbxNode('Geometry: 10, "Geometry::head", "Mesh"', ...geometry),
      fbxNode('Model: 20, "Model::head", "Mesh"', 'Version: 232'),
    ),
    fbxNode('Connections: ', 'C: "OO",20,0', 'C: "OO",10,20'),
    '',
  ].join('\n');
}
