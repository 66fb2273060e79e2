import type { Vector3 } from 'three';

/** Deformations of a model. */
export const kDeforms = ['bend', 'twist', 'inflate'] as const;
export type Deform = (typeof kDeforms)[number];

/** The shape of a model that the user chose. */
export interface ChosenShape {
  deform: Deform;
  /** From −1 to 1; 0 is the rest shape. */
  amount: number;
  /** Whether the cage is deformed too. */
  cage: boolean;
  /** Morph weights by name; the others are as in the file. */
  morphs: ReadonlyMap<string, number>;
}

/** The bounding box of the model at rest, which scales a deformation. */
export interface Extent {
  center: Vector3;
  /** Half its height. */
  half: number;
}

const kBend = 1.1; // radians, from the bottom to the top
const kTwist = 1.6;
const kInflate = 0.3; // of the distance from the centre

/**
 * Moves a point of the model; continuous, so that the surface does not tear.
 * @param amount From −1 to 1; 0 leaves it where it is.
 */
export function deform(point: Vector3, how: Deform, amount: number, { center, half }: Extent): void {
  if (amount === 0) return;
  point.sub(center);
  const { x, y, z } = point;
  const height = Math.max(-1, Math.min(1, y / half)); // beyond the box points move with its top or bottom
  if (how === 'twist') {
    const turn = 0.5 * kTwist * amount * height;
    point.set(x * Math.cos(turn) + z * Math.sin(turn), y, z * Math.cos(turn) - x * Math.sin(turn));
  } else if (how === 'bend') {
    // A rotation about an axis at the side; points at half height stay in place.
    const turn = 0.5 * kBend * amount * height;
    const radius = half / (0.5 * kBend * amount);
    const beyond = y - height * half;
    point.set(
      radius - (radius - x) * Math.cos(turn) - beyond * -Math.sin(turn),
      (radius - x) * Math.sin(turn) + beyond * Math.cos(turn),
      z,
    );
  } else {
    point.multiplyScalar(1 + kInflate * amount * Math.exp(-point.lengthSq() / half ** 2));
  }
  point.add(center);
}
