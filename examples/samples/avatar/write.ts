import { type Accessor, Document, type Node, NodeIO, type TypedArray } from '@gltf-transform/core';
import { EXTMeshoptCompression, KHRMeshQuantization } from '@gltf-transform/extensions';
import { meshopt } from '@gltf-transform/functions';
import { MeshoptEncoder } from 'meshoptimizer';
import type { Clip } from './clips';
import { length, type Mesh, normalsOf, sub, type Vec3, type Vertex } from './mesh';
import { joints, strongest } from './skeleton';

export interface Part {
  name: string;
  mesh: Mesh;
  roughness: number;
  /** Where each morph of it moves a vertex. */
  moves: ReadonlyMap<string, (vertex: Vertex) => Vec3>;
  /** Whether both sides are seen. */
  isThin?: boolean;
}

const kLeast = 5e-5; // metres: what moves less stays, and its normals, too

type Put = (type: keyof typeof Accessor.Type, values: TypedArray) => Accessor;

function addParts(document: Document, parts: readonly Part[], put: Put): void {
  const root = document.createNode('avatar');
  document.createScene('Avatar').addChild(root);
  const nodes = joints.map(({ name, parent, at }) =>
    document
      .createNode(name)
      .setTranslation(sub(at, parent < 0 ? [0, 0, 0] : joints[parent]!.at) as [number, number, number]),
  );
  joints.forEach(({ parent }, j) => (parent < 0 ? root : nodes[parent]!).addChild(nodes[j]!));
  const skin = document.createSkin('figure').setSkeleton(nodes[0]!);
  for (const node of nodes) skin.addJoint(node);
  const inverse = joints.flatMap(({ at: [x, y, z] }) => [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -x, -y, -z, 1]);
  skin.setInverseBindMatrices(put('MAT4', Float32Array.from(inverse)));
  for (const part of parts) {
    const mesh = document.createMesh(part.name).addPrimitive(primitiveOf(document, part, put));
    const names = [...part.moves.keys()];
    if (names.length > 0) mesh.setExtras({ targetNames: names }).setWeights(names.map(() => 0));
    root.addChild(document.createNode(part.name).setMesh(mesh).setSkin(skin));
  }
}

function primitiveOf(document: Document, { name, mesh, roughness, moves, isThin = false }: Part, put: Put) {
  const points = mesh.vertices.map(({ at }) => at);
  const normals = normalsOf(mesh, points);
  const weights = mesh.vertices.map((vertex) => strongest(vertex.weights));
  const four = (of: (one: { joint: number; weight: number }) => number): number[] =>
    weights.flatMap((list) => [0, 1, 2, 3].map((i) => (list[i] && list[i].weight > 0 ? of(list[i]) : 0)));
  const material = document
    .createMaterial(name)
    .setRoughnessFactor(roughness)
    .setMetallicFactor(0)
    .setDoubleSided(isThin);
  const primitive = document
    .createPrimitive()
    .setMaterial(material)
    .setIndices(put('SCALAR', Uint16Array.from(mesh.triangles.flat())))
    .setAttribute('POSITION', put('VEC3', Float32Array.from(points.flat())))
    .setAttribute('NORMAL', put('VEC3', Float32Array.from(normals.flat())))
    .setAttribute('JOINTS_0', put('VEC4', Uint8Array.from(four(({ joint }) => joint))))
    .setAttribute('WEIGHTS_0', put('VEC4', Float32Array.from(four(({ weight }) => weight))));
  const colors = mesh.vertices.map(({ color }) => color);
  if (colors.every((color) => length(sub(color, colors[0]!)) < 1e-4)) material.setBaseColorFactor([...colors[0]!, 1]);
  else
    primitive.setAttribute(
      'COLOR_0',
      put(
        'VEC4',
        Uint8Array.from(colors.flatMap((color) => [...color.map((v) => Math.round(255 * v)), 255])),
      ).setNormalized(true),
    );
  for (const [morph, move] of moves) {
    const to = mesh.vertices.map(move);
    const turned = normalsOf(mesh, to);
    const shift = to.map((p, v) => sub(p, points[v]!));
    // Whatever shares a triangle with what moves may turn.
    const near = new Set(mesh.triangles.filter((t) => t.some((v) => length(shift[v]!) > kLeast)).flat());
    const offsets = (values: readonly Vec3[]): Float32Array =>
      Float32Array.from(values.flatMap((value, v) => (near.has(v) ? value : [0, 0, 0])));
    primitive.addTarget(
      document
        .createPrimitiveTarget(morph)
        .setAttribute('POSITION', put('VEC3', offsets(shift)))
        .setAttribute('NORMAL', put('VEC3', offsets(turned.map((n, v) => sub(n, normals[v]!))))),
    );
  }
  return primitive;
}

function addClips(document: Document, clips: readonly Clip[], put: Put): void {
  const nodes = new Map(
    document
      .getRoot()
      .listNodes()
      .map((node) => [node.getName(), node]),
  );
  for (const { name, times, stances } of clips) {
    const animation = document.createAnimation(name);
    const input = put('SCALAR', Float32Array.from(times));
    const channel = (node: Node, path: 'rotation' | 'translation', output: Accessor): void => {
      const sampler = document.createAnimationSampler().setInput(input).setOutput(output);
      animation
        .addSampler(sampler)
        .addChannel(document.createAnimationChannel().setTargetNode(node).setTargetPath(path).setSampler(sampler));
    };
    for (const joint of stances[0]!.turns.keys()) {
      const values = stances.map(({ turns }) => turns.get(joint)!.toArray());
      const still = values.every((value) => value.every((v, k) => Math.abs(v - values[0]![k]!) < 1e-5));
      if (!still) channel(nodes.get(joint)!, 'rotation', put('VEC4', Float32Array.from(values.flat())));
      else {
        const sampler = document
          .createAnimationSampler()
          .setInput(put('SCALAR', Float32Array.of(0, times.at(-1)!)))
          .setOutput(put('VEC4', Float32Array.from([...values[0]!, ...values[0]!])));
        animation
          .addSampler(sampler)
          .addChannel(
            document
              .createAnimationChannel()
              .setTargetNode(nodes.get(joint)!)
              .setTargetPath('rotation')
              .setSampler(sampler),
          );
      }
    }
    const hips = joints[0]!.at;
    const moved = stances.flatMap((stance) => stance.hips.map((value, k) => value + hips[k]!));
    channel(nodes.get('hips')!, 'translation', put('VEC3', Float32Array.from(moved)));
  }
}

/** The file: quantised, and compressed by meshopt. */
export async function writeAvatar(parts: readonly Part[], clips: readonly Clip[]): Promise<Uint8Array> {
  const document = new Document();
  document.getRoot().getAsset().generator = 'cagecast samples';
  const buffer = document.createBuffer();
  const put: Put = (type, values) => document.createAccessor().setType(type).setArray(values).setBuffer(buffer);
  addParts(document, parts, put);
  addClips(document, clips, put);
  await MeshoptEncoder.ready;
  // One volume for all: so they share the skin.
  const precision = { quantizationVolume: 'scene', quantizePosition: 16, quantizeNormal: 8 } as const;
  await document.transform(meshopt({ encoder: MeshoptEncoder, level: 'medium', ...precision }));
  const io = new NodeIO()
    .registerExtensions([EXTMeshoptCompression, KHRMeshQuantization])
    .registerDependencies({ 'meshopt.encoder': MeshoptEncoder });
  return io.writeBinary(document);
}
