import type { TemplateName } from 'cagecast/cages';
import { Box3, Vector3 } from 'three';

/** The template that a model of this shape likely needs, y being up; the user may choose another. */
export function likelyTemplate(positions: Float32Array): TemplateName {
  const { x, y, z } = new Box3().setFromArray(positions).getSize(new Vector3());
  // A figure is flat, whether its arms hang or are stretched out, a car is low; a head is neither.
  if (z < 0.5 * y) return 'human-body';
  return y < 0.55 * Math.max(x, z) ? 'car' : 'human-head';
}
