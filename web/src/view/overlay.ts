import type { Classification, SplitVertices } from 'cagecast';
import type { CutTarget } from 'cagecast/borders';
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  GreaterDepth,
  LessEqualDepth,
  type Material,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  SkinnedMesh,
  SRGBColorSpace,
  type Texture,
} from 'three';
import { Pace } from '../platform/pace';
import { type ExtractedMesh, type Part, turnWinding } from '../scene/extract';
import type { Placed } from '../scene/transfer-messages';

/**
 * What lies over the target: nothing, the paint everywhere, what the filter leaves of it, the zones by reason, a checker on
 * all of it, or colours of one's own.
 */
export type Look = 'bare' | 'naive' | 'result' | 'zones' | 'checker' | 'tint';

/** Colours of the reasons, by zone. After Okabe and Ito, so that colour-blind eyes tell them apart; see style.css. */
const kReasonColors = { 1: '#0072b2', 2: '#e69f00', 3: '#cc79a7' } as const;

/** What may be painted, while the zones are looked at: a paint of any colour could be mistaken for one. */
const kClayColor = '#9aa7b3';

// The transferred UVs take a channel that glTF models do not fill, so the base maps keep theirs.
const kUvChannel = 3;
const kUvName = `uv${kUvChannel}`;

/** Linear light, in shares of 65535, for each byte of sRGB. */
const kLinear = Uint16Array.from({ length: 256 }, (_, byte) =>
  Math.round(65535 * new Color().setRGB(byte / 255, 0, 0, SRGBColorSpace).r),
);

const kMapShader = /* glsl */ `
  vec4 texel = texture2D( map, vMapUv );
  diffuseColor *= vec4( texel.rgb / max( texel.a, 1e-4 ), texel.a );
`;

/** The order of a part's triangles: those that may be painted, then the NCZ ones by reason. */
const kZones = [0, 1, 2, 3] as const;
const kReasons = [1, 2, 3] as const;

// Places in a layer's list of materials: the paint, the three reasons, the three reasons seen through the surface, clay.
const kHidden = 3;
const kClay = 7;

/**
 * What lies over a target: meshes over each of its parts, with the part's skin and morphs. The naive one shares the part's
 * vertices; the filtered one has them split wherever a seam of the paint runs; the tinted one, made when it is needed, has
 * vertices of its own for each triangle, so that no colour bleeds into the next.
 */
export class Overlay {
  readonly #layers: Layer[];
  /** Vertices of the target. */
  readonly #vertexCount: number;
  #cuts = 0;

  /**
   * Lays nothing yet: call `classify`.
   * @param paint In the cage's UVs, its colours multiplied by their alpha. It may be a render target's, drawn anew at any time.
   */
  constructor(target: ExtractedMesh, projection: Placed, paint: Texture | undefined) {
    this.#vertexCount = target.positions.length / 3;
    const parts = target.parts.filter((part) => part.triangleCount > 0);
    this.#layers = parts.map((part) => new Layer(part, target.indices, paint));
    this.lay(projection);
  }

