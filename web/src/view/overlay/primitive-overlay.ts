import type { Classification, CutTarget, SplitVertices } from 'cagecast';
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  type Material,
  type Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  SRGBColorSpace,
  type Texture,
} from 'three';
import { cutGeometry } from '#three';
import { reverseWinding } from '../../loading/extract-mesh';
import { disposeAfterFrame } from '../../platform/programs';
import type { Primitive } from '../../state/model';
import type { Decision } from '../../state/study/baselines';
import { kZones } from '../../state/zones';
import {
  copyVertices,
  detachShared,
  kZoneNumbers,
  overlayMesh,
  shareVertices,
  shifted,
  sortByZone,
  zonesOfTriangles,
} from './geometry';
import type { Look } from './looks';
import { clayMaterial, colorMaterial, hiddenMaterial, onSurface, paintMaterial, zoneMaterial } from './materials';

// The transferred UVs use a channel that glTF models leave free, so that the base maps keep theirs.
const kUvChannel = 3;
const kUvName = `uv${kUvChannel}`;

/** Linear light × 65535 for each sRGB byte. */
const kLinear = Uint16Array.from({ length: 256 }, (_, byte) =>
  Math.round(65535 * new Color().setRGB(byte / 255, 0, 0, SRGBColorSpace).r),
);

const kExcludedZones = [1, 2, 3] as const;

/** The overlay on one mesh of the target. */
export class PrimitiveOverlay {
  readonly #primitive: Primitive;
  /** The corners of its triangles: as vertices of the target, and of the filtered mesh. */
  readonly #vertices: Uint32Array;
  #corners = new Uint32Array(0);
  readonly #naive: Mesh;
  readonly #filtered: Mesh;
  /** Replaces the filtered mesh while the target is cut. */
  #cut: Mesh | undefined;
  #colored: Mesh | undefined;
  /** What other ways to transfer paint. */
  readonly #halves: { left?: Mesh | undefined; right?: Mesh | undefined } = {};
  #look: Look = 'bare';
  readonly #paint: MeshStandardMaterial;
  readonly #nothing = new MeshBasicMaterial({ visible: false });
  readonly #zoneMaterials = kExcludedZones.map((zone) => zoneMaterial(kZones[zone].color));
  readonly #clay = clayMaterial();
  readonly #checker = onSurface(new MeshStandardMaterial({ roughness: 0.9 }));
  readonly #vertexColors = colorMaterial();
  readonly #hidden = kExcludedZones.map((zone) => hiddenMaterial(kZones[zone].color));

  constructor(primitive: Primitive, indices: Uint32Array, paint: Texture | undefined) {
    this.#primitive = primitive;
    const { mesh, firstTriangle, triangleCount } = primitive;
    this.#vertices = indices.subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount));
    this.#paint = paintMaterial([mesh.material].flat()[0]!);
    if (paint) this.setPaint(paint);
    this.#naive = overlayMesh(mesh, new BufferGeometry());
    this.#naive.material = this.#paint;
    this.#filtered = overlayMesh(mesh, new BufferGeometry());
    mesh.add(this.#naive, this.#filtered);
  }

  /** Rebuilds the geometries. Materials are kept, as compiling a shader takes longer than a frame. */
  setProjection(uvs: Float32Array, split: SplitVertices): void {
    const { mesh, firstVertex, vertexCount } = this.#primitive;
    const { geometry: filtered, corners } = this.#splitAt(split);
    this.#corners = corners;
    const naive = shareVertices(mesh.geometry);
    naive.setAttribute(kUvName, new BufferAttribute(uvs.slice(2 * firstVertex, 2 * (firstVertex + vertexCount)), 2));
    detachShared(naive, mesh.geometry);
    filtered.setIndex(new BufferAttribute(new Uint32Array(corners.length), 1));
    this.#replaceGeometry(this.#naive, naive);
    this.#replaceGeometry(this.#filtered, filtered);
    this.clearCut();
    this.#clearColored();
  }

  /** A copy of the mesh, split at the seams of the texture, and the vertices of its corners. */
  #splitAt(split: SplitVertices): { geometry: BufferGeometry; corners: Uint32Array<ArrayBuffer> } {
    const { mesh, firstVertex, firstTriangle, triangleCount, mirrored } = this.#primitive;
    const [from, to] = [3 * firstTriangle, 3 * (firstTriangle + triangleCount)];
    // Split vertices are in order of use: those of a primitive are contiguous.
    const first = split.indices[from]!;
    const corners = shifted(split.indices.subarray(from, to), first);
    let count = 0;
    for (const vertex of corners) count = Math.max(count, vertex + 1);
    const geometry = copyVertices(mesh.geometry, shifted(split.sources.subarray(first, first + count), firstVertex));
    geometry.setAttribute(kUvName, new BufferAttribute(split.uvs.slice(2 * first, 2 * (first + count)), 2));
    // The overlay is a child of the mesh: the renderer reverses mirrored windings itself.
    if (mirrored) reverseWinding(corners);
    return { geometry, corners };
  }

