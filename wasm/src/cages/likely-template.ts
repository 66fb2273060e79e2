import { boxOf } from '../inspect/geometry.js';
import type { TemplateName } from './template-names.js';

/** Words in names of joints, meshes and materials that tell what a model is; figures have joints of both. */
const kOfCars = /wheel|windshield|windscreen|bumper|(?<![a-z])(tyre|tire)s?(?![a-z])/i;
const kOfFigures = [/thigh|leg|shin|calf|knee/i, /arm|elbow|hand|shoulder/i];

/**
 * The template that a model likely needs.
 * @param positions 3 each, y being up: its shape decides if no names do.
 */
export function likelyTemplate(
  positions: ArrayLike<number>,
  { joints, parts }: { joints: readonly string[]; parts: readonly string[] } = { joints: [], parts: [] },
): TemplateName {
  if (kOfFigures.every((words) => joints.some((name) => words.test(name)))) return 'human-body';
  if (parts.some((name) => kOfCars.test(name))) return 'car';
  const { min, max } = boxOf(positions);
  const [x, y, z] = max.map((high, k) => high - min[k]!) as [number, number, number];
  // A figure is flat, whether its arms hang or are stretched out, a car is low; a head is neither.
  if (z < 0.5 * y) return 'human-body';
  return y < 0.55 * Math.max(x, z) ? 'car' : 'human-head';
}
