import {
  type Accessor,
  type Document,
  type Material,
  type Primitive,
  type Texture,
  TextureInfo,
} from '@gltf-transform/core';
import type { Transform } from '@gltf-transform/extensions';
import { type Pixels, readPixels, writePng } from './pixels';
import { Unwrapped, type Wrap } from './unwrapped';

const kLeastSide = 1024; // texels, longer side
const kMostSide = 2048;

/** If more triangles than this have no area in the texture, it is a palette, which cannot hold paint. */
const kMostFlat = 0.1; // of the painted triangles
const kFlat = 0.01; // texels
/** A texture that is repeated more often than this is a pattern; mirrored halves use it twice at most. */
const kMostRepeats = 2.5;
const kMostOverlapping = 0.6; // of the paint; the same for a part of the texture

/** Summary of the baking. */
export interface Baked {
  /** Number of painted textures. */
  textures: number;
  /** Names of the parts that keep their overlay, for lack of a suitable texture. */
  overlays: string[];
  /** Share of the paint that was left out, because several parts of the surface use the same texels. */
  overlapping: number;
}

/** A primitive of the model, and its overlay if anything is painted. */
interface Surface {
  name: string;
  base: Primitive;
  overlay: Primitive | undefined;
}

/** A texture with a base colour factor, and the materials and surfaces that use it. */
interface Sheet {
  texture: Texture;
  factor: [number, number, number];
  materials: Set<Material>;
  surfaces: Surface[];
}

/**
 * Bakes overlays into the textures of the primitives below, using their own UVs, and removes the overlays. A primitive keeps its
 * overlay if it has no texture, no UVs for it, vertex colours, or UVs that are not an unwrapping.
 * @param document  The output of `cagecast`.
 * @param isOverlay Whether a material belongs to an overlay.
 * @param paint     In the cage's UVs.
 */
export async function paintIntoTextures(
  document: Document,
  isOverlay: (material: Material) => boolean,
  paint: Pixels,
): Promise<Baked> {
  const surfaces = listSurfaces(document, isOverlay);
  const baked: Baked = { textures: 0, overlays: [], overlapping: 0 };
  for (const sheet of listSheets(surfaces)) {
    const unwrapped = await paintSheet(document, sheet, paint);
    if (!unwrapped) continue;
    baked.textures++;
    baked.overlapping = Math.max(baked.overlapping, unwrapped.overlapping);
    for (const surface of sheet.surfaces) {
      surface.overlay?.dispose();
      surface.overlay = undefined;
    }
  }
  baked.overlays = surfaces.flatMap(({ name, overlay }) => (overlay ? [name] : []));
  if (baked.overlays.length === 0) dropOverlays(document, isOverlay);
  return baked;
}

function listSurfaces(document: Document, isOverlay: (material: Material) => boolean): Surface[] {
  const isOverlayOn = (primitive: Primitive): boolean =>
    primitive.getMaterial() !== null && isOverlay(primitive.getMaterial()!);
  const nodes = document.getRoot().listNodes();
  return document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => {
      const primitives = mesh.listPrimitives();
      const overlays = new Map(
        primitives.filter(isOverlayOn).map((overlay) => [overlay.getAttribute('TEXCOORD_0'), overlay]),
      );
      const bases = primitives.filter((primitive) => !isOverlayOn(primitive));
      const name = nodes.find((node) => node.getMesh() === mesh)?.getName() || mesh.getName() || 'a part';
      return bases.map((base) => {
        // An overlay shares the accessor of the cage's UVs with its primitive.
        const overlay = base
          .listAttributes()
          .map((attribute) => overlays.get(attribute))
          .find((found) => found);
        return { name: bases.length > 1 ? `${name}/${base.getMaterial()?.getName()}` : name, base, overlay };
      });
    });
}

