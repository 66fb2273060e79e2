import {
  type BufferAttribute,
  type Camera,
  type InstancedMesh,
  type Intersection,
  Matrix4,
  type Mesh,
  type Object3D,
  type Raycaster,
  type SkinnedMesh,
  Sphere,
  Triangle,
  Vector2,
  Vector3,
} from 'three';
import type { Applied } from '../apply/apply-options.js';
import { zoneAttribute } from '../apply/attributes.js';
import type { Part } from '../apply/extract-scene.js';
import { paintAttribute } from '../materials/paint-shader.js';
import type { CageTexels, SurfacePoint } from './cage-texels.js';

/** A spot on a painted model. */
export interface Spot {
  mesh: Mesh;
  /** In the space of the scene, as the model is posed. */
  point: Vector3;
  /** In the cage's UV space; undefined where nothing may be painted. */
  uv: Vector2 | undefined;
  /** The point of the cage that it takes its paint from; undefined where nothing may be painted. */
  surface: SurfacePoint | undefined;
  /** Units of the scene per unit of length of the cage. */
  scale: number;
  /** Turns directions of the scene to those of the cage, as the model is posed. */
  toCage: Matrix4;
}

/** The nearest spot of the models that a ray meets. Cost: visits all triangles, unless three-mesh-bvh speeds up ray casts. */
export function pickSpot(
  models: readonly Applied[],
  raycaster: Raycaster,
  texels: CageTexels | undefined,
): Spot | undefined {
  const shown = models.flatMap(({ parts, channel }) =>
    parts.flatMap((part) => {
      const root = rootOf(part.mesh);
      return root ? { part, channel, root } : [];
    }),
  );
  // What was taken out of a scene is seen no more.
  const inScene = shown.filter(({ root }) => 'isScene' in root);
  let nearest: { part: Part; channel: number; hit: Intersection } | undefined;
  for (const { part, channel } of inScene.length > 0 ? inScene : shown) {
    const hit = hitOf(part.mesh!, raycaster);
    if (hit?.face && (!nearest || hit.distance < nearest.hit.distance)) nearest = { part, channel, hit };
  }
  return nearest && spotOf(nearest.part, nearest.hit, nearest.channel, texels);
}

/** Where a ray meets a mesh first. Three.js tests bounds before, which it keeps of an earlier pose of a skinned mesh: none here. */
function hitOf(mesh: Mesh, raycaster: Raycaster): Intersection | undefined {
  const { boundingSphere, boundingBox } = mesh as SkinnedMesh;
  const isSkinned = (mesh as SkinnedMesh).isSkinnedMesh === true;
  if (isSkinned) Object.assign(mesh, { boundingSphere: new Sphere(new Vector3(), Infinity), boundingBox: null });
  const [hit] = raycaster.intersectObject(mesh, false);
  if (isSkinned) Object.assign(mesh, { boundingSphere, boundingBox });
  return hit;
}

/** The uppermost of the objects that hold a mesh, unless one of them is hidden: rays hit what is hidden, too. */
function rootOf(mesh: Object3D | undefined): Object3D | undefined {
  while (mesh?.visible && mesh.parent) mesh = mesh.parent;
  return mesh?.visible ? mesh : undefined;
}

function spotOf({ matrix }: Part, hit: Intersection, channel: number, texels: CageTexels | undefined): Spot {
  const mesh = hit.object as Mesh;
  const { geometry } = mesh;
  const { a, b, c } = hit.face!;
  const corners = [a, b, c] as const;
  const placed = new Matrix4().copy(mesh.matrixWorld);
  if (hit.instanceId !== undefined) {
    const instance = new Matrix4();
    (mesh as InstancedMesh).getMatrixAt(hit.instanceId, instance);
    placed.multiply(instance);
  }
  const position = geometry.getAttribute('position') as BufferAttribute;
  const [at, rest] = [
    corners.map((vertex) => (mesh as SkinnedMesh).getVertexPosition(vertex, new Vector3()).applyMatrix4(placed)),
    corners.map((vertex) => new Vector3().fromBufferAttribute(position, vertex)),
  ] as [Corners, Corners];
  const weights = Triangle.getBarycoord(hit.point, ...at, new Vector3()) ?? new Vector3(1, 0, 0);
  const uv = isPainted(mesh, corners) ? uvAt(geometry.getAttribute(`uv${channel}`), corners, weights) : undefined;
  const [posed, stored] = [areaOf(at), areaOf(rest)];
  const size = Math.cbrt(Math.abs(matrix.determinant())) * (posed > 0 && stored > 0 ? Math.sqrt(stored / posed) : 1);
  const side = new Vector3(1, placed.determinant() < 0 ? -1 : 1, 1); // of the triangle that is outside
  const toCage = new Matrix4()
    .extractRotation(matrix)
    .multiply(frameOf(rest))
    .multiply(frameOf(at).scale(side).transpose());
  return {
    mesh,
    point: hit.point,
    uv,
    surface: uv && texels?.at(uv.x, uv.y),
    scale: size > 0 ? 1 / size : 1,
    toCage,
  };
}

type Corners = [Vector3, Vector3, Vector3];

/** As the shader decides it: a triangle is painted if all its vertices are. */
function isPainted({ geometry }: Mesh, corners: readonly number[]): boolean {
  const paint = geometry.getAttribute(paintAttribute);
  if (paint) return corners.every((vertex) => paint.getZ(vertex) === 0 && paint.getW(vertex) > 0);
  const zones = geometry.getAttribute(zoneAttribute);
  return zones !== undefined && corners.every((vertex) => zones.getX(vertex) === 0);
}

type Attribute = ReturnType<Mesh['geometry']['getAttribute']>;

function uvAt(uvs: Attribute, corners: readonly number[], weights: Vector3): Vector2 {
  const uv = new Vector2();
  corners.forEach((vertex, corner) => {
    const weight = weights.getComponent(corner);
    uv.x += weight * uvs.getX(vertex);
    uv.y += weight * uvs.getY(vertex);
  });
  return uv;
}

const areaOf = ([a, b, c]: Corners): number => new Triangle(a, b, c).getArea();

/** A rotation whose axes are an edge of a triangle, its normal, and what is perpendicular to both. */
function frameOf([a, b, c]: Corners): Matrix4 {
  const edge = b.clone().sub(a).normalize();
  const normal = new Triangle(a, b, c).getNormal(new Vector3());
  return new Matrix4().makeBasis(edge, normal, new Vector3().crossVectors(edge, normal));
}

/** Pixels on the screen per unit of length at a point. @param height Pixels of the view. */
export function pixelsPerUnit(camera: Camera, point: Vector3, height: number): number {
  const up = new Vector3().setFromMatrixColumn(camera.matrixWorld, 1).normalize();
  const step = 1e-3 * Math.max(1e-6, point.distanceTo(new Vector3().setFromMatrixPosition(camera.matrixWorld)));
  const [from, to] = [point.clone().project(camera), point.clone().addScaledVector(up, step).project(camera)];
  return (Math.abs(to.y - from.y) * height) / (2 * step);
}
