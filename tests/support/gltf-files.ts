/** Small glTF files, one for each fact about how the format is read, and what every reader must make of them. */
import type { GLTF } from '@gltf-transform/core';
import { MeshoptEncoder } from 'meshoptimizer/encoder';
import { GlbMaker, tetrahedron, unpackGlb } from './glb.js';

/** What is read of a file: the triangles of its scene as arrays. */
export interface Read {
  positions: number[];
  indices: number[];
  /** Null if they must not be read. */
  uvs: number[] | null;
  /** The number of the part of each vertex. */
  groups: number[];
}

/** Who reads files: the package's three readers, and that of `core/gltf`. */
export type Reader = 'file' | 'document' | 'three' | 'native';

export interface GltfFile {
  name: string;
  bytes: Uint8Array;
  /** What is read; or what the error says. */
  expected: Read | RegExp;
  /** Readers for which this does not hold, by the reason. */
  not?: Partial<Record<Reader, string>>;
}

type Primitive = GLTF.IMeshPrimitive;
const solid = tetrahedron(1);
const kVertices = 4;
/** What is read of a plain tetrahedron. */
const plain: Read = {
  positions: [...solid.positions],
  indices: [...solid.indices],
  uvs: [...solid.uvs],
  groups: [0, 0, 0, 0],
};
const moved = (by: readonly [number, number, number], { positions } = plain): number[] =>
  positions.map((value, i) => value + by[i % 3]!);

/** A file with a tetrahedron in a node. @param change  Changes it, before its bytes are put together. */
function file(change: (maker: GlbMaker, primitive: Primitive, node: GLTF.INode) => void = () => {}): Uint8Array {
  const maker = new GlbMaker();
  const node: GLTF.INode = { mesh: maker.mesh(solid), name: 'node' };
  maker.node(node);
  change(maker, maker.json.meshes[0]!.primitives[0]!, node);
  return maker.finish();
}

/** The accessor of a semantic. */
const accessorOf = (maker: GlbMaker, { attributes }: Primitive, semantic: string) =>
  maker.json.accessors[attributes[semantic]!]!;

/** Several pieces, one after the other. */
function joined(...pieces: Pick<Read, 'positions' | 'uvs'>[]): Read {
  const all = pieces.flatMap(({ uvs }) => uvs ?? []);
  return {
    positions: pieces.flatMap(({ positions }) => positions),
    indices: pieces.flatMap((_, p) => plain.indices.map((vertex) => kVertices * p + vertex)),
    uvs: pieces.some(({ uvs }) => uvs === null) ? null : all,
    groups: pieces.flatMap((_, p) => Array<number>(kVertices).fill(p)),
  };
}

/** The winding of a mirrored mesh is reversed: the last two corners change places. */
const reversed = (indices: readonly number[]): number[] =>
  indices.map((_, i) => indices[i % 3 === 0 ? i : i % 3 === 1 ? i + 1 : i - 1]!);

/** Adds a material whose base colour texture is used so. @returns its number. */
function textured(maker: GlbMaker, info: object): number {
  maker.json.images = [{ bufferView: maker.view(Uint8Array.of(0x89, 0x50)), mimeType: 'image/png' }];
  maker.json.textures = [{ source: 0 }];
  return (maker.json.materials ??= []).push({ pbrMetallicRoughness: { baseColorTexture: { index: 0, ...info } } }) - 1;
}

const mirrors = [
  [-1, 1, 1],
  [1, 1, -2],
  [-1, -1, -1],
  [-1, -1, 1],
] as const;
const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
/** The inverse of a joint at a place, for a mesh that is stored so much larger than it is shown. */
const inverseOf = ([x, y, z]: readonly number[], scale = 1): number[] =>
  identity.map((value, i) => (i < 12 ? value / scale : i < 15 ? -[x, y, z][i - 12]! : value));

/** Holds a primitive by joints: each of its vertices by one. */
function held(maker: GlbMaker, primitive: Primitive, joints: readonly number[]): void {
  const slots = Uint8Array.from({ length: 4 * kVertices }, (_, i) => (i % 4 === 0 ? joints[i / 4]! : 0));
  primitive.attributes['JOINTS_0'] = maker.accessor(slots, 'VEC4');
  const weights = Float32Array.from(slots, (_, i) => Number(i % 4 === 0));
  primitive.attributes['WEIGHTS_0'] = maker.accessor(weights, 'VEC4');
}