/** The textures that can be painted, with all surfaces that use them, painted or not. */
function listSheets(surfaces: readonly Surface[]): Sheet[] {
  const sheets = new Map<string, Sheet>();
  const numbers = new Map<Texture, number>();
  const materials = new Set(surfaces.flatMap(({ base }) => base.getMaterial() ?? []));
  for (const material of materials) {
    const texture = material.getBaseColorTexture();
    const users = surfaces.filter(({ base }) => base.getMaterial() === material);
    if (!texture || users.some(({ base }) => !uvsOf(base, material) || base.getAttribute('COLOR_0'))) continue;
    const [r, g, b] = material.getBaseColorFactor();
    if (!numbers.has(texture)) numbers.set(texture, numbers.size);
    const key = [numbers.get(texture), r, g, b].join(' ');
    const sheet = sheets.get(key) ?? { texture, factor: [r, g, b], materials: new Set(), surfaces: [] };
    sheet.materials.add(material);
    sheet.surfaces.push(...users);
    sheets.set(key, sheet);
  }
  return [...sheets.values()].filter((sheet) => sheet.surfaces.some(({ overlay }) => overlay));
}

/** Paints a copy of the texture for the materials of a sheet. @returns Undefined if it cannot be painted. */
async function paintSheet(
  document: Document,
  { texture, factor, materials, surfaces }: Sheet,
  paint: Pixels,
): Promise<Unwrapped | undefined> {
  const image = texture.getImage();
  const pixels =
    image &&
    (await readPixels(new Blob([image as Uint8Array<ArrayBuffer>], { type: texture.getMimeType() }), fitSize).catch(
      () => undefined,
    ));
  if (!pixels) return undefined;
  const layouts = surfaces.map(layoutOf);
  const density = densityOf(layouts, pixels, paint);
  if (density === undefined) return undefined;

  const info = [...materials][0]!.getBaseColorTextureInfo()!;
  const unwrapped = new Unwrapped(pixels, [wrapOf(info.getWrapS()), wrapOf(info.getWrapT())], paint, density);
  // By orientation, so that one of two mirrored halves is painted completely.
  for (const way of [1, -1]) {
    for (const layout of layouts) {
      layout.painted.forEach((isPainted, triangle) => {
        const own = cornersOf(layout, layout.own, triangle);
        if (Math.sign(areaOf(own)) === way)
          unwrapped.draw(own, isPainted ? cornersOf(layout, layout.cage, triangle) : undefined);
      });
    }
  }
  if (unwrapped.overlapping > kMostOverlapping) return undefined;
  unwrapped.blendInto(pixels, factor);

  const painted = document
    .createTexture(texture.getName())
    .setMimeType('image/png')
    .setImage(await writePng(pixels));
  for (const material of materials)
    material.setBaseColorTexture(painted).setBaseColorFactor([1, 1, 1, material.getBaseColorFactor()[3]]);
  if (texture.listParents().every((parent) => parent.propertyType === 'Root')) texture.dispose();
  return unwrapped;
}

function fitSize(width: number, height: number): [number, number] {
  const longer = Math.max(width, height);
  const scale = Math.max(kLeastSide, Math.min(kMostSide, longer)) / longer;
  return [Math.max(1, Math.round(scale * width)), Math.max(1, Math.round(scale * height))];
}

const { CLAMP_TO_EDGE, MIRRORED_REPEAT } = TextureInfo.WrapMode as Record<string, number>;
const wrapOf = (wrap: number): Wrap =>
  wrap === CLAMP_TO_EDGE ? 'clamp' : wrap === MIRRORED_REPEAT ? 'mirror' : 'repeat';

/** The triangles of a surface in its own UVs and in the cage's. */
interface Layout {
  /** 3 per triangle. */
  corners: ArrayLike<number>;
  /** 2 per vertex. */
  own: Float64Array;
  /** 2 per vertex; empty if nothing is painted. */
  cage: Float64Array;
  /** 1 per triangle. */
  painted: Uint8Array;
}

