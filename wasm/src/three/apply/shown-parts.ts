import { BufferAttribute, type BufferGeometry, type Material, type Mesh } from 'three';
import type { Mesh as Arrays, Classification } from '../../api/index.js';
import { show } from '../../core/error.js';
import { borderDistances } from '../../parts/border-distance.js';
import { decideAgain, type PreparedPart, withCopies } from '../../parts/prepare.js';
import { separatePaint, verticesOf } from '../../parts/split-part.js';
import { wrong } from '../errors.js';
import { makeOverlay, overlayMaterial, showTriangles } from '../materials/overlay-mesh.js';
import { paintAttribute } from '../materials/paint-shader.js';
import { canBePainted, originals, type Painting, paintOn } from '../materials/painted-materials.js';
import { zoneAttribute } from './attributes.js';
import { type Part, placePositions } from './extract-scene.js';
import { own } from './own-attributes.js';
import { atOnce, remake, replace } from './remake.js';
import { noteChange } from './writes.js';

/** A part of the target, and what is shown on it. */
export interface ShownPart extends PreparedPart {
  part: Part;
  /** 1 per triangle: whether it may be painted now. */
  cosmetic: Uint8Array;
  overlay?: Mesh | undefined;
}

/** The geometry of a part as it is now: three-vrm, for example, replaces those whose morph targets it combines. */
function geometryOf({ part, sources }: ShownPart): BufferGeometry {
  const geometry = part.mesh?.geometry ?? part.geometry;
  const [found, count] = [geometry.getAttribute('position').count, sources.length];
  if (found !== count)
    throw wrong(`the geometry of ${show(part.name)} has ${found} vertices, it had ${count}; transfer again`);
  return geometry;
}

/** Writes the zones of a classification, and decides which triangles may be painted. */
export function writeZones(
  shown: ShownPart,
  now: Pick<Classification, 'zones' | 'cosmeticTriangles'>,
  isOther: Uint8Array,
  indices: Arrays['indices'],
): void {
  const { zones, cosmeticTriangles } = decideAgain(shown, shown.part, indices, isOther, now);
  const attribute = geometryOf(shown).getAttribute(zoneAttribute) as BufferAttribute;
  attribute.array.set(zones);
  attribute.needsUpdate = true;
  shown.cosmetic = cosmeticTriangles;
}

/** Writes what the paint's shader reads. @param reach  The width of the soft border, as a share of `diagonal`. */
export function writePaint(parts: readonly ShownPart[], reach: number, diagonal: number): void {
  for (const shown of parts) splitAtPaint(shown);
  const distances = reach > 0 ? distancesOf(parts, reach * diagonal) : undefined;
  parts.forEach((shown, p) => {
    const { uvs, indices, cosmetic } = shown;
    const geometry = geometryOf(shown);
    const count = shown.sources.length;
    const isPainted = verticesOf(indices, cosmetic, count);
    const known = geometry.getAttribute(paintAttribute) as BufferAttribute | undefined;
    // One that came with the model's file may be laid out in another way.
    const isOwn = known?.isBufferAttribute && known.array.length === 4 * count && known.array instanceof Float32Array;
    const attribute = isOwn ? known : own(new BufferAttribute(new Float32Array(4 * count), 4));
    const values = attribute.array;
    for (let v = 0; v < count; ++v) {
      values[4 * v] = uvs[2 * v]!;
      values[4 * v + 1] = uvs[2 * v + 1]!;
      values[4 * v + 2] = 1 - isPainted[v]!;
      values[4 * v + 3] = 2 + (distances ? distances[p]![v]! / diagonal : 0);
    }
    attribute.needsUpdate = true;
    if (attribute !== known) geometry.setAttribute(paintAttribute, attribute);
  });
}

/** Splits vertices of a part where another classification needs it. */
function splitAtPaint(shown: ShownPart): void {
  const copies = separatePaint(shown.indices, shown.cosmetic, shown.sources.length);
  if (!copies) return;
  const geometry = geometryOf(shown);
  const known = { ...shown, sources: Uint32Array.from(shown.sources.keys()), copies: 0, cut: undefined };
  const remade = atOnce(remake(geometry, withCopies(known, copies), 0));
  if (remade) replace(geometry, remade);
  noteChange(geometry);
  Object.assign(shown, withCopies(shown, copies));
}

