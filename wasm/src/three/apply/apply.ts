import {
  Box3,
  BufferAttribute,
  type BufferGeometry,
  type Material,
  Matrix3,
  type Mesh,
  type Texture,
  Vector3,
} from 'three';
import type { Mesh as CageArrays, Classification } from '../../api/index.js';
import { show } from '../../core/error.js';
import { noteOf } from '../../inspect/bare.js';
import type { Prepared } from '../../parts/prepare.js';
import type { PartRange } from '../../parts/split-part.js';
import { notA, wrong } from '../errors.js';
import { needsNodePainter } from '../materials/node-paint.js';
import { removeOverlay, removeOverlays } from '../materials/overlay-mesh.js';
import { refreshMatrix } from '../materials/paint-shader.js';
import {
  canBePainted,
  isPainted,
  makePainting,
  type Painting,
  paintOn,
  unpaint,
} from '../materials/painted-materials.js';
import { type Applied, type ApplyOptions, checkLengths } from './apply-options.js';
import { zoneAttribute } from './attributes.js';
import { type Extracted, type ExtractedNear, isMirrored, type Part } from './extract-scene.js';
import { disposeOwn, own } from './own-attributes.js';
import { type Remade, remake, replace } from './remake.js';
import { type ShownPart, showMaterial, showPaint, writePaint, writeZones } from './shown-parts.js';
import { beforeOf, type Channel, isWrittenBy, noteWrite, rewind, takeOff, type Writer } from './writes.js';

/** The number of the call that has changed a mesh, or a geometry without one, last. */
const changedBy = new WeakMap<object, number>();

/** The paintings that geometries were made for. */
const paintings = new WeakMap<BufferGeometry, Painting>();

/** The paintings whose paint geometries show. */
const shownPaintings = new WeakMap<BufferGeometry, Painting>();

export const rangesOf = ({ parts }: Extracted): PartRange[] =>
  parts.map(({ firstVertex, vertexCount, firstTriangle, triangleCount, matrix }) => ({
    firstVertex,
    vertexCount,
    firstTriangle,
    triangleCount,
    mirrored: isMirrored(matrix),
  }));

function freeChannel(states: readonly BufferGeometry[]): Channel {
  const free = ([1, 2, 3] as const).find((channel) => states.every((state) => !state.hasAttribute(`uv${channel}`)));
  if (free === undefined)
    throw wrong('target has uv1, uv2 and uv3 of its own; choose one to overwrite: options.channel');
  return free;
}

/** Whether a mesh that is not of the target shows what an earlier transfer made of a geometry. */
function isShownElsewhere(geometry: BufferGeometry, parts: readonly Part[]): boolean {
  const others = [...(paintings.get(geometry)?.meshes ?? [])];
  return others.some((other) => other.geometry === geometry && parts.every(({ mesh }) => mesh !== other));
}

/**
 * Gives every part a geometry of its own: meshes that share one get copies, within the target and where a mesh elsewhere shows what
 * an earlier transfer made of it.
 * @param sources  What is copied, for each part.
 */
function ownGeometries(parts: readonly Part[], sources: readonly BufferGeometry[]): void {
  const taken = new Set<BufferGeometry>();
  for (const [p, part] of parts.entries()) {
    const { mesh, geometry } = part;
    if (mesh && (taken.has(geometry) || isShownElsewhere(geometry, parts))) {
      mesh.geometry = part.geometry = sources[p]!.clone();
    }
    taken.add(part.geometry);
  }
}

const hasOthers = (geometry: BufferGeometry, state: BufferGeometry): boolean =>
  geometry.attributes['position'] !== state.attributes['position'] || geometry.index !== state.index;

/** Node materials are for `WebGPURenderer`, which without its entry would show an overlay of ours, but no paint. */
function checkMaterials(parts: readonly Part[]): void {
  const part = parts.find(({ mesh }) => [mesh?.material].flat().some(needsNodePainter));
  if (!part) return;
  throw wrong(
    `${show(part.name)} has a node material, which shows options.texture once the page imports cagecast/three/webgpu; else give options.material`,
    undefined,
    'badOption',
  );
}

/**
 * Applies what was prepared to the geometries and materials of a target. Nothing is changed before the last step; yields after each
 * attribute that was extended, for callers that share the thread.
 * @param call  Greater than those of all calls before.
 * @param cage  As it was given, if it was.
 */
