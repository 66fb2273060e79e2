import { type Box3, BufferAttribute, BufferGeometry, DoubleSide, Ray, Vector3 } from 'three';
import { CENTER, MeshBVH } from 'three-mesh-bvh';
import type { Scene, SceneMesh } from '../scene-file.js';
import type { Kept } from './kept.js';
import { alongCurve, type Welded, weld } from './weld.js';

// The form in which three-mesh-bvh 0.9 is fastest at this, found by trying on the sample (ms in Node, in CPU time, each form in
// a process of its own):
// - nearest by `shapecast` and arithmetic on typed arrays, which the previous point's triangle bounds: 18.4 in total, against
//   21.7 with `closestPointToPoint` bounded the same way;
// - rays by `raycastFirst`: `shapecast`, though it could stop at any hit, makes it 24.3;
// - points along a curve: 17.7;
// - CENTER for both trees: SAH saves 0.5 of the queries and costs 0.7 (cage) and 5 (target) to build; leaves of 6 (cage: 16.4;
//   1: 20.2, 10: 17.7) and 4 (target; anything from 2 to 10 is within the noise); `indirect` or not: within the noise.
const cageLeaf = 6;
const targetLeaf = 4;

export interface PeerTimings {
  weld: number;
  build: number;
  project: number;
  occluded: number;
  covered: number;
  segments: number;
  total: number;
}

export interface PeerResult {
  timings: PeerTimings;
  uvs: Float32Array;
  zones: Uint8Array;
  triangles: Uint32Array;
  distances: Float32Array;
  segments: Uint32Array;
  cosmeticTriangles: Uint8Array;
}

const cosmetic = 0;
const occluded = 1;
const uncovered = 2;
const culled = 3;

/** The whole pipeline on three-mesh-bvh, from raw arrays to zones. The arrays of the result are the next transfer's as well. */
export function transferByBvh({ cage, target }: Scene, kept: Kept): PeerResult {
  const laps = [performance.now()];
  const lap = (): void => void laps.push(performance.now());
  const welded = weld(target, kept);
  const order = alongCurve(welded, kept);
  lap();
  const cageTree = buildTree(cage, cageLeaf);
  const targetTree = buildTree(target, targetLeaf);
  const patches = prepare(cage, kept);
  lap();
  const points = project(welded, order, patches, cageTree, kept);
  lap();
  const meetsTarget = caster(targetTree);
  const meetsCage = caster(cageTree);
  const zones = kept.take('pointZones', Uint8Array, welded.count).fill(cosmetic);
  const start = 1e-5 * welded.diagonal;
  const { positions } = welded;
  const { normals } = patches;
  for (const i of order) {
    const n = 3 * points.triangles[i]!;
    if (
      meetsTarget(
        positions[3 * i]!,
        positions[3 * i + 1]!,
        positions[3 * i + 2]!,
        normals[n]!,
        normals[n + 1]!,
        normals[n + 2]!,
        start,
      )
    )
      zones[i] = occluded;
  }
  lap();
  for (const i of order) {
    if (zones[i] !== cosmetic || points.meetsCage[i] !== 0) continue;
    const n = 3 * points.triangles[i]!;
    const [nx, ny, nz] = [normals[n]!, normals[n + 1]!, normals[n + 2]!];
    const back = -start;
    if (
      !meetsCage(
        positions[3 * i]! + back * nx,
        positions[3 * i + 1]! + back * ny,
        positions[3 * i + 2]! + back * nz,
        nx,
        ny,
        nz,
        0,
      )
    )
      zones[i] = uncovered;
  }
  lap();
  const decided = decide(target, welded, zones, points, kept);
  lap();
  const [weldTime, build, nearest, selfRays, cageRays, segments] = laps.slice(1).map((time, i) => time - laps[i]!) as [
    number,
    number,
    number,
    number,
    number,
    number,
  ];
  return {
    timings: {
      weld: weldTime,
      build,
      project: nearest,
      occluded: selfRays,
      covered: cageRays,
      segments,
      total: laps.at(-1)! - laps[0]!,
    },
    ...decided,
  };
}