  /** Lays everything anew over the target, whose vertices have moved: not as it was cut. Call `classify` next. */
  lay({ uvs, split }: Placed): void {
    this.#cuts++;
    for (const layer of this.#layers) layer.lay(uvs, split);
  }

  /** Chooses which triangles are painted, and which are which zone. */
  classify(classification: Classification): void {
    for (const layer of this.#layers) layer.classify(classification);
  }

  /** Lays the filtered paint over the target as it was cut; without a cut over its own triangles again. The last call wins. */
  async setCut(cut: CutTarget | undefined): Promise<void> {
    const call = ++this.#cuts;
    for (const layer of this.#layers) layer.forgetCut();
    if (!cut) return;
    const { cutGeometry } = await import('cagecast/three/borders');
    const pace = new Pace();
    for (const layer of this.#layers) {
      if (call !== this.#cuts) return;
      layer.layCut(cut, this.#vertexCount, cutGeometry);
      await pace.rest();
    }
  }

  setPaint(paint: Texture): void {
    for (const layer of this.#layers) layer.setPaint(paint);
  }

  /** Gives the look `checker` its texture. */
  setChecker(checker: Texture): void {
    for (const layer of this.#layers) layer.setChecker(checker);
  }

  /** Gives the look `tint` its colours. @param colors 3 bytes per triangle corner of the target, sRGB. */
  setTint(colors: Uint8Array): void {
    for (const layer of this.#layers) layer.setTint(colors);
  }

  /** Chooses what the next frame draws. */
  show(look: Look): void {
    for (const layer of this.#layers) layer.show(look);
  }

  dispose(): void {
    this.#cuts++;
    for (const layer of this.#layers) layer.dispose();
  }
}

type CutGeometry = typeof import('cagecast/three/borders')['cutGeometry'];

class Layer {
  readonly #part: Part;
  /** The part's corners as vertices of the target, and as vertices of the filtered mesh. */
  readonly #vertices: Uint32Array;
  #corners = new Uint32Array(0);
  readonly #naive: Mesh;
  readonly #filtered: Mesh;
  /** In place of the filtered one, where the target was cut. */
  #cut: Mesh | undefined;
  #tinted: Mesh | undefined;
  #look: Look = 'bare';
  readonly #paint: MeshStandardMaterial;
  readonly #nothing = new MeshBasicMaterial({ visible: false });
  readonly #reasons = kReasons.map((zone) => reasonMaterial(kReasonColors[zone]));
  readonly #clay = onSurface(new MeshStandardMaterial({ color: kClayColor, roughness: 0.85 }));
  readonly #checker = onSurface(new MeshStandardMaterial({ roughness: 0.9 }));
  readonly #tint = tintMaterial();
  readonly #hidden = kReasons.map((zone) => hiddenMaterial(kReasonColors[zone]));

  constructor(part: Part, indices: Uint32Array, paint: Texture | undefined) {
    this.#part = part;
    const { mesh, firstTriangle, triangleCount } = part;
    this.#vertices = indices.subarray(3 * firstTriangle, 3 * (firstTriangle + triangleCount));
    this.#paint = paintMaterial([mesh.material].flat()[0]!);
    if (paint) this.setPaint(paint);
    this.#naive = overlayMesh(mesh, new BufferGeometry());
    this.#naive.material = this.#paint;
    this.#filtered = overlayMesh(mesh, new BufferGeometry());
    mesh.add(this.#naive, this.#filtered);
  }

  /** Gives the meshes the part's vertices as they are now. Materials stay: a shader takes longer than a frame to make. */
  lay(uvs: Float32Array, split: SplitVertices): void {
    const { mesh, firstVertex, vertexCount, firstTriangle, triangleCount, mirrored } = this.#part;
    const [from, to] = [3 * firstTriangle, 3 * (firstTriangle + triangleCount)];
    // Split vertices are in the order of their use: those of a part follow each other.
    const first = split.indices[from]!;
    this.#corners = less(split.indices.subarray(from, to), first);
    let count = 0;
    for (const vertex of this.#corners) count = Math.max(count, vertex + 1);
    const sources = less(split.sources.subarray(first, first + count), firstVertex);
    // The mesh hangs below the part, where the renderer turns the winding of what is mirrored by itself.
    if (mirrored) turnWinding(this.#corners);

    const naive = shareVertices(mesh.geometry);
    naive.setAttribute(kUvName, new BufferAttribute(uvs.slice(2 * firstVertex, 2 * (firstVertex + vertexCount)), 2));
    leaveShared(naive, mesh.geometry);
    const filtered = copyVertices(mesh.geometry, sources);
    filtered.setAttribute(kUvName, new BufferAttribute(split.uvs.slice(2 * first, 2 * (first + count)), 2));
    filtered.setIndex(new BufferAttribute(new Uint32Array(3 * triangleCount), 1));
    this.#exchange(this.#naive, naive);
    this.#exchange(this.#filtered, filtered);
    this.forgetCut();
    this.#forgetTint();
  }

  /** Lays the filtered paint over the part as it was cut. @param vertexCount Of the whole target before. */
  layCut(cut: CutTarget, vertexCount: number, cutGeometry: CutGeometry): void {
    const { mesh, mirrored } = this.#part;
    const geometry = shareVertices(mesh.geometry);
    geometry.morphAttributes = { ...geometry.morphAttributes }; // which are replaced one by one
    const { pieces, split } = cutGeometry(geometry, { ...this.#part, turned: mirrored }, cut, vertexCount);
    geometry.setAttribute(kUvName, new BufferAttribute(split.uvs, 2));
    const { cosmeticTriangles, zones } = pieces.result;
    const reasons = reasonsOf(cosmeticTriangles, zones, pieces.geometry.localIndices);
    geometry.setIndex(new BufferAttribute(new Uint32Array(split.indices.length), 1));
    sortByReason(geometry, split.indices, reasons);
    leaveShared(geometry, mesh.geometry);
    this.forgetCut();
    this.#cut = overlayMesh(mesh, geometry);
    mesh.add(this.#cut);
    this.show(this.#look);
  }

  /** Goes back to the part's own triangles. */
  forgetCut(): void {
    if (!this.#cut) return;
    this.#cut.removeFromParent();
    this.#cut.geometry.dispose();
    this.#cut = undefined;
    this.show(this.#look);
  }

  #exchange(mesh: Mesh, geometry: BufferGeometry): void {
    mesh.geometry.dispose();
    mesh.geometry = geometry;
  }

  /** Its vertices are made again with the next tint. */
  #forgetTint(): void {
    this.#tinted?.removeFromParent();
    this.#tinted?.geometry.dispose();
    this.#tinted = undefined;
  }

  classify({ zones, cosmeticTriangles }: Classification): void {
    const { firstTriangle, triangleCount } = this.#part;
    const cosmetic = cosmeticTriangles.subarray(firstTriangle, firstTriangle + triangleCount);
    sortByReason(this.#filtered.geometry, this.#corners, reasonsOf(cosmetic, zones, this.#vertices));
  }

  setPaint(paint: Texture): void {
    paint.channel = kUvChannel;
    this.#paint.map = paint;
  }

  setChecker(checker: Texture): void {
    checker.channel = kUvChannel;
    this.#checker.map = checker;
  }

  setTint(colors: Uint8Array): void {
    const { mesh, firstTriangle, firstVertex, triangleCount, mirrored } = this.#part;
    if (!this.#tinted) {
      const geometry = copyVertices(mesh.geometry, less(this.#vertices, firstVertex));
      if (mirrored) {
        const corners = Uint32Array.from({ length: 3 * triangleCount }, (_, corner) => corner);
        turnWinding(corners);
        geometry.setIndex(new BufferAttribute(corners, 1));
      }
      geometry.setAttribute('color', new BufferAttribute(new Uint16Array(9 * triangleCount), 3, true));
      this.#tinted = overlayMesh(mesh, geometry);
      this.#tinted.material = this.#tint;
      this.#tinted.visible = false;
      mesh.add(this.#tinted);
    }
    const attribute = this.#tinted.geometry.getAttribute('color') as BufferAttribute;
    const { array } = attribute;
    const from = 9 * firstTriangle;
    for (let i = 0; i < array.length; i++) array[i] = kLinear[colors[from + i]!]!;
    attribute.needsUpdate = true;
  }

  show(look: Look): void {
    this.#look = look;
    this.#naive.visible = look === 'naive';
    if (this.#tinted) this.#tinted.visible = look === 'tint';
    const materials = this.#materials(look);
    this.#filtered.visible = false;
    const filtered = this.#cut ?? this.#filtered;
    filtered.visible = materials.length > 0;
    filtered.material = materials;
  }

  /** Of the filtered mesh. A group whose material is missing is not drawn. */
  #materials(look: Look): Material[] {
    switch (look) {
      case 'result':
        return [this.#paint];
      case 'zones':
        return [this.#nothing, ...this.#reasons, ...this.#hidden, this.#clay];
      case 'checker':
        return kZones.map(() => this.#checker);
      default:
        return [];
    }
  }

  dispose(): void {
    this.forgetCut();
    this.#forgetTint();
    for (const mesh of [this.#naive, this.#filtered]) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    for (const material of [
      this.#paint,
      this.#nothing,
      this.#clay,
      this.#checker,
      this.#tint,
      ...this.#reasons,
      ...this.#hidden,
    ])
      material.dispose();
  }
}

/**
 * 1 per triangle: 0 where it may be painted, else the zone, of those of its corners, that was decided last.
 * @param zones   1 per vertex.
 * @param corners 3 vertices per triangle.
 */
function reasonsOf(cosmeticTriangles: Uint8Array, zones: Uint8Array, corners: ArrayLike<number>): Uint8Array {
  const reasons = new Uint8Array(cosmeticTriangles.length);
  for (let triangle = 0, corner = 0; triangle < reasons.length; triangle++, corner += 3) {
    if (cosmeticTriangles[triangle]) continue;
    reasons[triangle] = Math.max(zones[corners[corner]!]!, zones[corners[corner + 1]!]!, zones[corners[corner + 2]!]!);
  }
  return reasons;
}

/** Fills the index of a geometry with its triangles in the order of their reasons, in groups for a layer's materials. */
function sortByReason(geometry: BufferGeometry, corners: Uint32Array, reasons: Uint8Array): void {
  const counts = kZones.map(() => 0);
  for (const zone of reasons) counts[zone]!++;
  geometry.clearGroups();
  /** Where the next triangle of each zone goes. */
  const next = kZones.map(() => 0);
  let filled = 0;
  for (const zone of kZones) {
    const count = 3 * counts[zone]!;
    next[zone] = filled;
    filled += count;
    if (count === 0) continue;
    const draw = (material: number): void => geometry.addGroup(next[zone]!, count, material);
    draw(zone);
    if (zone === 0) draw(kClay);
    // Drawn a second time where something lies in front of it: most zones are inside.
    if (zone > 0) draw(kHidden + zone);
  }
  const index = geometry.index!;
  const sorted = index.array as Uint32Array;
  for (let triangle = 0, corner = 0; triangle < reasons.length; triangle++, corner += 3) {
    const zone = reasons[triangle]!;
    const to = next[zone]!;
    sorted[to] = corners[corner]!;
    sorted[to + 1] = corners[corner + 1]!;
    sorted[to + 2] = corners[corner + 2]!;
    next[zone] = to + 3;
  }
  index.needsUpdate = true;
}

/** Copies numbers, each less the same. A loop, as the arrays' own `map` takes two to three times as long. */
function less(numbers: Uint32Array, by: number): Uint32Array<ArrayBuffer> {
  const copy = new Uint32Array(numbers.length);
  for (let i = 0; i < copy.length; i++) copy[i] = numbers[i]! - by;
  return copy;
}

/** A geometry of the same vertices, morphs and triangles, to which more can be added. */
export function shareVertices(source: BufferGeometry): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(source.attributes)) geometry.setAttribute(name, attribute);
  geometry.morphAttributes = source.morphAttributes;
  geometry.morphTargetsRelative = source.morphTargetsRelative;
  geometry.boundingSphere = source.boundingSphere;
  geometry.setIndex(source.index);
  return geometry;
}

/** Lets a geometry that is done, and not drawn yet, leave what it shares alone when it goes. */
export function leaveShared(geometry: BufferGeometry, { attributes, index }: BufferGeometry): void {
  // The renderer frees the buffers of all that a geometry has then, whoever else uses them. It listens after this.
  const shared = new Set<unknown>(Object.values(attributes));
  geometry.addEventListener('dispose', () => {
    for (const [name, attribute] of Object.entries(geometry.attributes))
      if (shared.has(attribute)) geometry.deleteAttribute(name);
    if (geometry.index === index) geometry.setIndex(null);
  });
}

/** A geometry of copies of vertices, with all their attributes and morphs. @param sources 1 per copy: the vertex it is of. */
function copyVertices(source: BufferGeometry, sources: Uint32Array): BufferGeometry {
  const copy = shareVertices(source).setIndex(new BufferAttribute(sources, 1)).toNonIndexed();
  copy.boundingSphere = source.boundingSphere;
  return copy;
}

/** Makes a mesh that moves, bends and morphs as `base` does. */
export function overlayMesh(base: Mesh, geometry: BufferGeometry): Mesh {
  let mesh: Mesh;
  if (base instanceof SkinnedMesh) {
    const skinned = new SkinnedMesh(geometry);
    skinned.bindMode = base.bindMode;
    skinned.bind(base.skeleton, base.bindMatrix);
    mesh = skinned;
  } else {
    mesh = new Mesh(geometry);
  }
  if (base.morphTargetInfluences) {
    // The same array, not a copy: it follows every change.
    mesh.morphTargetInfluences = base.morphTargetInfluences;
    mesh.morphTargetDictionary = base.morphTargetDictionary!;
  }
  mesh.frustumCulled = base.frustumCulled;
  mesh.renderOrder = 1;
  mesh.receiveShadow = true;
  return mesh;
}

/** Paint takes the surface's gloss and relief, but neither its colour nor its glow. */
function paintMaterial(base: Material): MeshStandardMaterial {
  const paint =
    base instanceof MeshStandardMaterial
      ? new MeshStandardMaterial().copy(base)
      : new MeshStandardMaterial({ roughness: 0.7 });
  paint.color = new Color('white');
  paint.emissive = new Color('black');
  paint.emissiveMap = paint.alphaMap = paint.lightMap = null;
  paint.vertexColors = false;
  paint.metalness = 0;
  paint.metalnessMap = null;
  paint.alphaTest = 0;
  paint.opacity = 1;
  // The texture's colours are multiplied by their alpha, so that what is transparent has none to give when it is filtered.
  paint.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace('#include <map_fragment>', kMapShader);
  };
  return onSurface(paint);
}

// Glowing a little and lit less than the rest, so that the legend's colour is met in the light and in the shade.
const kLit = 0.6;
const kGlow = 0.3;

function reasonMaterial(color: string): Material {
  const lit = { color: new Color(color).multiplyScalar(kLit), emissive: color, emissiveIntensity: kGlow, roughness: 1 };
  return onSurface(new MeshStandardMaterial({ ...lit, side: DoubleSide }));
}

/** The same with a colour for each vertex. */
function tintMaterial(): Material {
  const material = onSurface(
    new MeshStandardMaterial({
      vertexColors: true,
      color: new Color().setScalar(kLit),
      roughness: 1,
      side: DoubleSide,
    }),
  );
  material.onBeforeCompile = (shader) => {
    const glow = '#include <emissivemap_fragment>';
    shader.fragmentShader = shader.fragmentShader.replace(
      glow,
      `${glow}\ntotalEmissiveRadiance += vColor.rgb * ${kGlow};`,
    );
  };
  return material;
}

function hiddenMaterial(color: string): Material {
  const material = onSurface(new MeshBasicMaterial({ color, opacity: 0.28, side: DoubleSide }));
  material.depthFunc = GreaterDepth;
  material.polygonOffset = false;
  return material;
}

/** Lets a material lie on the surface it shares its vertices with. */
export function onSurface<M extends Material>(material: M): M {
  material.transparent = true;
  material.depthWrite = false;
  // What lies on a surface has nothing to sort: one pass for both sides, where transparent materials get two.
  material.forceSinglePass = true;
  material.depthFunc = LessEqualDepth;
  material.polygonOffset = true;
  material.polygonOffsetFactor = -1;
  material.polygonOffsetUnits = -1;
  return material;
}
