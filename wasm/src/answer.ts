import type { Answer } from './bindings.js';
import { dropInstance } from './engine.js';
import { CagecastError, coreCodes } from './error.js';
import { type CheckedMesh, count } from './mesh.js';
import { type CheckedOptions, numberOf, ranges } from './options.js';

/** Throws what the core reports, in words: function, argument, element, value and limit. */
export function checkAnswer(
  fn: string,
  answer: Answer,
  cage: CheckedMesh | undefined,
  target: CheckedMesh | undefined,
  options?: CheckedOptions,
): void {
  if (answer.code === 0) return;
  const code = coreCodes[answer.code - 1] ?? 'internal';
  if (code === 'outOfMemory') dropInstance();
  const name = answer.argument === 1 ? 'cage' : 'target';
  const { at } = answer;
  throw new CagecastError(
    code,
    `${fn}: ${describe(code, at, name, name === 'cage' ? cage : target, options?.core)}`,
    at,
  );
}

function describe(
  code: string,
  at: number,
  name: string,
  mesh: CheckedMesh | undefined,
  options: readonly number[] | undefined,
): string {
  if (code === 'badOption' && options) {
    for (const [key, [low, high]] of Object.entries(ranges)) {
      const value = numberOf(options, key as keyof typeof ranges);
      if (!(value >= low && value <= Math.fround(high)))
        return `options.${key} = ${value} is not within ${low}..${high}`;
    }
  }
  if (code === 'outOfMemory') return `not enough memory for this target${options ? ' and cage' : ''}`;
  if (mesh === undefined) return `failed (${code})`;
  const { positions, indices, uvs, groups } = mesh;
  const vertices = count(positions.length / 3, 'vertex');
  switch (code) {
    case 'emptyMesh':
      return `${name} has no ${positions.length === 0 ? 'vertices' : 'triangles'}; at least one is needed`;
    case 'positionsNotTriples':
      return `${name}.positions has ${positions.length} numbers, not 3 per vertex`;
    case 'indicesNotTriples':
      return `${name}.indices has ${indices.length} entries, not 3 per triangle`;
    case 'missingUvs':
      return `${name}.uvs is missing: the texture is drawn in the cage's UVs, 2 per vertex`;
    case 'uvCountMismatch':
      return `${name}.uvs has ${uvs.length} numbers, not 2 for each of ${vertices}`;
    case 'groupCountMismatch':
      return `${name}.groups has ${groups.length} entries, not 1 for each of ${vertices}`;
    case 'indexOutOfRange':
      return `${name}.indices[${at}] = ${indices[at]} is out of range (${vertices})`;
    case 'nonFinitePosition':
      return `${name}.positions[${at}] = ${positions[at]} is not a finite number`;
    case 'nonFiniteUv':
      return `${name}.uvs[${at}] = ${uvs[at]} is not a finite number`;
    case 'noUsableCageTriangle':
      return 'cage has no triangle with an area';
    case 'tooLarge':
      return at < positions.length && positions.length / 3 <= 2 ** 28 && indices.length / 3 <= 2 ** 28
        ? `${name}.positions[${at}] = ${positions[at]} is out of all proportion (farther from the origin than 1e8 diagonals of the target)`
        : `${name} has ${vertices} and ${count(indices.length / 3, 'triangle')}, more than ${2 ** 28} of a kind`;
    default:
      return `failed (${code})`;
  }
}