interface Tree {
  bvh: MeshBVH;
  positions: Float32Array;
  indices: Uint32Array;
  /** The tree's leaves hold ranges of this: the triangles in its own order. */
  sorted: ArrayLike<number>;
}

function buildTree({ positions, indices }: SceneMesh, leaf: number): Tree {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(indices, 1));
  // Without `indirect` the tree would sort the caller's indices in place.
  const bvh = new MeshBVH(geometry, { strategy: CENTER, targetLeafSize: leaf, indirect: true, setBoundingBox: false });
  return { bvh, positions, indices, sorted: (bvh as unknown as { _indirectBuffer: Uint32Array })._indirectBuffer };
}

/** The triangles of the cage, ready for queries. */
interface Patches {
  /** `stride` per triangle. */
  frames: Float64Array;
  /** 3 per triangle. */
  normals: Float64Array;
  uvs: Float32Array;
}

/**
 * A frame in which the triangle lies flat: origin at one end of its longest edge, x along that edge.
 * origin 3, x 3, y 3, normal 3, length of the base, direction (2) and length of the other two edges.
 */
const stride = 19;

function prepare({ indices, positions, uvs }: SceneMesh, kept: Kept): Patches {
  const count = indices.length / 3;
  const frames = kept.take('frames', Float64Array, stride * count);
  const normals = kept.take('normals', Float64Array, 3 * count).fill(0);
  for (let t = 0; t < count; ++t) {
    const corner = [0, 1, 2].map((k) => new Vector3().fromArray(positions, 3 * indices[3 * t + k]!)) as [
      Vector3,
      Vector3,
      Vector3,
    ];
    const normal = corner[1].clone().sub(corner[0]).cross(corner[2].clone().sub(corner[0]));
    if (normal.lengthSq() === 0) {
      frames.fill(NaN, stride * t, stride * (t + 1));
      continue;
    }
    normal.normalize();
    normal.toArray(normals, 3 * t);
    const lengths = [0, 1, 2].map((k) => corner[k]!.distanceToSquared(corner[(k + 1) % 3]!));
    const longest = lengths.indexOf(Math.max(...lengths));
    const [a, b, c] = [corner[longest]!, corner[(longest + 1) % 3]!, corner[(longest + 2) % 3]!];
    const x = b.clone().sub(a).normalize();
    const y = normal.clone().cross(x);
    const base = a.distanceTo(b);
    const ac = c.clone().sub(a);
    const [cx, cy] = [ac.dot(x), ac.dot(y)];
    const [lengthC, lengthB] = [Math.hypot(cx, cy), Math.hypot(cx - base, cy)];
    frames.set(
      [
        a.x,
        a.y,
        a.z,
        x.x,
        x.y,
        x.z,
        y.x,
        y.y,
        y.z,
        normal.x,
        normal.y,
        normal.z,
        base,
        cx / lengthC,
        cy / lengthC,
        lengthC,
        (cx - base) / lengthB,
        cy / lengthB,
        lengthB,
      ],
      stride * t,
    );
  }
  return { frames, normals, uvs: uvs! };
}