function distancesOf(parts: readonly ShownPart[], reach: number): Float32Array[] {
  const firsts: number[] = [];
  let vertices = 0;
  let corners = 0;
  for (const { sources, indices } of parts) {
    firsts.push(vertices);
    vertices += sources.length;
    corners += indices.length;
  }
  const positions = new Float32Array(3 * vertices);
  const indices = new Uint32Array(corners);
  const cosmetic = new Uint8Array(corners / 3);
  let corner = 0;
  parts.forEach((shown, p) => {
    const { part, sources } = shown;
    const range = { mesh: undefined, firstVertex: firsts[p]!, vertexCount: sources.length };
    placePositions({ geometry: geometryOf(shown), matrix: part.matrix, ...range }, positions);
    cosmetic.set(shown.cosmetic, corner / 3);
    for (const vertex of shown.indices) indices[corner++] = firsts[p]! + vertex;
  });
  const all = borderDistances(positions, indices, cosmetic, reach);
  return parts.map(({ sources }, p) => all.subarray(firsts[p]!, firsts[p]! + sources.length));
}

/** Shows the given material on the painted triangles of a part. */
export function showMaterial(shown: ShownPart, material: Material): void {
  const { mesh } = shown.part;
  if (!mesh) return;
  shown.overlay ??= makeOverlay(shown.part, mesh, material);
  showTriangles(shown.overlay, mesh, shown.indices, shown.cosmetic);
}

/**
 * Paints the materials of a part, and lays an overlay over those that cannot be painted.
 * @param copies  Copies that were made of materials, by the material; more may be added.
 * @param paints  Whether materials are painted. Those that are without a texture show it as soon as there is one.
 * @returns the materials that are painted, which are none if no triangle is.
 */
export function showPaint(
  shown: ShownPart,
  painting: Painting,
  copies: Map<Material, Material>,
  paints: boolean,
): Material[] {
  const { mesh } = shown.part;
  if (!mesh) return [];
  // Three.js draws nothing where a list of materials has a gap.
  const materials: (Material | undefined)[] = [mesh.material].flat();
  const hasPaint = materials.map((material, m) => paints && material !== undefined && hasTriangles(shown, m));
  const isBlind = materials.map((material, m) => hasPaint[m]! && !canBePainted(material!));
  const needsOverlay = painting.texture && isBlind.includes(true);
  if (needsOverlay) {
    shown.overlay ??= makeOverlay(shown.part, mesh, overlayMaterial(materials[isBlind.indexOf(true)]!));
    // Each time, for the texture may be another.
    shown.overlay.material = paintOn(shown.overlay.material as Material, painting, true);
  }
  if (shown.overlay) {
    const triangles = needsOverlay ? blindTriangles(shown, isBlind) : new Uint8Array(0);
    showTriangles(shown.overlay, mesh, shown.indices, triangles);
  }
  const isPainted = hasPaint.map((has, m) => has && !isBlind[m]);
  if (!isPainted.includes(true)) return [];
  const painted = materials.map((material, m) => {
    if (!material || !isPainted[m]) return material;
    const one = paintOn(copies.get(material) ?? material, painting);
    const original = originals.get(one);
    if (original) copies.set(original, one);
    return one;
  });
  if (Array.isArray(mesh.material))
    mesh.material = painted.every((one, m) => one === materials[m]) ? mesh.material : (painted as Material[]);
  else mesh.material = painted[0]!;
  return painted.filter((one, m): one is Material => one !== undefined && isPainted[m]!);
}

/** Whether triangles with a material of a part may be painted. */
function hasTriangles({ part: { mesh }, cosmetic }: ShownPart, m: number): boolean {
  if (!Array.isArray(mesh!.material)) return cosmetic.includes(1);
  return mesh!.geometry.groups.some(
    ({ start, count, materialIndex = 0 }) =>
      materialIndex === m && cosmetic.subarray(start / 3, (start + count) / 3).includes(1),
  );
}

/** Which of the painted triangles have a material that cannot be painted. */
function blindTriangles({ part: { mesh }, cosmetic }: ShownPart, isBlind: readonly boolean[]): Uint8Array {
  if (!Array.isArray(mesh!.material)) return cosmetic;
  const out = new Uint8Array(cosmetic.length);
  for (const { start, count, materialIndex = 0 } of mesh!.geometry.groups) {
    if (!isBlind[materialIndex]) continue;
    const [from, to] = [start / 3, Math.min((start + count) / 3, cosmetic.length)];
    for (let t = from; t < to; ++t) out[t] = cosmetic[t]!;
  }
  return out;
}
