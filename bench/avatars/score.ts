import { Zone } from 'cagecast';
import type { CageModel, Template } from 'cagecast/cages';
import { Vector3 } from 'three';
import { bordersOf, type Shape, triangleAt, vertexAt } from '../quality/shape.js';
import type { Face, Parts, Spot } from './labels.js';

/** Measures of a painted avatar; one without a value is not there. Distances are in multiples of that from the eyes' middle to the mouth. */
export interface Score {
  /** How far the holes of eyes and mouth are off: the worst of them. */
  face?: number | undefined;
  /** The shares that are painted of eyes and of clothes. */
  eyes?: number | undefined;
  clothes?: number | undefined;
  /** The share of the face's skin that stays bare. */
  bare?: number | undefined;
}

/** What depth counts, against the face's plane: a cage lies before the skin. */
const kDepthWeight = 0.25;

/** How far around a mark parts called eyes are, or an iris, and around its middle a face, in distances from eyes to mouth. */
const [kEyeReach, kIrisReach, kFaceReach] = [0.3, 0.1, 1.2];

/** The least cosine between a normal and the face's direction at which a triangle is seen from the front. */
const kFacing = 0.2;

/** Axes of a face: to the model's left, up and forward, around its middle; `unit` from the eyes' middle to the mouth. */
export function frameOf({ eyeL, eyeR, mouth }: Face) {
  const [left, right, below] = [eyeL, eyeR, mouth].map((spot) => new Vector3(...spot)) as [Vector3, Vector3, Vector3];
  const x = left.clone().sub(right).normalize();
  const rise = left.clone().add(right).divideScalar(2).sub(below);
  const y = rise.clone().addScaledVector(x, -rise.dot(x)).normalize();
  const middle = left.clone().add(right).add(below).divideScalar(3);
  return { x, y, z: x.clone().cross(y), middle, unit: rise.length() };
}

/** How far two spots are apart as seen from before a face. */
function apart(face: Face, spot: Spot, other: Vector3): number {
  const { x, y, z, unit } = frameOf(face);
  const off = other.clone().sub(new Vector3(...spot));
  return Math.hypot(off.dot(x), off.dot(y), kDepthWeight * off.dot(z)) / unit;
}

/** How far the holes of eyes and mouth are off: the worst; infinite without holes. Of a cage whose holes have no names, those nearest to the eyes. */
export function faceError(cage: Template, face: Face): number {
  const middle = (loop: readonly number[]): Vector3 =>
    loop.reduce((sum, v) => sum.add(vertexAt(cage.positions, v)), new Vector3()).divideScalar(loop.length);
  const { eye_left: left, eye_right: right, mouth } = cage.holes ?? {};
  const errors = left && right ? [apart(face, face.eyeL, middle(left)), apart(face, face.eyeR, middle(right))] : [];
  if (mouth && !face.guessed) errors.push(apart(face, face.mouth, middle(mouth)));
  if (errors.length > 0) return Math.max(...errors);
  const holes = bordersOf(cage as Shape).map(middle);
  return Math.max(...[face.eyeL, face.eyeR].map((eye) => Math.min(...holes.map((hole) => apart(face, eye, hole)))));
}

/** @param zones  Of the model's vertices. */
export function scoreOf(
  cage: Template,
  model: CageModel,
  zones: ArrayLike<number>,
  face?: Face,
  parts: Parts = {},
): Score {
  const isOf = (kind: keyof Parts, t: number): boolean => {
    const names = model.names?.[model.groups?.[model.indices[3 * t]!] ?? 0] ?? [];
    return [names].flat().some((name) => parts[kind]?.includes(name));
  };
  const isPainted = (t: number): boolean => {
    const corners = [0, 1, 2].map((k) => zones[model.indices[3 * t + k]!]);
    return corners.includes(Zone.Cosmetic) && corners.every((zone) => zone! <= Zone.Occluded);
  };
  const triangles = Array.from({ length: model.indices.length / 3 }, (_, t) => t);
  const share = (some: readonly number[]): number | undefined => {
    const area = (those: readonly number[]): number =>
      those.reduce((sum, t) => sum + triangleAt(model as Shape, t).getArea(), 0);
    return some.length > 0 ? area(some.filter(isPainted)) / area(some) : undefined;
  };
  const score: Score = { clothes: share(triangles.filter((t) => isOf('clothes', t))) };
  if (!face) return score;
  const { x, y, z, middle, unit } = frameOf(face);
  const near = (t: number, spot: Vector3, reach: number): boolean => {
    const triangle = triangleAt(model as Shape, t);
    const off = triangle.getMidpoint(new Vector3()).sub(spot);
    const isFacing = triangle.getNormal(new Vector3()).dot(z) > kFacing;
    return isFacing && Math.hypot(off.dot(x), off.dot(y)) < reach * unit && Math.abs(off.dot(z)) < kFaceReach * unit;
  };
  const eyes = [face.eyeL, face.eyeR].map((spot) => new Vector3(...spot));
  const isEye = (t: number): boolean =>
    parts.eyes
      ? isOf('eyes', t) && eyes.some((eye) => near(t, eye, kEyeReach))
      : eyes.some((eye) => near(t, eye, kIrisReach));
  const isSkin = (t: number): boolean => !(['eyes', 'hair', 'clothes'] as const).some((kind) => isOf(kind, t));
  const painted = share(triangles.filter((t) => isSkin(t) && near(t, middle, kFaceReach)));
  return {
    ...score,
    face: faceError(cage, face),
    eyes: share(triangles.filter(isEye)),
    bare: painted === undefined ? undefined : 1 - painted,
  };
}