/** Positions that are stored larger than they are shown. */
const scaled = (maker: GlbMaker, by: number): number =>
  maker.accessor(
    solid.positions.map((x) => by * x),
    'VEC3',
  );

/** A quarter turn from z to y: (x, y, z) comes to (x, z, -y). */
const kUpright = [-Math.SQRT1_2, 0, 0, Math.SQRT1_2];

interface Figure {
  /** By how much the second joint has turned. */
  posed?: number;
  /** How many times larger it is stored. */
  scale?: number;
  /** What turns it upright if it is stored lying: a node above its joints, the first of them, or, as FBX2glTF has it, its own node. */
  turned?: 'above' | 'root' | 'mesh';
  /** A third tetrahedron, which is on no skin but hangs on the second joint. */
  rigid?: boolean;
}

/** A tetrahedron on two joints, of which the second may have turned; and a second one on that joint alone. */
function figure({ posed = 0, scale = 1, turned, rigid }: Figure): Uint8Array {
  return file((maker, primitive, node) => {
    const rotation = kUpright;
    const head = maker.node(
      { name: 'head', translation: [0, 0, 0.5], rotation: [0, Math.sin(posed), 0, Math.cos(posed)] },
      false,
    );
    if (rigid) maker.json.nodes[head]!.children = [maker.node({ mesh: maker.mesh(solid) }, false)];
    const hips = maker.node({ name: 'hips', children: [head], ...(turned === 'root' && { rotation }) }, false);
    maker.node({ children: [hips], ...(turned === 'above' && { rotation }) });
    const second = maker.mesh(solid);
    for (const [one, joints] of [
      [primitive, [1, 0, 1, 0]],
      [maker.json.meshes[second]!.primitives[0]!, [0, 0, 0, 0]],
    ] as const) {
      const stored = solid.positions.map((_, i, p) => (turned ? [p[i]!, -p[i + 1]!, p[i - 1]!][i % 3]! : p[i]!));
      one.attributes['POSITION'] = maker.accessor(
        stored.map((x) => scale * x),
        'VEC3',
      );
      held(maker, one, joints);
    }
    const inverse = (place: number[]) => {
      const all = inverseOf(place, scale);
      return turned === 'mesh'
        ? all.map((_, i) => (i < 12 && i % 4 > 0 && i % 4 < 3 ? [all[i + 1]!, -all[i - 1]!][(i % 4) - 1]! : all[i]!))
        : all;
    };
    const inverses = [...inverse([0, 0, 0.5]), ...inverse([0, 0, 0])];
    const inverseBindMatrices = maker.accessor(Float32Array.from(inverses), 'MAT4');
    maker.json.skins = [{ joints: [head, hips], inverseBindMatrices }];
    // Which a skin ignores.
    const own =
      turned === 'mesh' ? { rotation, scale: [1, 1, 1].map((one) => one / scale) } : { translation: [9, 9, 9] };
    Object.assign(node, { skin: 0, ...own });
    maker.node({ name: 'second', mesh: second, skin: 0, ...(turned === 'mesh' && own) });
  });
}

