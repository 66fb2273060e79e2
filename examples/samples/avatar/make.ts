// Makes the sample `avatar`: a figure that moves, and its cage. The figure is the model `human-body` with the head of `human`.
//
//   node --import tsx examples/samples/avatar/make.ts

import { writeFile } from 'node:fs/promises';
import { NodeIO, type Primitive, type Texture } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { cageGlb, fitCage, loadTemplate, terminate } from 'cagecast/cages';
import { cageModel } from 'cagecast/gltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { clips } from './clips';
import { atEase, inHead, morphed, morphs, onHead, withJaw } from './face';
import {
  border,
  clip,
  join,
  linear,
  type Mesh,
  mix,
  read,
  reflected,
  smoothstep,
  tidy,
  toLinear,
  type Vec3,
  zip,
} from './mesh';
import { browOf, clothes, dressed, eyeOf, hairOf, isSeen, lashesOf } from './outfit';
import { joints, weigh } from './skeleton';
import { type Part, writeAvatar } from './write';

const kFolder = 'examples/samples';
/** Where head and body end, in metres; a strip closes the gap between them. */
const [kHeadFrom, kBodyTo] = [1.495, 1.479];
/** Positive on the head; the chin is lower than the neck's end. */
const isHead = ([, y, z]: Vec3): number => y - kHeadFrom + 0.3 * Math.max(0, z - 0.045);
const kNeck: Vec3 = [0, 0, -0.02];

const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({ 'meshopt.decoder': MeshoptDecoder });

type Parts = ReadonlyMap<string, Primitive>;
async function partsOf(model: string): Promise<Parts> {
  const document = await io.read(`${kFolder}/${model}/target.glb`);
  const nodes = document.getRoot().listNodes();
  return new Map(nodes.map((node) => [node.getName(), node.getMesh()!.listPrimitives()[0]!]));
}

/** The colours of a texture at the vertices of a part, a little blurred. */
function colorsOf(primitive: Primitive): (vertex: number) => Vec3 {
  const texture = primitive.getMaterial()!.getBaseColorTexture() as Texture;
  const { width, height, data } = PNG.sync.read(Buffer.from(texture.getImage()!));
  const uvs = primitive.getAttribute('TEXCOORD_0')!;
  const kBlur = 2; // texels
  return (vertex) => {
    const [u, v] = uvs.getElement(vertex, []) as [number, number];
    const sum = [0, 0, 0];
    for (let dy = -kBlur; dy <= kBlur; dy++)
      for (let dx = -kBlur; dx <= kBlur; dx++) {
        const [x, y] = [Math.round(u * width) + dx, Math.round(v * height) + dy];
        const texel = 4 * (Math.min(height - 1, Math.max(0, y)) * width + Math.min(width - 1, Math.max(0, x)));
        for (let k = 0; k < 3; k++) sum[k]! += toLinear(data[texel + k]! / 255) / (2 * kBlur + 1) ** 2;
      }
    return sum as unknown as Vec3;
  };
}

/** The whole skin: the head of one model on the body of the other. */
function skinOf(human: Parts, figure: Parts): Mesh {
  const [top, rest] = [human.get('skin')!, figure.get('skin')!];
  const tone = linear('#d09872');
  const head = clip(read(top, onHead, colorsOf(top)), isHead);
  const body = clip(
    read(
      rest,
      (p) => p,
      () => tone,
    ),
    ([, y]) => kBodyTo - y,
  );
  const mesh = join(head, body);
  const open = [...border(mesh).keys()];
  const zipped = zip(
    mesh,
    open.filter((v) => v < head.vertices.length),
    open.filter((v) => v >= head.vertices.length),
    kNeck,
  );
  // The painted hair and brows are pieces of their own here, and the neck's colour fades into the body's.
  const vertices = zipped.vertices.map((vertex) => {
    const p = inHead(vertex.at);
    const fade = Math.max(smoothstep(0.035, 0.055, p[1]), smoothstep(-0.36, -0.48, p[1]));
    return { ...vertex, color: mix(vertex.color, tone, fade) };
  });
  return tidy({ ...zipped, vertices });
}