function squaredDistance(frames: Float64Array, t: number, px: number, py: number, pz: number): number {
  const f = stride * t;
  const dx = px - frames[f]!;
  const dy = py - frames[f + 1]!;
  const dz = pz - frames[f + 2]!;
  const z = dx * frames[f + 9]! + dy * frames[f + 10]! + dz * frames[f + 11]!;
  const x = dx * frames[f + 3]! + dy * frames[f + 4]! + dz * frames[f + 5]!;
  const y = dx * frames[f + 6]! + dy * frames[f + 7]! + dz * frames[f + 8]!;
  const base = frames[f + 12]!;
  if (y < 0) {
    const along = x < 0 ? x : x > base ? x - base : 0;
    return z * z + y * y + along * along;
  }
  const cx = frames[f + 13]!;
  const cy = frames[f + 14]!;
  const bx = frames[f + 16]!;
  const by = frames[f + 17]!;
  const xb = x - base;
  if (cx * y <= cy * x && by * xb <= bx * y) return z * z;
  let along = x * cx + y * cy;
  along = along < 0 ? 0 : along > frames[f + 15]! ? frames[f + 15]! : along;
  const ax = x - along * cx;
  const ay = y - along * cy;
  along = xb * bx + y * by;
  along = along < 0 ? 0 : along > frames[f + 18]! ? frames[f + 18]! : along;
  const ex = xb - along * bx;
  const ey = y - along * by;
  return z * z + Math.min(ax * ax + ay * ay, ex * ex + ey * ey);
}

interface PointResults {
  uvs: Float32Array;
  distances: Float32Array;
  triangles: Uint32Array;
  meetsCage: Uint8Array;
}

/** Blends the UVs at the point of triangle t nearest to p (Ericson, "Real-Time Collision Detection", 2005, §5.1.5). */
function place(
  i: number,
  t: number,
  px: number,
  py: number,
  pz: number,
  start: number,
  { indices, positions }: Tree,
  { uvs, normals }: Patches,
  out: PointResults,
): void {
  const a = indices[3 * t]!;
  const b = indices[3 * t + 1]!;
  const c = indices[3 * t + 2]!;
  const ax = positions[3 * a]!;
  const ay = positions[3 * a + 1]!;
  const az = positions[3 * a + 2]!;
  const abx = positions[3 * b]! - ax;
  const aby = positions[3 * b + 1]! - ay;
  const abz = positions[3 * b + 2]! - az;
  const acx = positions[3 * c]! - ax;
  const acy = positions[3 * c + 1]! - ay;
  const acz = positions[3 * c + 2]! - az;
  const apx = px - ax;
  const apy = py - ay;
  const apz = pz - az;
  const d1 = abx * apx + aby * apy + abz * apz;
  const d2 = acx * apx + acy * apy + acz * apz;
  const abab = abx * abx + aby * aby + abz * abz;
  const abac = abx * acx + aby * acy + abz * acz;
  const acac = acx * acx + acy * acy + acz * acz;
  const d3 = d1 - abab;
  const d4 = d2 - abac;
  const d5 = d1 - abac;
  const d6 = d2 - acac;
  const vc = d1 * d4 - d3 * d2;
  const vb = d5 * d2 - d1 * d6;
  const va = d3 * d6 - d5 * d4;
  let v = 0;
  let w = 0;
  let inside = false;
  if (d1 <= 0 && d2 <= 0) {
    // The corner a.
  } else if (d3 >= 0 && d4 <= d3) {
    v = 1;
  } else if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    v = d1 / (d1 - d3);
  } else if (d6 >= 0 && d5 <= d6) {
    w = 1;
  } else if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    w = d2 / (d2 - d6);
  } else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    w = (d4 - d3) / (d4 - d3 + (d5 - d6));
    v = 1 - w;
  } else {
    const scale = 1 / (va + vb + vc);
    v = vb * scale;
    w = vc * scale;
    inside = true;
  }
  const u = 1 - v - w;
  out.uvs[2 * i] = u * uvs[2 * a]! + v * uvs[2 * b]! + w * uvs[2 * c]!;
  out.uvs[2 * i + 1] = u * uvs[2 * a + 1]! + v * uvs[2 * b + 1]! + w * uvs[2 * c + 1]!;
  const ox = apx - v * abx - w * acx;
  const oy = apy - v * aby - w * acy;
  const oz = apz - v * abz - w * acz;
  out.distances[i] = Math.sqrt(ox * ox + oy * oy + oz * oz);
  out.triangles[i] = t;
  const height = apx * normals[3 * t]! + apy * normals[3 * t + 1]! + apz * normals[3 * t + 2]!;
  out.meetsCage[i] = Number(inside && height < start);
}