const kAll = 'it reads all that is there, drawn or not';
const all = joined(plain, plain);
const cases: Record<string, Omit<GltfFile, 'name'>> = {
  tetrahedron: { bytes: file(), expected: plain },

  // Triangles
  'not-indexed': {
    bytes: file((maker, primitive) => {
      delete primitive.indices;
      for (const [semantic, size, type] of [
        ['POSITION', 3, 'VEC3'],
        ['TEXCOORD_0', 2, 'VEC2'],
      ] as const) {
        const values = semantic === 'POSITION' ? solid.positions : solid.uvs;
        const corners = [...solid.indices].flatMap((v) => [...values.subarray(size * v, size * (v + 1))]);
        primitive.attributes[semantic] = maker.accessor(Float32Array.from(corners), type);
      }
    }),
    expected: {
      positions: plain.indices.flatMap((v) => plain.positions.slice(3 * v, 3 * v + 3)),
      indices: [...plain.indices.keys()],
      uvs: plain.indices.flatMap((v) => plain.uvs!.slice(2 * v, 2 * v + 2)),
      groups: plain.indices.map(() => 0),
    },
  },
  'indices-of-8-bits': {
    bytes: file((maker, primitive) => (primitive.indices = maker.accessor(Uint8Array.from(solid.indices), 'SCALAR'))),
    expected: plain,
  },
  'indices-of-32-bits': {
    bytes: file((maker, primitive) => (primitive.indices = maker.accessor(Uint32Array.from(solid.indices), 'SCALAR'))),
    expected: plain,
  },
  strip: {
    bytes: file((maker, primitive) => {
      primitive.indices = maker.accessor(Uint16Array.of(0, 1, 2, 3), 'SCALAR');
      primitive.mode = 5;
    }),
    expected: { ...plain, indices: [0, 1, 2, 1, 3, 2] },
    not: { three: 'GLTFLoader orders the corners of every other triangle in another way' },
  },
  fan: {
    bytes: file((maker, primitive) => {
      primitive.indices = maker.accessor(Uint16Array.of(0, 1, 2, 3), 'SCALAR');
      primitive.mode = 6;
    }),
    expected: { ...plain, indices: [1, 2, 0, 2, 3, 0] },
    not: {
      three: 'GLTFLoader begins each triangle at the middle of the fan',
      native: 'so does it, as its own tests say',
    },
  },
  'points-and-lines-beside': {
    bytes: file((maker, primitive) => {
      for (const mode of [0, 1, 2, 3] as const) maker.node({ mesh: maker.mesh(solid, { mode }) });
      primitive.mode = 4;
    }),
    expected: plain,
  },

  // Numbers
  interleaved: {
    bytes: file((maker, primitive) => {
      const words = Array.from({ length: kVertices }, (_, v) => [
        ...solid.uvs.subarray(2 * v, 2 * v + 2),
        ...solid.positions.subarray(3 * v, 3 * v + 3),
      ]);
      const view = maker.view(new Uint8Array(Float32Array.from(words.flat()).buffer), { byteStride: 20 });
      Object.assign(accessorOf(maker, primitive, 'TEXCOORD_0'), { bufferView: view });
      Object.assign(accessorOf(maker, primitive, 'POSITION'), { bufferView: view, byteOffset: 8 });
    }),
    expected: plain,
  },
  'normalised-positions-and-uvs': {
    bytes: file((maker, primitive, node) => {
      const corners = solid.positions.map((x) => 32767 * Math.sign(x));
      primitive.attributes['POSITION'] = maker.accessor(Int16Array.from(corners), 'VEC3', { normalized: true });
      const uvs = solid.uvs.map((x) => 65535 * x);
      primitive.attributes['TEXCOORD_0'] = maker.accessor(Uint16Array.from(uvs), 'VEC2', { normalized: true });
      node.scale = [1, 1, 1].map((x) => x / Math.sqrt(3));
      maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
    }),
    expected: plain,
  },
  'positions-of-8-bits': {
    bytes: file((maker, primitive, node) => {
      primitive.attributes['POSITION'] = maker.accessor(Int8Array.from(solid.positions, Math.sign), 'VEC3');
      node.scale = [1, 1, 1].map((x) => x / Math.sqrt(3));
      maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
    }),
    expected: plain,
  },
  'sparse-over-values': {
    bytes: file((maker, primitive) => {
      primitive.attributes['POSITION'] = scaled(maker, 2);
      Object.assign(accessorOf(maker, primitive, 'POSITION'), sparse(maker, [0, 1, 2, 3], [...solid.positions]));
    }),
    expected: plain,
  },
  'sparse-over-nothing': {
    bytes: file((maker, primitive) => {
      const uvs = accessorOf(maker, primitive, 'TEXCOORD_0');
      delete uvs.bufferView;
      Object.assign(uvs, sparse(maker, [3], [0.25, 0.5]));
    }),
    expected: { ...plain, uvs: [0, 0, 0, 0, 0, 0, 0.25, 0.5] },
  },
  'zeros-that-are-not-in-the-file': {
    bytes: file((maker, primitive) => delete accessorOf(maker, primitive, 'TEXCOORD_0').bufferView),
    expected: { ...plain, uvs: Array(8).fill(0) },
  },
  'morph-targets': {
    bytes: file((maker, primitive) => {
      const quantised = Int8Array.from(solid.positions, (x) => 127 * Math.sign(x));
      primitive.targets = [
        { POSITION: scaled(maker, 0.5) },
        { POSITION: maker.accessor(quantised, 'VEC3', { normalized: true }) },
      ];
      maker.json.meshes[0]!.weights = [1, 0];
      maker.node({ mesh: 0, weights: [-1, Math.sqrt(3)] });
      maker.json.extensionsUsed = maker.json.extensionsRequired = ['KHR_mesh_quantization'];
    }),
    // As they are shown: by the weights of the node, or else of the mesh.
    expected: joined(...[1.5, 3.5].map((by) => ({ ...plain, positions: plain.positions.map((x) => by * x) }))),
  },
  meshopt: {
    bytes: await compressed(),
    expected: plain,
    not: { native: 'it has no decoders' },
  },
  'text-with-a-data-uri': {
    bytes: (() => {
      const { json, bin } = unpackGlb(file());
      json.buffers![0]!.uri = `data:application/octet-stream;base64,${Buffer.from(bin).toString('base64')}`;
      return Buffer.from(JSON.stringify(json));
    })(),
    expected: plain,
  },

  // Nodes
  'translation-rotation-scale': {
    bytes: file((_, __, node) => {
      // A quarter turn about z, after scaling.
      Object.assign(node, { translation: [1, 2, 3], rotation: [0, 0, Math.SQRT1_2, Math.SQRT1_2], scale: [2, 3, 4] });
    }),
    expected: {
      ...plain,
      positions: plain.positions.map((_, i, p) => {
        const v = i - (i % 3);
        return [1 - 3 * p[v + 1]!, 2 + 2 * p[v]!, 3 + 4 * p[v + 2]!][i % 3]!;
      }),
    },
  },
  'matrices-of-parents': {
    bytes: file((maker, _, node) => {
      node.matrix = [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1]; // a quarter turn about z, then along x
      maker.json.scenes![0]!.nodes = [];
      maker.node({ children: [0], matrix: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 5, 1, 0, 1] }); // and back
    }),
    expected: { ...plain, positions: moved([5, 0, 0]) },
  },
  // The winding of one is reversed if the number of mirrored axes is odd.
  mirrored: {
    bytes: file((maker, _, node) => {
      node.scale = [-1, 1, 1];
      for (const scale of mirrors.slice(1)) maker.node({ mesh: 0, scale: [...scale] });
    }),
    expected: {
      ...joined(...mirrors.map((scale) => ({ ...plain, positions: plain.positions.map((x, i) => scale[i % 3]! * x) }))),
      indices: mirrors.flatMap(([x, y, z], p) =>
        (x * y * z < 0 ? reversed(plain.indices) : plain.indices).map((vertex) => kVertices * p + vertex),
      ),
    },
  },
  'a-mesh-in-two-places': {
    bytes: file((maker) => maker.node({ mesh: 0, translation: [4, 0, 0] })),
    expected: joined(plain, { ...plain, positions: moved([4, 0, 0]) }),
  },
  'children-before-siblings': {
    bytes: file((maker, _, node) => {
      const child = maker.node({ mesh: 0, translation: [1, 0, 0] }, false);
      node.children = [child];
      maker.node({ mesh: 0, translation: [2, 0, 0] });
    }),
    expected: joined(...[0, 1, 2].map((x) => ({ ...plain, positions: moved([x, 0, 0]) }))),
  },
  'two-primitives': {
    bytes: file((maker) => {
      const other = maker.mesh({ ...solid, positions: solid.positions.map((x) => 2 * x) });
      maker.json.meshes[0]!.primitives.push(maker.json.meshes[other]!.primitives[0]!);
    }),
    expected: joined(plain, { ...plain, positions: plain.positions.map((x) => 2 * x) }),
  },
  'the-default-scene': {
    bytes: file((maker) => {
      const other = maker.node({ mesh: 0, translation: [1, 0, 0] }, false);
      maker.json.scenes!.push({ nodes: [other] });
      maker.json.scene = 1;
    }),
    expected: { ...plain, positions: moved([1, 0, 0]) },
  },
  'no-default-scene': {
    bytes: file((maker) => {
      const other = maker.node({ mesh: 0, translation: [1, 0, 0] }, false);
      maker.json.scenes!.push({ nodes: [other] });
      delete maker.json.scene;
    }),
    expected: plain,
  },
  'no-scenes': {
    bytes: file((maker) => {
      delete maker.json.scenes;
      delete maker.json.scene;
    }),
    expected: plain,
    not: { three: 'GLTFLoader gives no scene' },
  },
  instances: {
    bytes: file((maker, _, node) => {
      const places = maker.accessor(Float32Array.of(1, 0, 0, 100, 0, 0), 'VEC3');
      const sizes = maker.accessor(Float32Array.of(2, 2, 2, 1, 1, 1), 'VEC3');
      node.extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: places, SCALE: sizes } } };
      node.translation = [-1, 0, 0];
      maker.json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
    }),
    expected: { ...plain, positions: plain.positions.map((x) => 2 * x) },
  },
  'overlays-of-an-earlier-transfer': {
    bytes: file((maker, primitive) => {
      const marked = maker.json.meshes[0]!.primitives;
      const indices = maker.accessor(solid.indices.subarray(3), 'SCALAR');
      marked.push({ ...primitive, indices, extras: { cagecastOverlay: true } });
      // What is left of the mark when overlays were joined.
      maker.json.materials = [{ extras: { cagecastOverlay: true } }];
      marked.push({ ...primitive, material: 0 });
    }),
    expected: plain,
  },

  'an-overlay-in-place-of-triangles': {
    bytes: file((maker, primitive) => {
      const all = maker.json.meshes[0]!.primitives;
      maker.json.materials = [{ extras: { cagecastOverlay: true, cagecastInPlace: true } }];
      const extras = { cagecastOverlay: true, cagecastInPlaceOf: 0 };
      all.push({ ...primitive, indices: maker.accessor(solid.indices.subarray(3), 'SCALAR'), extras, material: 0 });
      primitive.indices = maker.accessor(solid.indices.subarray(0, 3), 'SCALAR');
    }),
    expected: plain,
  },
  'an-overlay-in-place-of-triangles-that-are-lost': {
    bytes: file((maker, primitive) => {
      maker.json.materials = [{ extras: { cagecastOverlay: true, cagecastInPlace: true } }];
      Object.assign(primitive, { material: 0, extras: { cagecastOverlay: true, cagecastInPlaceOf: 5 } });
    }),
    expected: plain,
  },

  // What is not drawn
  'parts-that-are-not-drawn': {
    bytes: file((maker, primitive) => {
      const off = { extensions: { KHR_node_visibility: { visible: false } } };
      maker.json.extensionsUsed = ['KHR_node_visibility'];
      maker.node({ name: 'outfit', mesh: 0, ...off });
      maker.node({ children: [maker.node({ mesh: 0 }, false)], ...off });
      maker.json.materials = [
        { alphaMode: 'BLEND', pbrMetallicRoughness: { baseColorFactor: [1, 1, 1, 0] } },
        { alphaMode: 'MASK', pbrMetallicRoughness: { baseColorFactor: [1, 1, 1, 0.4] } },
        { alphaMode: 'OPAQUE', pbrMetallicRoughness: { baseColorFactor: [1, 1, 1, 0] } },
      ];
      for (const material of [0, 1]) maker.node({ mesh: maker.mesh(solid, { material }) });
      primitive.material = 2;
      delete primitive.attributes['TEXCOORD_0'];
      for (const name of ['Head_OuterCage', 'Head_InnerCage', 'Hat_Att', 'UCX_Head_01', 'head_collider.001'])
        maker.node({ name, mesh: 0 });
    }),
    expected: { ...plain, uvs: null },
    not: { native: kAll },
  },
  // The larger one shows its inside alone, at the edge of the other; the third is seen from both sides, the last holds nothing.
  'an-outline': {
    bytes: file((maker, primitive) => {
      delete primitive.attributes['TEXCOORD_0'];
      const inward = Uint16Array.from(reversed([...solid.indices]));
      maker.json.materials = [{ doubleSided: true }];
      for (const [size, material, x] of [
        [1.1, {}, 0],
        [1.2, { material: 0 }, 0],
        [1, {}, 9],
      ] as const) {
        const positions = solid.positions.map((value) => size * value);
        const mesh = maker.mesh({ ...solid, positions, indices: inward }, material);
        maker.node({ mesh, translation: [x, 0, 0] });
      }
    }),
    expected: (({ indices, ...rest }: Read): Read => {
      return { ...rest, uvs: null, indices: indices.map((v, i) => (i < 12 ? v : reversed(indices)[i]!)) };
    })(
      joined(
        plain,
        { ...plain, positions: plain.positions.map((x) => Math.fround(1.2) * x) },
        { ...plain, positions: moved([9, 0, 0]) },
      ),
    ),
    not: { native: kAll },
  },

  // UVs
  'uvs-of-the-texture': {
    bytes: file((maker, primitive) => {
      primitive.attributes['TEXCOORD_1'] = maker.accessor(
        solid.uvs.map((x) => x / 2),
        'VEC2',
      );
      primitive.material = textured(maker, { texCoord: 1 });
    }),
    expected: { ...plain, uvs: plain.uvs!.map((x) => x / 2) },
  },
  'uvs-that-are-transformed': {
    bytes: file((maker, primitive) => {
      primitive.attributes['TEXCOORD_1'] = primitive.attributes['TEXCOORD_0']!;
      delete primitive.attributes['TEXCOORD_0'];
      const transform = { offset: [0.5, 0.75], rotation: Math.PI / 2, scale: [0.5, 0.25], texCoord: 1 };
      primitive.material = textured(maker, { extensions: { KHR_texture_transform: transform } });
      maker.json.extensionsUsed = ['KHR_texture_transform'];
    }),
    // Scaled, turned, then moved.
    expected: {
      ...plain,
      uvs: plain.uvs!.map((_, i, uvs) => (i % 2 === 0 ? 0.5 + 0.25 * uvs[i + 1]! : 0.75 - 0.5 * uvs[i - 1]!)),
    },
  },
  'uvs-of-one-part-only': {
    bytes: file((maker) => maker.node({ mesh: maker.mesh({ positions: solid.positions, indices: solid.indices }) })),
    expected: { ...all, uvs: null },
  },

  // Skins
  'skin-at-rest': { bytes: figure({}), expected: all },
  'skin-in-another-unit': { bytes: figure({ scale: 64 }), expected: all },
  'skin-that-is-posed': { bytes: figure({ posed: 0.2 }), expected: all },
  'skin-in-another-unit-that-is-posed': { bytes: figure({ posed: 0.2, scale: 64 }), expected: all },
  ...Object.fromEntries(
    (['above', 'root', 'mesh'] as const).flatMap((turned) =>
      [0, 0.001, 0.2].map((posed) => [
        `skin-turned-by-${turned}-posed-by-${posed}`,
        { bytes: figure({ posed, turned, scale: turned === 'mesh' ? 64 : 1 }), expected: all },
      ]),
    ),
  ),
  'a-rigid-part-of-a-figure-that-is-posed': {
    bytes: figure({ posed: 0.2, rigid: true }),
    expected: joined(plain, { ...plain, positions: moved([0, 0, 0.5]) }, plain),
  },
  'skin-that-stands-elsewhere': {
    bytes: file((maker, primitive, node) => {
      held(maker, primitive, [0, 0, 0, 0]);
      const joint = maker.node({ translation: [3, 0, 0] });
      maker.json.skins = [
        { joints: [joint], inverseBindMatrices: maker.accessor(Float32Array.from(inverseOf([1, 0, 0])), 'MAT4') },
      ];
      node.skin = 0;
    }),
    expected: { ...plain, positions: moved([2, 0, 0]) },
  },
  'skin-without-matrices': {
    bytes: file((maker, primitive, node) => {
      held(maker, primitive, [0, 0, 0, 0]);
      maker.json.skins = [{ joints: [maker.node({ translation: [3, 0, 0] })] }];
      node.skin = 0;
    }),
    expected: { ...plain, positions: moved([3, 0, 0]) },
  },
  'a-joint-below-itself': {
    bytes: file((maker, primitive, node) => {
      held(maker, primitive, [0, 0, 0, 0]);
      maker.json.skins = [{ joints: [1] }];
      node.skin = 0;
      maker.json.nodes.push({ children: [2] }, { children: [1], translation: [2, 0, 0] });
    }),
    expected: plain,
    not: { three: 'GLTFLoader does not end' },
  },

  // What cannot be read
  'an-index-out-of-range': {
    bytes: file((maker, primitive) => (primitive.indices = maker.accessor(Uint16Array.of(0, 1, 7), 'SCALAR'))),
    expected: /indices\[2\] = 7,?( which)? is out of range \(4 vertices\)/,
  },
  'corners-without-a-triangle': {
    bytes: file((maker, primitive) => (primitive.indices = maker.accessor(Uint16Array.of(0, 1, 2, 3), 'SCALAR'))),
    expected: /has 4 corners, not 3 per triangle/,
    not: { native: 'it leaves over what is no triangle' },
  },
  'positions-that-are-not-finite': {
    bytes: file((maker, primitive) => {
      const positions = solid.positions.slice();
      positions[4] = Number.NaN;
      primitive.attributes['POSITION'] = maker.accessor(positions, 'VEC3', { min: undefined, max: undefined });
    }),
    expected: /POSITION of vertex 1 has NaN, which is not a finite number/,
    not: { three: 'the transfer names them', native: 'the transfer names them' },
  },
  'positions-of-two-numbers': {
    bytes: file((_, primitive) => (primitive.attributes['POSITION'] = primitive.attributes['TEXCOORD_0']!)),
    expected: /POSITION is VEC2, not VEC3|positions of 2 numbers, not 3|POSITION, does not have 3 components/,
  },
  'uvs-of-three-numbers': {
    bytes: file((_, primitive) => (primitive.attributes['TEXCOORD_0'] = primitive.attributes['POSITION']!)),
    expected: /TEXCOORD_0 is VEC3, not VEC2|has 4 UVs of 3 numbers, not 4 of 2|TEXCOORD_0, does not have 2 comp/,
  },
  'fewer-uvs-than-vertices': {
    bytes: file((maker, primitive) => (accessorOf(maker, primitive, 'TEXCOORD_0').count = 2)),
    expected: /has 2 (elements|uv|TEXCOORD_0) for 4 vertices/,
  },
  'a-transform-of-no-numbers': {
    bytes: file((maker, primitive) => {
      primitive.material = textured(maker, { extensions: { KHR_texture_transform: { scale: ['a', 1] } } });
      maker.json.extensionsUsed = ['KHR_texture_transform'];
    }),
    expected: /scale of KHR_texture_transform is not of (finite )?numbers/,
    not: { three: 'the transfer names the UVs' },
  },
  'instances-of-no-place': {
    bytes: file((maker, _, node) => {
      const places = maker.accessor(Float32Array.of(Number.NaN, 0, 0), 'VEC3', { min: undefined, max: undefined });
      node.extensions = { EXT_mesh_gpu_instancing: { attributes: { TRANSLATION: places } } };
      maker.json.extensionsUsed = ['EXT_mesh_gpu_instancing'];
    }),
    expected: /TRANSLATION of EXT_mesh_gpu_instancing is not of 3 finite numbers/,
    not: { three: 'the transfer names the positions', native: 'the transfer names the positions' },
  },
};

