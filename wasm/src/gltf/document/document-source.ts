import type {
  Document,
  ExtensionProperty,
  GLTF,
  Material,
  Node,
  Primitive,
  Property,
  Texture,
  TextureInfo,
} from '@gltf-transform/core';
import { transmissionExtension, visibilityExtension } from '../../parts/drawn.js';
import type { VrmExtensions } from '../../parts/joints.js';
import type { AccessorData } from '../../scene/accessor.js';
import type { Part } from '../../scene/extract.js';
import { instancing } from '../../scene/instancing.js';
import type { Piece } from '../../scene/pieces.js';
import type { ImageBytes, SceneSource } from '../../scene/source.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';

/** A piece, and its place in a document. */
export interface DocumentPart extends Piece {
  node: Node;
  primitive: Primitive;
}

/** The extensions of glTF-Transform, which are no dependency. */
interface Extensions {
  KHR_texture_transform: {
    getOffset(): number[];
    getRotation(): number;
    getScale(): number[];
    getTexCoord(): number | null;
  };
  KHR_node_visibility: { getVisible(): boolean };
  KHR_materials_transmission: { getTransmissionFactor(): number };
  KHR_materials_variants: { listMappings(): { getMaterial(): Material | null }[] };
  EXT_mesh_gpu_instancing: { listSemantics(): string[]; getAttribute(semantic: string): Property | null };
}

/** What an extension says of a property, in an object by its name; none if it says nothing. */
function extensionOf<Name extends keyof Extensions>(
  of: { getExtension(name: string): ExtensionProperty | null },
  name: Name,
  read: (extension: Extensions[Name]) => object,
): Record<string, object> {
  const found = of.getExtension(name) as unknown as Extensions[Name] | null;
  return found ? { [name]: read(found) } : {};
}

/** Numbers of things, by their order. */
class Numbers<T> {
  readonly #numbers: Map<T, number>;

  constructor(things: readonly T[]) {
    this.#numbers = new Map(things.map((thing, n) => [thing, n]));
  }

  of(thing: T): number {
    return this.#numbers.get(thing)!;
  }

  /** The number of a thing, if there is one, as a member. */
  as<Name extends string>(name: Name, thing: T | null): { [K in Name]?: number } {
    return (thing === null ? {} : { [name]: this.of(thing) }) as { [K in Name]?: number };
  }
}

/** A document as the file that it would be, as far as scenes are read; without any bytes. */
export class DocumentSource implements SceneSource {
  readonly json: GLTF.IGLTF;
  readonly accessors: readonly AccessorData[];
  readonly isUnnumbered = true;
  readonly materials: readonly Material[];
  readonly #nodes: readonly Node[];
  /** Of each mesh. */
  readonly #primitives: readonly (readonly Primitive[])[];
  /** A texture may be used with several wrap modes, each of which is a texture of the file. */
  readonly #textures: { texture: Texture; wrapS: number; wrapT: number }[] = [];