/** Step 1, with the tie rule. */
function project(welded: Welded, order: Uint32Array, patches: Patches, tree: Tree, kept: Kept): PointResults {
  const { count: pointCount, positions } = welded;
  const out = {
    uvs: kept.take('pointUvs', Float32Array, 2 * pointCount),
    distances: kept.take('pointDistances', Float32Array, pointCount),
    triangles: kept.take('pointTriangles', Uint32Array, pointCount),
    meetsCage: kept.take('meetsCage', Uint8Array, pointCount),
  };
  const { frames, normals } = patches;
  const { sorted } = tree;
  const tieDistance = 1e-6 * welded.diagonal;
  const tiePlane = 1e-7 * welded.diagonal;
  const start = 1e-5 * welded.diagonal;
  const found: number[] = [];
  const distances: number[] = [];
  let px = 0;
  let py = 0;
  let pz = 0;
  let least = 0;
  let limitSquared = 0;
  const callbacks = {
    boundsTraverseOrder: ({ min, max }: Box3): number => {
      const x = px < min.x ? min.x - px : px > max.x ? px - max.x : 0;
      const y = py < min.y ? min.y - py : py > max.y ? py - max.y : 0;
      const z = pz < min.z ? min.z - pz : pz > max.z ? pz - max.z : 0;
      return x * x + y * y + z * z;
    },
    intersectsBounds: (_box: Box3, _isLeaf: boolean, score: number | undefined): boolean => score! <= limitSquared,
    intersectsRange: (offset: number, count: number): boolean => {
      for (let k = offset; k < offset + count; ++k) {
        const t = sorted[k]!;
        const squared = squaredDistance(frames, t, px, py, pz);
        if (!(squared <= limitSquared)) continue;
        const distance = Math.sqrt(squared);
        if (distance < least) {
          least = distance;
          limitSquared = (least + tieDistance) ** 2;
          let kept = 0;
          for (let j = 0; j < found.length; ++j) {
            if (distances[j]! > least + tieDistance) continue;
            found[kept] = found[j]!;
            distances[kept++] = distances[j]!;
          }
          found.length = distances.length = kept;
        }
        found.push(t);
        distances.push(distance);
      }
      return false;
    },
  };
  const planeDistance = (t: number): number => {
    const a = 3 * tree.indices[3 * t]!;
    return Math.abs(
      (px - tree.positions[a]!) * normals[3 * t]! +
        (py - tree.positions[a + 1]!) * normals[3 * t + 1]! +
        (pz - tree.positions[a + 2]!) * normals[3 * t + 2]!,
    );
  };
  let t = 0;
  for (const i of order) {
    px = positions[3 * i]!;
    py = positions[3 * i + 1]!;
    pz = positions[3 * i + 2]!;
    found.length = distances.length = 0;
    least = Infinity;
    const seed = squaredDistance(frames, t, px, py, pz);
    limitSquared = Number.isNaN(seed) ? Infinity : (Math.sqrt(seed) * (1 + 1e-6) + tieDistance) ** 2;
    tree.bvh.shapecast(callbacks);
    if (found.length === 1) {
      t = found[0]!;
    } else {
      let farthest = 0;
      for (const other of found) farthest = Math.max(farthest, planeDistance(other));
      let first = Infinity;
      for (const other of found) {
        if (planeDistance(other) >= farthest - tiePlane && other < first) first = other;
      }
      if (first !== Infinity) t = first;
    }
    place(i, t, px, py, pz, start, tree, patches, out);
  }
  return out;
}

/** Whether a ray hits anything at a distance beyond `from`. */
type Caster = (ox: number, oy: number, oz: number, dx: number, dy: number, dz: number, from: number) => boolean;

