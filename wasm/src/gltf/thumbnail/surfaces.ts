import type { GLTF } from '@gltf-transform/core';
import type { CagecastError } from '../../api/index.js';
import { checkImage, type Image } from '../../bake/image.js';
import { opaque } from '../../bake/small-image.js';
import { inverted, type Matrix } from '../../parts/affine.js';
import { movePoints } from '../../parts/points.js';
import { decodeFloats } from '../../scene/accessor.js';
import { laidUvs, remembered } from '../../scene/base-colors.js';
import type { Part } from '../../scene/extract.js';
import { firstLine } from '../../scene/input-error.js';
import type { ImageCodec } from '../../scene/materials.js';
import { Materials, unlitExtension } from '../../scene/materials.js';
import { isMirrored } from '../../scene/matrix.js';
import type { GltfFile } from '../open-gltf.js';
import { Texture } from './texture.js';

/** A part of a model, and what it looks like. */
export interface Surface {
  /** 3 per vertex, in the space of the picture. */
  positions: Float32Array;
  /** 3 per triangle, counter-clockwise from its front. */
  indices: Uint32Array;
  /** 3 per vertex, of any length. Without them, triangles are flat. */
  normals: Float32Array | undefined;
  texture: Texture | undefined;
  /** 2 per vertex, where it is in the texture. */
  uvs: Float32Array | undefined;
  /** Colours of the vertices, in linear light, and how many numbers each has. */
  colors: { values: Float32Array; size: number } | undefined;
  /** By which colours are multiplied, in linear light, and alpha. */
  factor: readonly number[];
  mode: GLTF.MaterialAlphaMode;
  /** From which alpha on something is there, if the mode is MASK. */
  cutoff: number;
  doubleSided: boolean;
  unlit: boolean;
}

/**
 * What the parts of a file look like.
 * @param undecoded  Gets a line for each texture that is not shown: its name, and why.
 * @throws {CagecastError} `unsupported` if `decode` does.
 */
export async function surfacesOf(
  file: GltfFile,
  parts: readonly Part[],
  decode: ImageCodec['decode'],
  undecoded: string[],
): Promise<Surface[]> {
  const model = new Materials(file, parts);
  const imageOf = remembered(async (texture: number): Promise<Image | undefined> => {
    const { name = `textures[${texture}]` } = file.json.textures![texture]!;
    try {
      const found = await file.imageOf(texture);
      if (!found) throw new Error('it has no image');
      return checkImage('decode', 'its result', await decode(found.bytes, found.mimeType));
    } catch (error) {
      if ((error as Partial<CagecastError>).code === 'unsupported') throw error;
      undecoded.push(`${name}: ${firstLine(error)}`);
      return undefined;
    }
  });
  const textureOf = (isOpaque: boolean) =>
    remembered(async (number: number) => {
      const image = await imageOf(number);
      const use = image && (isOpaque ? opaque(image) : image);
      return use && new Texture(use, model.wrapsOf(number));
    });
  const [opaqueOf, clearOf] = [textureOf(true), textureOf(false)];
  return Promise.all(
    parts.map(async (part): Promise<Surface> => {
      const number = model.materialOf(part);
      const material = file.json.materials?.[number ?? -1] ?? {};
      const { alphaMode: mode = 'OPAQUE', alphaCutoff: cutoff = 0.5, doubleSided = false } = material;
      const use = number === undefined ? undefined : model.useOf(number, 'color');
      const uvs = use && laidUvs(model, part, use);
      const normals = model.attributeOf(part, 'NORMAL');
      return {
        positions: movePoints(part.matrix, part.localPositions, new Float32Array(part.localPositions.length)),
        indices: isMirrored(part.matrix) ? turned(part.localIndices) : part.localIndices,
        normals: normals && movedNormals(part.matrix, decodeFloats(normals)),
        texture: uvs && (await (mode === 'OPAQUE' ? opaqueOf : clearOf)(use!.texture)),
        uvs,
        colors: model.colorsOf(part, 'COLOR_0'),
        factor: material.pbrMetallicRoughness?.baseColorFactor ?? [1, 1, 1, 1],
        mode,
        cutoff,
        doubleSided,
        unlit: material.extensions?.[unlitExtension] !== undefined,
      };
    }),
  );
}

/** Triangles that go round the other way. */
const turned = (indices: Uint32Array): Uint32Array =>
  indices.map((_, i) => indices[i % 3 === 0 ? i : i % 3 === 1 ? i + 1 : i - 1]!);

/** Normals in another space, of any length. */
function movedNormals(matrix: Matrix, normals: Float32Array): Float32Array | undefined {
  const back = inverted(matrix);
  if (!back) return undefined;
  const out = new Float32Array(normals.length);
  // By the transpose of the inverse.
  for (let i = 0; i < normals.length; i += 3)
    for (let k = 0; k < 3; ++k)
      out[i + k] = back[4 * k]! * normals[i]! + back[4 * k + 1]! * normals[i + 1]! + back[4 * k + 2]! * normals[i + 2]!;
  return out;
}
