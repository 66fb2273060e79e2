import type { GLTF, vec2, vec3, vec4 } from '@gltf-transform/core';
import {
  ClampToEdgeWrapping,
  type Color,
  DoubleSide,
  type Material,
  MirroredRepeatWrapping,
  type Texture,
  type Vector2,
  type Wrapping,
} from 'three';
import { imageType } from '../../image-file.js';
import type { ImageBytes } from './images.js';

/** What materials of three.js may have. */
interface Look {
  color?: Color;
  map?: Texture | null;
  normalMap?: Texture | null;
  normalScale?: Vector2;
  emissive?: Color;
  emissiveMap?: Texture | null;
  roughness?: number;
  metalness?: number;
}

const wraps = new Map<Wrapping, GLTF.TextureWrapMode>([
  [ClampToEdgeWrapping, 33071],
  [MirroredRepeatWrapping, 33648],
]);
const kTransform = 'KHR_texture_transform';
const kWebp = 'EXT_texture_webp';
/** Of materials that say nothing of it. */
const kRoughness = 0.9;

/** A number, or what stands for one that is none. */
const finite = (value: unknown, otherwise: number): number =>
  typeof value === 'number' && Number.isFinite(value) ? value : otherwise;
/** A factor, as glTF has them. */
const factor = (value: unknown, otherwise: number): number => Math.min(1, Math.max(0, finite(value, otherwise)));
const colorOf = (color: Color | undefined, otherwise: number): vec3 =>
  (color?.isColor ? color.toArray() : [otherwise, otherwise, otherwise]).map((x) => factor(x, otherwise)) as vec3;
/** A name, of what may be anything. */
export const named = (name: unknown): { name?: string } => (typeof name === 'string' && name !== '' ? { name } : {});

/** Writes materials, and the bytes of their images, to the JSON of a glTF. */
export class MaterialWriter {
  readonly #json: GLTF.IGLTF;
  readonly #addView: (bytes: Uint8Array) => number;
  /** Their numbers: of those without textures, and of those with them. */
  readonly #materials = [new Map<Material, number>(), new Map<Material, number>()] as const;
  readonly #images = new Map<Uint8Array, number>();

  constructor(json: GLTF.IGLTF, addView: (bytes: Uint8Array) => number) {
    this.#json = json;
    this.#addView = addView;
  }

  /** The bytes of each, by their numbers. */
  get images(): Iterable<Uint8Array> {
    return this.#images.keys();
  }

  /**
   * @param hasUvs  Whether its mesh has UVs; without, it has no textures.
   * @returns the number of the material.
   */
  add(material: Material, hasUvs: boolean): number {
    const materials = this.#materials[hasUvs ? 1 : 0];
    const known = materials.get(material);
    if (known !== undefined) return known;
    const look = material as Material & Look;
    const { opacity, transparent, alphaTest, side } = look;
    const [baseColorTexture, normalTexture, emissiveTexture] = [look.map, look.normalMap, look.emissiveMap].map(
      (map) => (hasUvs ? this.#texture(map) : undefined),
    );
    const emissive = colorOf(look.emissive, 0);
    const written: GLTF.IMaterial = {
      ...named(look.name),
      pbrMetallicRoughness: {
        baseColorFactor: [...colorOf(look.color, 1), factor(opacity, 1)] as vec4,
        metallicFactor: factor(look.metalness, 0),
        roughnessFactor: factor(look.roughness, kRoughness),
        ...(baseColorTexture && { baseColorTexture }),
      },
      ...(normalTexture && { normalTexture: { ...normalTexture, scale: finite(look.normalScale?.x, 1) } }),
      ...(emissive.some((x) => x > 0) && { emissiveFactor: emissive }),
      ...(emissiveTexture && { emissiveTexture }),
      ...(transparent && { alphaMode: 'BLEND' as const }),
      ...(alphaTest > 0 && { alphaMode: 'MASK' as const, alphaCutoff: finite(alphaTest, 0.5) }),
      ...(side === DoubleSide && { doubleSided: true }),
    };
    const number = (this.#json.materials ??= []).push(written) - 1;
    materials.set(material, number);
    return number;
  }

  #texture(texture: Texture | null | undefined): GLTF.ITextureInfo | undefined {
    const bytes = (texture?.image as ImageBytes | undefined)?.bytes;
    const type = bytes && imageType(bytes);
    if (!texture || !bytes || !type) return undefined;
    let source = this.#images.get(bytes);
    source ??= (this.#json.images ??= []).push({ bufferView: this.#addView(bytes), mimeType: type }) - 1;
    this.#images.set(bytes, source);
    const [wrapS, wrapT] = [wraps.get(texture.wrapS), wraps.get(texture.wrapT)];
    const sampler =
      wrapS || wrapT
        ? (this.#json.samplers ??= []).push({ ...(wrapS && { wrapS }), ...(wrapT && { wrapT }) }) - 1
        : undefined;
    if (type === 'image/webp') this.#use(kWebp);
    const image = type === 'image/webp' ? { extensions: { [kWebp]: { source } } } : { source };
    const index = (this.#json.textures ??= []).push({ ...image, ...(sampler !== undefined && { sampler }) }) - 1;
    const scale = texture.repeat.toArray().map((x) => finite(x, 1)) as vec2;
    const [u, v] = texture.offset.toArray().map((x) => finite(x, 0)) as vec2;
    if (scale[0] === 1 && scale[1] === 1 && u === 0 && v === 0) return { index };
    this.#use(kTransform);
    // Its v points down.
    const transform = { scale, offset: [u, 1 - scale[1] - v] };
    return { index, extensions: { [kTransform]: transform } };
  }

  #use(extension: string): void {
    this.#json.extensionsUsed = [...new Set([...(this.#json.extensionsUsed ?? []), extension])];
  }
}