function caster({ bvh }: Tree): Caster {
  const ray = new Ray();
  return (ox, oy, oz, dx, dy, dz, from) => {
    ray.origin.set(ox, oy, oz);
    ray.direction.set(dx, dy, dz);
    return bvh.raycastFirst(ray, DoubleSide, from, Infinity) !== null;
  };
}

/** Segments, the threshold, and the results of the points handed out to the vertices. */
function decide(
  target: SceneMesh,
  welded: Welded,
  pointZones: Uint8Array,
  points: PointResults,
  kept: Kept,
): Omit<PeerResult, 'timings'> {
  const { ofVertex, positions } = welded;
  const parents = kept.take('parents', Uint32Array, welded.count);
  for (let i = 0; i < parents.length; ++i) parents[i] = i;
  const root = (i: number): number => {
    while (parents[i] !== i) i = parents[i] = parents[parents[i]!]!;
    return i;
  };
  const { indices } = target;
  for (let i = 0; i < indices.length; i += 3) {
    const a = root(ofVertex[indices[i]!]!);
    parents[root(ofVertex[indices[i + 1]!]!)] = a;
    parents[root(ofVertex[indices[i + 2]!]!)] = a;
  }
  const exposedArea = kept.take('exposedArea', Float64Array, welded.count).fill(0);
  const coveredArea = kept.take('coveredArea', Float64Array, welded.count).fill(0);
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [ofVertex[indices[i]!]!, ofVertex[indices[i + 1]!]!, ofVertex[indices[i + 2]!]!] as const;
    const [a, b, c] = [3 * corners[0], 3 * corners[1], 3 * corners[2]];
    const abx = positions[b]! - positions[a]!;
    const aby = positions[b + 1]! - positions[a + 1]!;
    const abz = positions[b + 2]! - positions[a + 2]!;
    const acx = positions[c]! - positions[a]!;
    const acy = positions[c + 1]! - positions[a + 1]!;
    const acz = positions[c + 2]! - positions[a + 2]!;
    const [nx, ny, nz] = [aby * acz - abz * acy, abz * acx - abx * acz, abx * acy - aby * acx];
    const third = Math.sqrt(nx * nx + ny * ny + nz * nz) / 6;
    const segment = root(corners[0]);
    for (let k = 0; k < 3; ++k) {
      const zone = pointZones[corners[k]!];
      if (zone !== occluded) exposedArea[segment]! += third;
      if (zone === cosmetic) coveredArea[segment]! += third;
    }
  }
  const vertexCount = ofVertex.length;
  const uvs = kept.take('uvs', Float32Array, 2 * vertexCount);
  const zones = kept.take('zones', Uint8Array, vertexCount);
  const triangles = kept.take('triangles', Uint32Array, vertexCount);
  const distances = kept.take('distances', Float32Array, vertexCount);
  const segments = kept.take('segments', Uint32Array, vertexCount);
  for (let v = 0; v < vertexCount; ++v) {
    const i = ofVertex[v]!;
    const segment = root(i);
    segments[v] = segment;
    zones[v] =
      pointZones[i] === cosmetic && coveredArea[segment]! < 0.5 * exposedArea[segment]! ? culled : pointZones[i]!;
    uvs[2 * v] = points.uvs[2 * i]!;
    uvs[2 * v + 1] = points.uvs[2 * i + 1]!;
    triangles[v] = points.triangles[i]!;
    distances[v] = points.distances[i]!;
  }
  const cosmeticTriangles = kept.take('cosmeticTriangles', Uint8Array, indices.length / 3);
  for (let t = 0; t < cosmeticTriangles.length; ++t) {
    cosmeticTriangles[t] = Number(
      zones[indices[3 * t]!] === cosmetic &&
        zones[indices[3 * t + 1]!] === cosmetic &&
        zones[indices[3 * t + 2]!] === cosmetic,
    );
  }
  return { uvs, zones, triangles, distances, segments, cosmeticTriangles };
}