  /**
   * @param extensions  Those of the file, which documents do not keep.
   * @param cageUvs     As of `SceneSource`.
   */
  constructor(
    document: Document,
    extensions?: VrmExtensions,
    readonly cageUvs?: UvSetChoice,
  ) {
    const root = document.getRoot();
    const [accessors, nodes, scenes] = [root.listAccessors(), root.listNodes(), root.listScenes()];
    const [materials, meshes, skins] = [root.listMaterials(), root.listMeshes(), root.listSkins()];
    const ofAccessor = new Numbers<Property>(accessors);
    const [ofNode, ofMesh, ofSkin] = [new Numbers(nodes), new Numbers(meshes), new Numbers(skins)];
    const ofMaterial = new Numbers(materials);
    const attributesOf = (of: { listSemantics(): string[]; getAttribute(semantic: string): Property | null }) =>
      Object.fromEntries(of.listSemantics().map((semantic) => [semantic, ofAccessor.of(of.getAttribute(semantic)!)]));
    this.accessors = accessors;
    this.materials = materials;
    this.#nodes = nodes;
    this.#primitives = meshes.map((mesh) => mesh.listPrimitives());
    const primitiveDef = (primitive: Primitive): GLTF.IMeshPrimitive => ({
      attributes: attributesOf(primitive),
      mode: primitive.getMode(),
      targets: primitive.listTargets().map(attributesOf),
      extras: primitive.getExtras(),
      ...ofAccessor.as('indices', primitive.getIndices()),
      ...ofMaterial.as('material', primitive.getMaterial()),
      extensions: extensionOf(primitive, 'KHR_materials_variants', (variants) => ({
        mappings: variants.listMappings().map((mapping) => ofMaterial.as('material', mapping.getMaterial())),
      })),
    });
    this.json = {
      asset: { version: '2.0' },
      ...(extensions && { extensions: extensions as Record<string, unknown> }),
      ...new Numbers(scenes).as('scene', root.getDefaultScene()),
      scenes: scenes.map((scene) => ({ nodes: scene.listChildren().map((node) => ofNode.of(node)) })),
      nodes: nodes.map((node) => ({
        ...(node.getName() && { name: node.getName() }),
        matrix: node.getMatrix(),
        children: node.listChildren().map((child) => ofNode.of(child)),
        ...ofMesh.as('mesh', node.getMesh()),
        ...ofSkin.as('skin', node.getSkin()),
        ...(node.getWeights().length > 0 && { weights: node.getWeights() }),
        extras: node.getExtras(),
        extensions: {
          ...extensionOf(node, visibilityExtension, (visibility) => ({ visible: visibility.getVisible() })),
          ...extensionOf(node, instancing, (instances) => ({ attributes: attributesOf(instances) })),
        },
      })),
      meshes: meshes.map((mesh, m) => {
        const primitives = this.#primitives[m]!;
        const targets = primitives.map((one) => one.listTargets()).find(({ length }) => length > 0);
        const given = mesh.getExtras()['targetNames'] as unknown[] | undefined;
        const targetNames = targets?.map((target, t) => target.getName() || given?.[t]);
        return {
          name: mesh.getName(),
          primitives: primitives.map(primitiveDef),
          weights: mesh.getWeights(),
          extras: { ...mesh.getExtras(), targetNames },
        };
      }),
      skins: skins.map((skin) => ({
        joints: skin.listJoints().map((joint) => ofNode.of(joint)),
        ...ofAccessor.as('inverseBindMatrices', skin.getInverseBindMatrices()),
      })),
      accessors: accessors.map((one) => ({ count: one.getCount(), type: one.getType() }) as GLTF.IAccessor),
      materials: materials.map((material) => this.#material(material)),
      textures: this.#textures.map((_, t) => ({ sampler: t })),
      samplers: this.#textures.map(({ wrapS, wrapT }) => ({ wrapS, wrapT }) as GLTF.ISampler),
    };
  }

  #material(material: Material): GLTF.IMaterial {
    const use = (name: string, texture: Texture | null, info: TextureInfo | null) =>
      texture && info ? { [name]: this.#info(texture, info) } : {};
    return {
      name: material.getName(),
      alphaMode: material.getAlphaMode(),
      alphaCutoff: material.getAlphaCutoff(),
      doubleSided: material.getDoubleSided(),
      extras: material.getExtras(),
      pbrMetallicRoughness: {
        baseColorFactor: material.getBaseColorFactor(),
        metallicFactor: material.getMetallicFactor(),
        roughnessFactor: material.getRoughnessFactor(),
        ...use('baseColorTexture', material.getBaseColorTexture(), material.getBaseColorTextureInfo()),
        ...use(
          'metallicRoughnessTexture',
          material.getMetallicRoughnessTexture(),
          material.getMetallicRoughnessTextureInfo(),
        ),
      },
      ...use('normalTexture', material.getNormalTexture(), material.getNormalTextureInfo()),
      ...use('occlusionTexture', material.getOcclusionTexture(), material.getOcclusionTextureInfo()),
      extensions: extensionOf(material, transmissionExtension, (transmission) => ({
        transmissionFactor: transmission.getTransmissionFactor(),
      })),
    };
  }

  #info(texture: Texture, info: TextureInfo): GLTF.ITextureInfo {
    const [wrapS, wrapT] = [info.getWrapS(), info.getWrapT()];
    const known = this.#textures.findIndex(
      (one) => one.texture === texture && one.wrapS === wrapS && one.wrapT === wrapT,
    );
    const index = known < 0 ? this.#textures.push({ texture, wrapS, wrapT }) - 1 : known;
    return { index, ...infoOf(info) };
  }

  textureOf(number: number): Texture {
    return this.#textures[number]!.texture;
  }

  async imageOf(number: number): Promise<ImageBytes | undefined> {
    const texture = this.textureOf(number);
    const bytes = texture.getImage();
    return bytes ? { bytes, mimeType: texture.getMimeType() } : undefined;
  }

  /** Where a part is in the document. */
  partOf(part: Part): DocumentPart {
    return { ...part, node: this.#nodes[part.node]!, primitive: this.#primitives[part.mesh]![part.primitive]! };
  }
}

/** How a texture lies, as a file says it. */
export function infoOf(info: TextureInfo): Omit<GLTF.ITextureInfo, 'index'> {
  return {
    texCoord: info.getTexCoord(),
    extensions: extensionOf(info, 'KHR_texture_transform', (transform) => ({
      offset: transform.getOffset(),
      rotation: transform.getRotation(),
      scale: transform.getScale(),
      texCoord: transform.getTexCoord() ?? undefined,
    })),
  };
}
