import { BufferAttribute, BufferGeometry, InstancedMesh, Mesh, SkinnedMesh } from 'three';

/** Zones in the order of the triangles in the index: cosmetic first, then occluded, uncovered and culled. */
export const kZoneNumbers = [0, 1, 2, 3] as const;

// Material indices of a filtered mesh: the paint, the three zones, the same seen through the surface, clay.
const kHidden = 3;
const kClay = 7;

/**
 * The zone of each triangle: 0 if cosmetic, else the highest zone of its corners, which was decided last.
 * @param zones   1 per vertex.
 * @param corners 3 vertices per triangle.
 */
export function zonesOfTriangles(
  cosmeticTriangles: Uint8Array,
  zones: Uint8Array,
  corners: ArrayLike<number>,
): Uint8Array {
  const triangleZones = new Uint8Array(cosmeticTriangles.length);
  for (let triangle = 0, corner = 0; triangle < triangleZones.length; triangle++, corner += 3) {
    if (cosmeticTriangles[triangle]) continue;
    triangleZones[triangle] = Math.max(
      zones[corners[corner]!]!,
      zones[corners[corner + 1]!]!,
      zones[corners[corner + 2]!]!,
    );
  }
  return triangleZones;
}

/** Sorts the triangles of a geometry by zone into its index, with a group for each material. */
export function sortByZone(geometry: BufferGeometry, corners: Uint32Array, triangleZones: Uint8Array): void {
  const counts = kZoneNumbers.map(() => 0);
  for (const zone of triangleZones) counts[zone]!++;
  geometry.clearGroups();
  /** Index position of the next triangle of each zone. */
  const next = kZoneNumbers.map(() => 0);
  let filled = 0;
  for (const zone of kZoneNumbers) {
    const count = 3 * counts[zone]!;
    next[zone] = filled;
    filled += count;
    if (count === 0) continue;
    const draw = (material: number): void => geometry.addGroup(next[zone]!, count, material);
    draw(zone);
    if (zone === 0) draw(kClay);
    // Drawn again behind other surfaces: most excluded zones are inside.
    if (zone > 0) draw(kHidden + zone);
  }
  const index = geometry.index!;
  const sorted = index.array as Uint32Array;
  for (let triangle = 0, corner = 0; triangle < triangleZones.length; triangle++, corner += 3) {
    const zone = triangleZones[triangle]!;
    const to = next[zone]!;
    sorted[to] = corners[corner]!;
    sorted[to + 1] = corners[corner + 1]!;
    sorted[to + 2] = corners[corner + 2]!;
    next[zone] = to + 3;
  }
  index.needsUpdate = true;
}

/** Subtracts `by` from each number. A loop, as `map` takes two to three times as long. */
export function shifted(numbers: Uint32Array, by: number): Uint32Array<ArrayBuffer> {
  const copy = new Uint32Array(numbers.length);
  for (let i = 0; i < copy.length; i++) copy[i] = numbers[i]! - by;
  return copy;
}

/** A geometry that shares the vertices, morphs and triangles of another. */
export function shareVertices(source: BufferGeometry): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(source.attributes)) geometry.setAttribute(name, attribute);
  geometry.morphAttributes = source.morphAttributes;
  geometry.morphTargetsRelative = source.morphTargetsRelative;
  geometry.boundingSphere = source.boundingSphere;
  geometry.setIndex(source.index);
  return geometry;
}

/** Keeps the shared buffers when a geometry is disposed of. Call it when the geometry is complete, before it is drawn. */
export function detachShared(geometry: BufferGeometry, { attributes, index }: BufferGeometry): void {
  // On `dispose` the renderer frees all attributes of a geometry, even shared ones. This listener runs before the renderer's.
  const shared = new Set<unknown>(Object.values(attributes));
  geometry.addEventListener('dispose', () => {
    for (const [name, attribute] of Object.entries(geometry.attributes))
      if (shared.has(attribute)) geometry.deleteAttribute(name);
    if (geometry.index === index) geometry.setIndex(null);
  });
}

/** Copies vertices with all attributes and morphs. @param sources The source vertex of each copy. */
export function copyVertices(source: BufferGeometry, sources: Uint32Array): BufferGeometry {
  const copy = shareVertices(source).setIndex(new BufferAttribute(sources, 1)).toNonIndexed();
  copy.boundingSphere = source.boundingSphere;
  return copy;
}

/** Makes a mesh that follows the skin, the morphs and the instances of `base`. */
export function overlayMesh(base: Mesh, geometry: BufferGeometry): Mesh {
  let mesh: Mesh;
  if (base instanceof SkinnedMesh) {
    const skinned = new SkinnedMesh(geometry);
    skinned.bindMode = base.bindMode;
    skinned.bind(base.skeleton, base.bindMatrix);
    mesh = skinned;
  } else if (base instanceof InstancedMesh) {
    mesh = new InstancedMesh(geometry, undefined, 0);
    Object.assign(mesh, { count: base.count, instanceMatrix: base.instanceMatrix });
  } else {
    mesh = new Mesh(geometry);
  }
  if (base.morphTargetInfluences) {
    // The same array: it follows every change.
    mesh.morphTargetInfluences = base.morphTargetInfluences;
    mesh.morphTargetDictionary = base.morphTargetDictionary!;
  }
  mesh.frustumCulled = base.frustumCulled;
  mesh.renderOrder = 1;
  mesh.receiveShadow = true;
  return mesh;
}
