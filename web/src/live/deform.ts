import type { Vector3 } from 'three';

/** Ways to move a model out of its shape. */
export const kDeforms = ['bend', 'twist', 'inflate'] as const;
export type Deform = (typeof kDeforms)[number];

/** The room that a deformation is measured by: the box of the model at rest. */
export interface Room {
  center: Vector3;
  /** Half of its height. */
  half: number;
}

const kBend = 1.1; // radians, from the bottom to the top
const kTwist = 1.6;
const kInflate = 0.3; // of the distance from the centre

/**
 * Moves a point of the model, and keeps neighbours neighbours.
 * @param amount From −1 to 1; 0 leaves it where it is.
 */
export function deform(point: Vector3, how: Deform, amount: number, { center, half }: Room): void {
  if (amount === 0) return;
  point.sub(center);
  const { x, y, z } = point;
  const height = Math.max(-1, Math.min(1, y / half)); // beyond the box everything moves as its rim does
  if (how === 'twist') {
    const turn = 0.5 * kTwist * amount * height;
    point.set(x * Math.cos(turn) + z * Math.sin(turn), y, z * Math.cos(turn) - x * Math.sin(turn));
  } else if (how === 'bend') {
    // Around an axis far to the side, about which the middle stays where it is.
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