export function* apply(
  target: ExtractedNear,
  prepared: Prepared,
  options: ApplyOptions,
  { call, cage }: { call: number; cage: CageArrays | undefined },
): Generator<void, Applied> {
  const { parts, states: extracted } = target;
  if (options.texture && !options.material) checkMaterials(parts);
  const before = ({ geometry }: Part) => beforeOf(geometry, options.channel);
  const states = parts.map((part, p) => {
    const now = before(part);
    return hasOthers(now, extracted[p]!) ? extracted[p]! : now;
  });
  const channel = options.channel ?? freeChannel(states);
  const remades: (Remade | undefined)[] = [];
  for (const [p, part] of parts.entries())
    remades.push(yield* remake(states[p]!, prepared.parts[p]!, part.firstTriangle));
  const sources = parts.map((part, p) => {
    const { name, mesh, geometry } = part;
    if ((changedBy.get(mesh ?? geometry) ?? 0) > call)
      throw wrong(`a later transfer to ${show(name)} has ended before this one`, undefined, 'superseded');
    const now = before(part);
    const isLate = (attribute: string) => remades[p] && !remades[p].attributes.has(attribute);
    const isChanged = hasOthers(now, states[p]!) || Object.keys(now.attributes).some(isLate);
    // The transfer of a mesh elsewhere may change the geometry: this one gets a copy of what it was.
    if ((mesh && mesh.geometry !== geometry) || (isChanged && !(mesh && isShownElsewhere(geometry, parts))))
      throw wrong(`the geometry of ${show(name)} was changed meanwhile`);
    return isChanged ? states[p]! : now;
  });

  ownGeometries(parts, sources);
  const painting = makePainting({
    texture: options.texture,
    opacity: options.opacity ?? 1,
    feather: options.feather ?? 0,
    matrix: new Matrix3(),
    meshes: new Set(parts.flatMap(({ mesh }) => mesh ?? [])),
  });
  const replaced: (() => void)[] = [];
  parts.forEach(({ mesh, geometry }, p) => {
    for (const writer of rewind(geometry, options.channel)) replaced.push(() => writer.replaced(geometry));
    changedBy.set(mesh ?? geometry, call);
    if (mesh && options.texture) removeOverlays(mesh); // They show paint that is covered here.
    if (remades[p]) replace(geometry, remades[p]!);
    else disposeOwn(geometry, [`uv${channel}`, zoneAttribute]); // or the GPU buffers of what is replaced here would be left to the garbage collector
    const { uvs, sources: vertices } = prepared.parts[p]!;
    geometry.setAttribute(`uv${channel}`, own(new BufferAttribute(uvs.slice(), 2)));
    geometry.setAttribute(zoneAttribute, own(new BufferAttribute(new Float32Array(vertices.length), 1)));
    paintings.set(geometry, painting);
  });
  const shown = parts.map((part, p): ShownPart => ({ ...prepared.parts[p]!, part, cosmetic: new Uint8Array(0) }));
  const applied = new Shown(target, prepared, shown, { painting, material: options.material, channel, cage });
  shown.forEach(({ part: { geometry } }, p) => noteWrite(geometry, { writer: applied, channel, before: sources[p]! }));
  applied.start();
  for (const tell of replaced) tell();
  return applied;
}

interface Display {
  painting: Painting;
  material: Material | null | undefined;
  channel: Channel;
  cage: CageArrays | undefined;
}

/** Its methods are fields, so that they may be taken out of it. */
class Shown implements Applied, Writer {
  readonly result;
  readonly splitVertices;
  readonly cutTriangles;
  readonly channel;
  readonly parts;
  readonly leftOut;
  readonly #target: Extracted['mesh'];
  readonly #cage: Display['cage'];
  readonly #shown: ShownPart[];
  readonly #painting: Painting;
  readonly #material: Display['material'];
  /** The verdicts of the result. A copy: the caller may overwrite `result` later (`reuse`). */
  readonly #culled: boolean[];
  readonly #copies = new Map<Material, Material>();
  /** Materials that were added by hand. */
  readonly #added = new Set<Material>();
  #painted = new Set<Material>();
  #isDisposed = false;
  #hasPaint = false;

  constructor({ mesh, leftOut }: Extracted, prepared: Prepared, shown: ShownPart[], display: Display) {
    this.result = prepared.result;
    this.splitVertices = prepared.parts.reduce((sum, { copies }) => sum + copies, 0);
    this.cutTriangles = prepared.cutTriangles;
    this.channel = display.channel;
    this.parts = shown.map(({ part }) => part);
    this.leftOut = leftOut;
    this.#target = mesh;
    this.#cage = display.cage;
    this.#shown = shown;
    this.#painting = display.painting;
    this.#material = display.material;
    this.#culled = this.result.segmentStats.map(({ culled }) => culled);
  }

  /** Shows it for the first time. */
  start(): void {
    this.#decide(this.result);
  }

