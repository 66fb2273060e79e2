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

const kLeastSide = 1024; // texels, of the longer side
const kMostSide = 2048;

/** More triangles than this without area in the texture, and it is a palette, which has no room for paint. */
const kMostFlat = 0.1; // of the painted triangles
const kFlat = 0.01; // texels
/** A texture that is laid over the surface more often than this is a pattern: mirrored halves lay it twice at most. */
const kMostLaid = 2.5;
const kMostCrowded = 0.6; // of the paint: the same, of a part of the texture

/** What became of the paint. */
export interface Baked {
  /** Textures that have it now. */
  textures: number;
  /** What still has it as an overlay, for want of a texture that can hold it. */
  overlays: string[];
  /** What share of the paint has no place, as several places of the surface have the same texels. */
  crowded: number;
}

/** A part of the model, and the overlay on it, if there is anything to paint. */
interface Surface {
  name: string;
  base: Primitive;
  overlay: Primitive | undefined;
}

/** A texture, as materials of the same colour have it, and what it lies on. */
interface Sheet {
  texture: Texture;
  factor: [number, number, number];
  materials: Set<Material>;
  surfaces: Surface[];
}

/**
 * Paints what overlays show into the textures of the parts that they lie on, by the parts' own UVs, and takes those overlays
 * away. A part keeps its overlay if it has no texture, no UVs for it, colours at its vertices, or UVs that are no unwrapping.
 * @param document  As `cagecast` left it.
 * @param isOverlay Tells its overlays by their material.
 * @param paint     In the cage's UVs.
 */
export async function paintIntoTextures(
  document: Document,
  isOverlay: (material: Material) => boolean,
  paint: Pixels,
): Promise<Baked> {
  const surfaces = listSurfaces(document, isOverlay);
  const baked: Baked = { textures: 0, overlays: [], crowded: 0 };
  for (const sheet of listSheets(surfaces)) {
    const unwrapped = await paintSheet(document, sheet, paint);
    if (!unwrapped) continue;
    baked.textures++;
    baked.crowded = Math.max(baked.crowded, unwrapped.crowded);
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
  const isLaid = (primitive: Primitive): boolean =>
    primitive.getMaterial() !== null && isOverlay(primitive.getMaterial()!);
  const nodes = document.getRoot().listNodes();
  return document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => {
      const primitives = mesh.listPrimitives();
      const overlays = new Map(
        primitives.filter(isLaid).map((overlay) => [overlay.getAttribute('TEXCOORD_0'), overlay]),
      );
      const bases = primitives.filter((primitive) => !isLaid(primitive));
      const name = nodes.find((node) => node.getMesh() === mesh)?.getName() || mesh.getName() || 'a part';
      return bases.map((base) => {
        // An overlay shares the cage's UVs with the primitive that it lies on.
        const overlay = base
          .listAttributes()
          .map((attribute) => overlays.get(attribute))
          .find((found) => found);
        return { name: bases.length > 1 ? `${name}/${base.getMaterial()?.getName()}` : name, base, overlay };
      });
    });
}

/** The textures that can be painted, with all that they lie on: also what stays bare has its texels. */
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

/** Gives a sheet's materials a painted copy of their texture. @returns Nothing if it cannot be painted. */
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
  const layouts = surfaces.map(layOut);
  const density = densityOf(layouts, pixels, paint);
  if (density === undefined) return undefined;

  const info = [...materials][0]!.getBaseColorTextureInfo()!;
  const unwrapped = new Unwrapped(pixels, [wrapOf(info.getWrapS()), wrapOf(info.getWrapT())], paint, density);
  // What is seen one way round first, so that of mirrored halves one is painted whole.
  for (const way of [1, -1]) {
    for (const layout of layouts) {
      layout.painted.forEach((isPainted, triangle) => {
        const own = cornersOf(layout, layout.own, triangle);
        if (Math.sign(areaOf(own)) === way)
          unwrapped.draw(own, isPainted ? cornersOf(layout, layout.cage, triangle) : undefined);
      });
    }
  }
  if (unwrapped.crowded > kMostCrowded) return undefined;
  unwrapped.layOver(pixels, factor);

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

/** The triangles of a surface as they lie in its own texture, and in the cage's. */
interface Layout {
  /** 3 per triangle. */
  corners: ArrayLike<number>;
  /** 2 per vertex. */
  own: Float64Array;
  /** 2 per vertex; none if nothing is painted. */
  cage: Float64Array;
  /** 1 per triangle. */
  painted: Uint8Array;
}

function layOut({ base, overlay }: Surface): Layout {
  const material = base.getMaterial()!;
  const uvs = uvsOf(base, material)!;
  const own = placeBy(material, floatsOf(uvs));
  const corners = base.getIndices()?.getArray() ?? Uint32Array.from({ length: uvs.getCount() }, (_, vertex) => vertex);
  const painted = new Uint8Array(corners.length / 3);
  const some = overlay?.getIndices()!.getArray() ?? [];
  let next = 0;
  for (let triangle = 0; triangle < painted.length && next < some.length; triangle++) {
    // The painted triangles are some of all, in the same order.
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

/** All values of an accessor, those decoded that are normalised. */
function floatsOf(accessor: Accessor): Float64Array {
  const size = accessor.getElementSize();
  const out = new Float64Array(size * accessor.getCount());
  const element: number[] = [];
  for (let i = 0; i < accessor.getCount(); i++) out.set(accessor.getElement(i, element), size * i);
  return out;
}

/** The UVs that a primitive has for its own texture. */
function uvsOf(primitive: Primitive, material: Material): Accessor | null {
  const info = material.getBaseColorTextureInfo()!;
  return primitive.getAttribute(`TEXCOORD_${transformOf(info)?.getTexCoord() ?? info.getTexCoord()}`);
}

const transformOf = (info: TextureInfo): Transform | null => info.getExtension<Transform>('KHR_texture_transform');

/** Moves UVs as the material says: `KHR_texture_transform`. @returns The same array. */
function placeBy(material: Material, uvs: Float64Array): Float64Array {
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

/** In shares of the texture; negative where it is seen mirrored. */
const areaOf = ([u0, v0, u1, v1, u2, v2]: Six): number => 0.5 * ((u1 - u0) * (v2 - v0) - (u2 - u0) * (v1 - v0));

/** How many texels of the paint come to one of the texture, along a side. @returns Nothing if the UVs are no unwrapping. */
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
  return laid > kMostLaid || flat > kMostFlat * count || own === 0 ? undefined : Math.sqrt(cage / own);
}

function dropOverlays(document: Document, isOverlay: (material: Material) => boolean): void {
  for (const material of document.getRoot().listMaterials().filter(isOverlay)) {
    const texture = material.getBaseColorTexture();
    material.dispose();
    if (texture?.listParents().every((parent) => parent.propertyType === 'Root')) texture.dispose();
  }
}
