import {
  Extension,
  type GLTF,
  type Material,
  type Node,
  type ReaderContext,
  type Texture,
  TextureInfo,
  type WriterContext,
} from '@gltf-transform/core';

/** What VRM 0 and VRM 1 files say of their avatar, its materials and its bones. */
const kNames = [
  'VRM',
  'VRMC_vrm',
  'VRMC_springBone',
  'VRMC_springBone_extended_collider',
  'VRMC_node_constraint',
  'VRMC_materials_mtoon',
  'VRMC_materials_hdr_emissiveMultiplier',
] as const;

/** The keys whose numbers are indices of nodes, in all of these extensions. */
const kNodeKeys = ['node', 'center', 'source', 'bones', 'firstPersonBone'];

type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
/** Gives the index in the file that is written, or undefined if there is none. @param key  Where the old index stands. */
type Renumber = (index: number, key: string, parent: string) => number | undefined;

abstract class AvatarExtension extends Extension {
  #read: ReaderContext | undefined;
  readonly #ofMaterials = new Map<Material, Json>();
  readonly #ofNodes = new Map<Node, Json>();

  read(context: ReaderContext): this {
    this.#read = context;
    const { materials = [], nodes = [] } = context.jsonDoc.json;
    for (const [i, { extensions }] of materials.entries())
      if (extensions?.[this.extensionName])
        this.#ofMaterials.set(context.materials[i]!, extensions[this.extensionName] as Json);
    for (const [i, { extensions }] of nodes.entries())
      if (extensions?.[this.extensionName])
        this.#ofNodes.set(context.nodes[i]!, extensions[this.extensionName] as Json);
    return this;
  }

  write(context: WriterContext): this {
    if (!this.#read) return this;
    const { json } = context.jsonDoc;
    const renumber = renumbering(this.#read, context);
    const put = (into: GLTF.IProperty, data: Json): void => {
      into.extensions = { ...into.extensions, [this.extensionName]: renumbered(data, renumber) };
    };
    const ofFile = this.#read.jsonDoc.json.extensions?.[this.extensionName] as Json | undefined;
    if (ofFile) put(json, ofFile);
    for (const [material, data] of this.#ofMaterials) {
      const index = context.materialIndexMap.get(material);
      if (index !== undefined) put(json.materials![index]!, data);
    }
    for (const [node, data] of this.#ofNodes) {
      const index = context.nodeIndexMap.get(node);
      if (index !== undefined) put(json.nodes![index]!, data);
    }
    return this;
  }
}

/** Extensions that keep an avatar's data: glTF-Transform would leave out what it does not know. */
export const avatarExtensions = kNames.map(
  (name) =>
    class extends AvatarExtension {
      static override readonly EXTENSION_NAME = name;
      override readonly extensionName = name;
    },
);

function renumbering(read: ReaderContext, written: WriterContext): Renumber {
  const imageOf = ({ source, extensions }: GLTF.ITexture = {}): number | undefined => {
    const others = Object.values(extensions ?? {}) as { source?: number }[];
    return source ?? others.find((other) => other.source !== undefined)?.source;
  };
  const textureIndex = (texture: Texture | undefined): number | undefined =>
    texture && written.imageIndexMap.has(texture)
      ? written.createTextureInfoDef(texture, new TextureInfo(texture.getGraph())).index
      : undefined;
  return (index, key, parent) => {
    if (kNodeKeys.includes(key)) return written.nodeIndexMap.get(read.nodes[index]!);
    if (key === 'mesh') return written.meshIndexMap.get(read.meshes[index]!);
    if (key === 'material') return written.materialIndexMap.get(read.materials[index]!);
    if (key === 'thumbnailImage') return written.imageIndexMap.get(read.textures[index]!);
    if (key === 'texture' || parent === 'textureProperties' || (key === 'index' && parent.endsWith('Texture')))
      return textureIndex(read.textures[imageOf(read.jsonDoc.json.textures?.[index]) ?? -1]);
    return index;
  };
}

/** Copies data with other indices; what has none any more is left out. */
function renumbered(data: Json, renumber: Renumber, key = '', parent = ''): Json | undefined {
  // -1 stands for none.
  if (typeof data === 'number') return data < 0 ? data : renumber(data, key, parent);
  if (typeof data !== 'object' || data === null) return data;
  if (Array.isArray(data))
    return data.map((one) => renumbered(one, renumber, key, parent)).filter((one) => one !== undefined);
  const copies = Object.entries(data).map(([own, value]) => [own, renumbered(value, renumber, own, key)] as const);
  return Object.fromEntries(copies.filter((entry): entry is [string, Json] => entry[1] !== undefined));
}