  /** Another transfer has taken the place of this one on a part. */
  replaced(geometry: BufferGeometry): void {
    for (const { overlay, part } of this.#shown) if (overlay && part.geometry === geometry) this.#remove(overlay);
    this.#show();
  }

  get note(): string | undefined {
    return noteOf(this.#target, this.result, this.parts, this.#cage);
  }

  get overlays(): Mesh[] {
    return this.#shown.flatMap(({ overlay }) => overlay ?? []);
  }

  readonly setTexture = (texture: Texture | null | undefined): void => {
    if (texture && !texture.isTexture) throw notA('a Texture', 'texture', texture, 'setTexture');
    this.#painting.texture = texture;
    this.#show();
  };

  readonly setOpacity = (opacity: number): void => {
    if (!(opacity >= 0 && opacity <= 1)) throw notA('a number from 0 to 1', 'opacity', opacity, 'setOpacity');
    this.#painting.opacity = opacity;
    refreshMatrix(this.#painting);
  };

  readonly paint = (material: Material): boolean => {
    if (!material?.isMaterial) throw notA('a Material', 'material', material, 'paint');
    if (!canBePainted(material)) return false;
    this.#added.add(material);
    this.#show();
    return true;
  };

  readonly setClassification = (classification: Classification): void => {
    checkLengths('classification', classification, {
      zones: this.result.zones.length,
      cosmeticTriangles: this.result.cosmeticTriangles.length,
      segmentStats: this.#culled.length,
    });
    this.#decide(classification);
  };

  #decide(now: Classification): void {
    const { segments } = this.result;
    const hasChanged = this.#culled.map((culled, s) => Number(now.segmentStats[s]!.culled !== culled));
    const isOther = new Uint8Array(segments.length);
    if (hasChanged.includes(1)) for (let v = 0; v < segments.length; ++v) isOther[v] = hasChanged[segments[v]!]!;
    for (const one of this.#current) writeZones(one, now, isOther, this.#target.indices);
    this.#hasPaint = false;
    this.#show();
  }

  /** The parts that have it, and on which no later transfer shows its paint. */
  get #current(): ShownPart[] {
    const { number } = this.#painting;
    return this.#shown.filter(
      ({ part: { geometry } }) =>
        isWrittenBy(geometry, this) && !((shownPaintings.get(geometry)?.number ?? 0) > number),
    );
  }

  #remove(overlay: Mesh): void {
    removeOverlay(overlay);
    if (overlay.material !== this.#material) (overlay.material as Material).dispose();
  }

  #show(): void {
    if (this.#isDisposed) return;
    const { texture, feather } = this.#painting;
    const shown = this.#current;
    if (this.#material) {
      for (const one of shown) showMaterial(one, this.#material);
      return;
    }
    const isShown = shown.every(({ part }) => shownPaintings.get(part.geometry) === this.#painting);
    if (texture && !(this.#hasPaint && isShown)) {
      writePaint(shown, feather, feather > 0 ? diagonal(this.#target.positions) : 1);
      for (const { part } of shown) shownPaintings.set(part.geometry, this.#painting);
      this.#hasPaint = true;
    }
    refreshMatrix(this.#painting);
    // Materials without paint for now stay ready for it: to make them what they were, and again, would compile their shaders twice.
    const paints = !!texture || this.#painted.size > 0;
    const painted = new Set(shown.flatMap((one) => showPaint(one, this.#painting, this.#copies, paints)));
    if (paints && shown.length > 0) for (const material of this.#added) painted.add(paintOn(material, this.#painting));
    for (const material of this.#painted) if (!painted.has(material)) unpaint(material, this.#painting);
    this.#painted = painted;
  }

  readonly dispose = (): void => {
    if (this.#isDisposed) return;
    this.#isDisposed = true;
    for (const material of this.#painted) unpaint(material, this.#painting);
    for (const [material, copy] of this.#copies) {
      if (isPainted(copy)) continue; // By a later transfer, which puts the original back.
      for (const { part } of this.#shown) showInstead(part.mesh, copy, material);
      copy.dispose();
    }
    for (const { overlay, part } of this.#shown) {
      const { geometry } = part;
      if (paintings.get(geometry) === this.#painting) paintings.delete(geometry);
      if (shownPaintings.get(geometry) === this.#painting) shownPaintings.delete(geometry);
      takeOff(geometry, this);
      if (overlay) this.#remove(overlay);
    }
  };
}

function showInstead(mesh: Mesh | undefined, was: Material, now: Material): void {
  const change = (m: Material) => (m === was ? now : m);
  if (mesh) mesh.material = Array.isArray(mesh.material) ? mesh.material.map(change) : change(mesh.material);
}

/** The diagonal of the points' box. */
const diagonal = (positions: Float32Array): number =>
  new Box3().setFromArray(positions).getSize(new Vector3()).length() || 1;