function sparse(maker: GlbMaker, elements: readonly number[], values: readonly number[]): object {
  const indices = { bufferView: maker.view(Uint8Array.from(elements)), componentType: 5121 };
  const bufferView = maker.view(new Uint8Array(Float32Array.from(values).buffer));
  return { sparse: { count: elements.length, indices, values: { bufferView } } };
}

/** Positions that meshopt has compressed. */
async function compressed(): Promise<Uint8Array> {
  await MeshoptEncoder.ready;
  return file((maker, primitive) => {
    const bytes = new Uint8Array(solid.positions.buffer);
    const packed = MeshoptEncoder.encodeGltfBuffer(bytes, kVertices, 12, 'ATTRIBUTES', 0);
    const view = maker.view(packed);
    const { byteOffset, byteLength } = maker.json.bufferViews[view]!;
    const meshopt = { buffer: 0, byteOffset, byteLength, byteStride: 12, count: kVertices, mode: 'ATTRIBUTES' };
    maker.json.buffers!.push({ byteLength: 48, extensions: { EXT_meshopt_compression: { fallback: true } } } as never);
    maker.json.bufferViews[view] = {
      ...{ buffer: 1, byteLength: 48, byteStride: 12 },
      extensions: { EXT_meshopt_compression: meshopt },
    };
    accessorOf(maker, primitive, 'POSITION').bufferView = view;
    maker.json.extensionsUsed = maker.json.extensionsRequired = ['EXT_meshopt_compression'];
  });
}

export const gltfFiles: readonly GltfFile[] = Object.entries(cases).map(([name, one]) => ({ name, ...one }));

/** The names by which a reader of other kind finds a file: `.gltf` for text. */
export const fileNameOf = ({ name, bytes }: GltfFile): string =>
  `${name}.${Buffer.from(bytes.subarray(0, 4)).toString() === 'glTF' ? 'glb' : 'gltf'}`;