/** The foremost z of a mesh at x and y, in units of the head. */
function surfaceOf({ vertices, triangles }: Mesh): (x: number, y: number) => number {
  const points = vertices.map(({ at }) => inHead(at));
  return (x, y) => {
    let foremost = -Infinity;
    for (const triangle of triangles) {
      const [a, b, c] = triangle.map((v) => points[v]!) as [Vec3, Vec3, Vec3];
      const area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
      const s = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area;
      const t = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area;
      if (s >= 0 && t >= 0 && s + t <= 1) foremost = Math.max(foremost, a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]));
    }
    return foremost;
  };
}

/** All of it hangs on one joint. */
const onJoint = (mesh: Mesh, name: string): Mesh => ({
  ...mesh,
  vertices: mesh.vertices.map((vertex) => ({ ...vertex, weights: joints.map((joint) => Number(joint.name === name)) })),
});

async function partsOfAvatar(): Promise<Part[]> {
  const [human, figure] = [await partsOf('human'), await partsOf('human-body')];
  const skin = atEase(skinOf(human, figure));
  weigh(skin);
  const inMouth = (name: string, color: string): Mesh => read(human.get(name)!, onHead, () => linear(color));
  const eye = eyeOf();
  const brow = browOf(surfaceOf(skin));
  const lashes = lashesOf();
  const onFace = (mesh: Mesh): Mesh => onJoint(join(mesh, reflected(mesh)), 'head');
  const all = new Map(
    [...morphs].map(([name, move]) => [name, (vertex: Mesh['vertices'][number]) => morphed(vertex, move)]),
  );
  const jaw = new Map([['jawOpen', withJaw]]);
  const still = new Map<string, never>();
  return [
    { name: 'skin', mesh: clip(skin, isSeen), roughness: 0.6, moves: all },
    { name: 'l-eye', mesh: onJoint(eye, 'head'), roughness: 0.15, moves: still },
    { name: 'r-eye', mesh: onJoint(reflected(eye), 'head'), roughness: 0.15, moves: still },
    { name: 'upper-teeth', mesh: onJoint(inMouth('upper-teeth', '#f0eadc'), 'head'), roughness: 0.3, moves: still },
    { name: 'lower-teeth', mesh: onJoint(inMouth('lower-teeth', '#ece5d6'), 'head'), roughness: 0.3, moves: jaw },
    { name: 'tongue', mesh: onJoint(inMouth('tongue', '#b9545b'), 'head'), roughness: 0.5, moves: jaw },
    { name: 'brows', mesh: onFace(brow), roughness: 0.9, moves: all },
    { name: 'lashes', mesh: onFace(lashes), roughness: 0.9, moves: all, isThin: true },
    { name: 'hair', mesh: onJoint(hairOf(skin), 'head'), roughness: 0.75, moves: still },
    ...Object.entries(clothes).map(([name, { color }]) => {
      const mesh = dressed(skin, name);
      const dyed =
        name === 'shoes' ? mesh : { ...mesh, vertices: mesh.vertices.map((v) => ({ ...v, color: linear(color) })) };
      return { name, mesh: dyed, roughness: 0.9, moves: still };
    }),
  ];
}

const parts = await partsOfAvatar();
for (const { name, mesh } of parts) console.log(name, mesh.vertices.length, mesh.triangles.length);
const glb = await writeAvatar(parts, clips());
await writeFile(`${kFolder}/avatar/avatar.glb`, glb);
const model = cageModel(await io.readBinary(glb));
const template = await loadTemplate('human-body');
const { cage, used, missing } = await fitCage(template, model);
terminate();
await writeFile(`${kFolder}/avatar/cage.glb`, cageGlb(cage));
console.log(
  `avatar: ${glb.length} bytes, ${Object.keys(used).length} landmarks, missing ${missing.join(', ') || 'none'}`,
);