  /** Sets what the look of a half paints; undefined: nothing. */
  setHalf(half: 'left' | 'right', decision: Decision | undefined): void {
    this.#halves[half]?.removeFromParent();
    this.#halves[half]?.geometry.dispose();
    this.#halves[half] = undefined;
    if (!decision) return;
    const { mesh, firstTriangle } = this.#primitive;
    const { geometry, corners } = this.#splitAt(decision.split);
    const isPainted = (corner: number): boolean =>
      decision.cosmeticTriangles[firstTriangle + Math.floor(corner / 3)] === 1;
    geometry.setIndex(
      new BufferAttribute(
        corners.filter((_, corner) => isPainted(corner)),
        1,
      ),
    );
    const shown = overlayMesh(mesh, geometry);
    shown.material = this.#paint;
    shown.visible = this.#look === half;
    mesh.add(shown);
    this.#halves[half] = shown;
  }

  /** Shows the filtered paint on the cut target. */
  setCut(cut: CutTarget): void {
    const { mesh } = this.#primitive;
    const geometry = shareVertices(mesh.geometry);
    geometry.morphAttributes = { ...geometry.morphAttributes }; // a copy, as `cutGeometry` replaces entries
    const { uvs, indices, zones, cosmeticTriangles } = cutGeometry(geometry, this.#primitive, cut);
    geometry.setAttribute(kUvName, new BufferAttribute(uvs, 2));
    geometry.setIndex(new BufferAttribute(new Uint32Array(indices.length), 1));
    sortByZone(geometry, indices, zonesOfTriangles(cosmeticTriangles, zones, indices));
    detachShared(geometry, mesh.geometry);
    this.clearCut();
    this.#cut = overlayMesh(mesh, geometry);
    mesh.add(this.#cut);
    this.show(this.#look);
  }

  /** Shows the primitive's own triangles again. */
  clearCut(): void {
    if (!this.#cut) return;
    this.#cut.removeFromParent();
    this.#cut.geometry.dispose();
    this.#cut = undefined;
    this.show(this.#look);
  }

  #replaceGeometry(mesh: Mesh, geometry: BufferGeometry): void {
    mesh.geometry.dispose();
    mesh.geometry = geometry;
  }

  /** The next `setColors` rebuilds it. */
  #clearColored(): void {
    this.#colored?.removeFromParent();
    this.#colored?.geometry.dispose();
    this.#colored = undefined;
  }

  classify({ zones, cosmeticTriangles }: Classification): void {
    const { firstTriangle, triangleCount } = this.#primitive;
    const cosmetic = cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount);
    sortByZone(this.#filtered.geometry, this.#corners, zonesOfTriangles(cosmetic, zones, this.#vertices));
  }

  setPaint(paint: Texture): void {
    paint.channel = kUvChannel;
    this.#paint.map = paint;
  }

  setChecker(checker: Texture): void {
    checker.channel = kUvChannel;
    this.#checker.map = checker;
  }

  setColors(colors: Uint8Array): void {
    const { mesh, firstTriangle, firstVertex, triangleCount, mirrored } = this.#primitive;
    if (!this.#colored) {
      const geometry = copyVertices(mesh.geometry, shifted(this.#vertices, firstVertex));
      if (mirrored) {
        const corners = Uint32Array.from({ length: 3 * triangleCount }, (_, corner) => corner);
        reverseWinding(corners);
        geometry.setIndex(new BufferAttribute(corners, 1));
      }
      geometry.setAttribute('color', new BufferAttribute(new Uint16Array(9 * triangleCount), 3, true));
      this.#colored = overlayMesh(mesh, geometry);
      this.#colored.material = this.#vertexColors;
      this.#colored.visible = false;
      mesh.add(this.#colored);
    }
    const attribute = this.#colored.geometry.getAttribute('color') as BufferAttribute;
    const { array } = attribute;
    const from = 9 * firstTriangle;
    for (let i = 0; i < array.length; i++) array[i] = kLinear[colors[from + i]!]!;
    attribute.needsUpdate = true;
  }

  show(look: Look): void {
    this.#look = look;
    this.#naive.visible = look === 'naive';
    if (this.#colored) this.#colored.visible = look === 'colors';
    for (const half of ['left', 'right'] as const) if (this.#halves[half]) this.#halves[half].visible = look === half;
    const materials = this.#materials(look);
    this.#filtered.visible = false;
    const filtered = this.#cut ?? this.#filtered;
    filtered.visible = materials.length > 0;
    filtered.material = materials;
  }

  /** Of the filtered mesh. Groups without a material are not drawn. */
  #materials(look: Look): Material[] {
    switch (look) {
      case 'result':
        return [this.#paint];
      case 'zones':
        return [this.#nothing, ...this.#zoneMaterials, ...this.#hidden.map(() => this.#nothing), this.#clay];
      case 'allZones':
        return [this.#nothing, ...this.#zoneMaterials, ...this.#hidden, this.#clay];
      case 'checker':
        return kZoneNumbers.map(() => this.#checker);
      default:
        return [];
    }
  }

  dispose(): void {
    this.clearCut();
    this.#clearColored();
    for (const half of ['left', 'right'] as const) this.setHalf(half, undefined);
    for (const mesh of [this.#naive, this.#filtered]) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    disposeAfterFrame([
      this.#paint,
      this.#nothing,
      this.#clay,
      this.#checker,
      this.#vertexColors,
      ...this.#zoneMaterials,
      ...this.#hidden,
    ]);
  }
}
