import {
  BufferGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  type Material,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  Quaternion,
  SphereGeometry,
  Vector3,
} from 'three';
import { cornersOf, type Surface } from '../state/surface';
import { kZones } from '../state/zones';
import type { BoundaryLoops } from './boundary-loops';
import type { Explanation } from './explanation';
import type { Path } from './path';

const kCageColor = '#19b394';
/** Colours of the spot by zone; cosmetic is in the cage's colour. */
const kSpotColors = kZones.map(({ name, color }) => (name === 'cosmetic' ? kCageColor : color));
/** Colours of the ray by outcome, which later steps may overrule. */
export const kRayColors: Record<Path['outcome'], string> = {
  covered: kCageColor,
  pokesOut: kCageColor,
  hidden: kSpotColors[1]!,
  lost: kSpotColors[2]!,
};
const kInk = '#14181d';

// Shares of the model's diagonal.
const kThick = 0.0028;
const kThin = 0.0014;
const kBall = 0.0085;
/** Length of a ray that meets nothing. */
export const kAway = 0.22;

/**
 * Draws an explanation in the space of the target: the spot, the closest cage triangle, the ray and what it hit, and the
 * boundary loops of the cage if the ray left through a hole. Behind the model it is drawn faintly.
 */
export class ExplanationMarks {
  readonly object = new Group();
  readonly #materials: Material[] = [];

  constructor(
    { zone, path, cageTriangle, diagonal }: Explanation,
    target: Surface,
    cage: Surface,
    loops: BoundaryLoops,
  ) {
    const { start, closest, normal, outcome } = path;
    const color = kRayColors[outcome];
    const hit = outcome === 'hidden' ? path.model : outcome === 'covered' ? path.cage : undefined;
    const end = start.clone().addScaledVector(normal, hit ? Math.max(0, hit.length) : kAway * diagonal);

    this.#add(flat(cornersOf(cage, cageTriangle)), kCageColor, 0.3);
    for (const edge of edgesOf(cornersOf(cage, cageTriangle)))
      this.#add(rod(...edge, kThin * diagonal), kCageColor, 0.9);
    if (outcome === 'hidden') this.#add(flat(cornersOf(target, hit!.triangle)), color, 0.65);

    this.#add(rod(start, end, kThick * diagonal), color, 1);
    if (hit) this.#add(ball(end, kBall * diagonal), color, 1);
    else this.#add(tip(end, normal, 3 * kThick * diagonal), color, 1);
    if (outcome === 'lost') this.#outline(loops.lines, color);
    // The closest point mostly coincides with the hit.
    if (closest.distanceTo(end) > kBall * diagonal) {
      this.#add(rod(start, closest, kThin * diagonal), kInk, 0.8);
      this.#add(ball(closest, (kBall / 2) * diagonal), kInk, 0.8);
    }
    this.#add(ball(start, kBall * diagonal), '#ffffff', 1);
    this.#add(ball(start, 0.6 * kBall * diagonal), kSpotColors[zone]!, 1, true);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.traverse(
      (object: Object3D) => (object instanceof Mesh || object instanceof LineSegments) && object.geometry.dispose(),
    );
    for (const material of this.#materials) material.dispose();
  }

  #add(geometry: BufferGeometry, color: string, opacity: number, onTop = false): void {
    const common = { color, transparent: true, side: DoubleSide, toneMapped: false };
    const behind = new MeshBasicMaterial({
      ...common,
      opacity: onTop ? opacity : 0.32 * opacity,
      depthTest: false,
      depthWrite: false,
    });
    this.#materials.push(behind);
    this.#show(geometry, behind, onTop ? 6 : 4);
    if (onTop) return;
    const front = new MeshBasicMaterial({
      ...common,
      opacity,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: -2,
      polygonOffsetUnits: -2,
    });
    this.#materials.push(front);
    this.#show(geometry, front, 5);
  }

  #outline(lines: Vector3[], color: string): void {
    const material = new LineBasicMaterial({ color, transparent: true, toneMapped: false });
    this.#materials.push(material);
    const outline = new LineSegments(new BufferGeometry().setFromPoints(lines), material);
    outline.renderOrder = 5;
    this.object.add(outline);
  }

  #show(geometry: BufferGeometry, material: MeshBasicMaterial, order: number): void {
    const mesh = new Mesh(geometry, material);
    mesh.renderOrder = order;
    this.object.add(mesh);
  }
}

function flat(corners: [Vector3, Vector3, Vector3]): BufferGeometry {
  return new BufferGeometry().setFromPoints(corners);
}

function edgesOf([a, b, c]: [Vector3, Vector3, Vector3]): [Vector3, Vector3][] {
  return [
    [a, b],
    [b, c],
    [c, a],
  ];
}

function rod(from: Vector3, to: Vector3, radius: number): BufferGeometry {
  const along = to.clone().sub(from);
  const geometry = new CylinderGeometry(radius, radius, along.length(), 8, 1, true);
  return turn(geometry, along.normalize()).translate(...from.clone().add(to).multiplyScalar(0.5).toArray());
}

function tip(at: Vector3, direction: Vector3, radius: number): BufferGeometry {
  return turn(new CylinderGeometry(0, radius, 3 * radius, 12), direction).translate(...at.toArray());
}

function ball(at: Vector3, radius: number): BufferGeometry {
  return new SphereGeometry(radius, 16, 12).translate(...at.toArray());
}

/** Rotates the y axis to a direction. */
function turn(geometry: BufferGeometry, direction: Vector3): BufferGeometry {
  return geometry.applyQuaternion(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), direction));
}