function layoutOf({ base, overlay }: Surface): Layout {
  const material = base.getMaterial()!;
  const uvs = uvsOf(base, material)!;
  const own = transformed(material, floatsOf(uvs));
  const corners = base.getIndices()?.getArray() ?? Uint32Array.from({ length: uvs.getCount() }, (_, vertex) => vertex);
  const painted = new Uint8Array(corners.length / 3);
  const some = overlay?.getIndices()?.getArray() ?? [];
  let next = 0;
  for (let triangle = 0; triangle < painted.length && next < some.length; triangle++) {
    // The overlay has a subset of the triangles, in the same order.
    if ([0, 1, 2].some((corner) => some[next + corner] !== corners[3 * triangle + corner])) continue;
    painted[triangle] = 1;
    next += 3;
  }
  return { corners, own, cage: overlay ? floatsOf(overlay.getAttribute('TEXCOORD_0')!) : new Float64Array(0), painted };
}

/** The UVs of a triangle's corners: 6 numbers. */
function cornersOf({ corners }: Layout, uvs: Float64Array, triangle: number): Six {
  const [a, b, c] = [2 * corners[3 * triangle]!, 2 * corners[3 * triangle + 1]!, 2 * corners[3 * triangle + 2]!];
  return [uvs[a]!, uvs[a + 1]!, uvs[b]!, uvs[b + 1]!, uvs[c]!, uvs[c + 1]!];
}

type Six = [number, number, number, number, number, number];

/** All values of an accessor, with normalised integers decoded. */
function floatsOf(accessor: Accessor): Float64Array {
  const size = accessor.getElementSize();
  const out = new Float64Array(size * accessor.getCount());
  const element: number[] = [];
  for (let i = 0; i < accessor.getCount(); i++) out.set(accessor.getElement(i, element), size * i);
  return out;
}

/** A primitive's UVs for its own texture. */
function uvsOf(primitive: Primitive, material: Material): Accessor | null {
  const info = material.getBaseColorTextureInfo()!;
  return primitive.getAttribute(`TEXCOORD_${transformOf(info)?.getTexCoord() ?? info.getTexCoord()}`);
}

const transformOf = (info: TextureInfo): Transform | null => info.getExtension<Transform>('KHR_texture_transform');

/** Applies `KHR_texture_transform` in place. @returns The same array. */
function transformed(material: Material, uvs: Float64Array): Float64Array {
  const transform = transformOf(material.getBaseColorTextureInfo()!);
  if (!transform) return uvs;
  const [[left, top], [width, height], turn] = [transform.getOffset(), transform.getScale(), transform.getRotation()];
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  for (let at = 0; at < uvs.length; at += 2) {
    const [u, v] = [width * uvs[at]!, height * uvs[at + 1]!];
    uvs[at] = left + cos * u + sin * v;
    uvs[at + 1] = top - sin * u + cos * v;
  }
  return uvs;
}

/** Signed area, as a share of the texture; negative if mirrored. */
const areaOf = ([u0, v0, u1, v1, u2, v2]: Six): number => 0.5 * ((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0));

/** Texels of the paint per texel of the texture, in one direction. @returns Undefined if the UVs are not an unwrapping. */
function densityOf(layouts: readonly Layout[], texture: Pixels, paint: Pixels): number | undefined {
  const texels = texture.width * texture.height;
  let [laid, flat, count, own, cage] = [0, 0, 0, 0, 0];
  for (const layout of layouts) {
    layout.painted.forEach((isPainted, triangle) => {
      const area = Math.abs(areaOf(cornersOf(layout, layout.own, triangle)));
      laid += area;
      if (!isPainted) return;
      count++;
      if (area * texels < kFlat) flat++;
      own += area * texels;
      cage += Math.abs(areaOf(cornersOf(layout, layout.cage, triangle))) * paint.width * paint.height;
    });
  }
  return laid > kMostRepeats || flat > kMostFlat * count || own === 0 ? undefined : Math.sqrt(cage / own);
}

function dropOverlays(document: Document, isOverlay: (material: Material) => boolean): void {
  for (const material of document.getRoot().listMaterials().filter(isOverlay)) {
    const texture = material.getBaseColorTexture();
    material.dispose();
    if (texture?.listParents().every((parent) => parent.propertyType === 'Root')) texture.dispose();
  }
}
