import { createRequire } from 'node:module';
import { components, corners, diagonalOf, faceNormal, join, type Mesh, point, triangleCount } from './mesh.ts';
import type { Model } from './model.ts';
import { spaceOf } from './space.ts';
import { type Truth, weldPositions } from './truth.ts';
import { borderLoops, perimeter, uvOverlap } from './unwrap.ts';
import { length, sub } from './vec.ts';

// The validator is a CommonJS module without types.
const validator = createRequire(import.meta.url)('gltf-validator') as {
  validateBytes(
    bytes: Uint8Array,
  ): Promise<{ issues: { numErrors: number; messages: { severity: number; message: string; pointer: string }[] } }>;
};

const kCageTriangles = { head: [300, 900], body: [1200, 1600], prop: [300, 900] } as const;
const kThinnest = 5e-3; // height of a cage triangle as a share of its longest edge: flatter ones have no reliable normal
const kMinRim = 0.02; // perimeter of a hole that is meant, as a share of the cage's diagonal
const kOverlap = 1e-3; // share of the covered UV area: what a grid's rounding can amount to

/** What is wrong with a model, one line each; nothing if it is as it should be. */
export const faultsOf = async (model: Model, truth: Truth, files: Record<string, Uint8Array>): Promise<string[]> => {
  const faults: string[] = [];
  const expect = (holds: boolean, fault: string): void => void (holds || faults.push(fault));
  const { cage } = model;

  for (const [name, bytes] of Object.entries(files)) {
    const { issues } = await validator.validateBytes(bytes);
    const first = issues.messages.find((m) => m.severity === 0);
    expect(
      issues.numErrors === 0,
      `${name} is no valid glTF: ${issues.numErrors} errors, the first: ${first?.message} at ${first?.pointer}`,
    );
  }

  faults.push(...cageFaults(cage, model.template?.kind ?? 'head'));

  expect(truth.vertexCount === truth.ncz.length, 'the truth does not cover every vertex');
  expect(truth.ncz.includes(0) && truth.ncz.includes(1), 'the truth knows only one side');
  if (model.misfit) return faults;
  const whole = join(...model.parts.map((p) => p.mesh));
  const space = spaceOf(cage);
  const outside = truth.ncz.flatMap((ncz, v) =>
    !ncz && !truth.ignore[v] && !truth.offCage[v] && space.nearest(point(whole, v)).side > 0 ? [v] : [],
  );
  expect(
    outside.length === 0,
    `vertex ${outside[0]} (and ${outside.length - 1} more) of the skin lies outside the cage`,
  );
  return faults;
};

/** What is wrong with a cage of some kind by itself, one line each. */
export const cageFaults = (cage: Mesh, kind: keyof typeof kCageTriangles): string[] => {
  const faults: string[] = [];
  const expect = (holds: boolean, fault: string): void => void (holds || faults.push(fault));
  const triangles = triangleCount(cage);
  const [fewest, most] = kCageTriangles[kind];
  expect(triangles >= fewest && triangles <= most, `the cage has ${triangles} triangles, not ${fewest} to ${most}`);
  const welded = weldPositions(cage);
  expect(new Set(components(welded)).size === 1, 'the cage is not in one piece');
  const flat = Array.from({ length: triangles }, (_, t) => t).filter((t) => thinness(cage, t) < kThinnest);
  expect(flat.length === 0, `cage triangle ${flat[0]} (and ${flat.length - 1} more) is flat`);
  const rims = borderLoops(welded).map((loop) => perimeter(welded, loop));
  expect(
    Math.min(...rims) > kMinRim * diagonalOf(cage.positions),
    `the cage has a crack of ${Math.min(...rims).toFixed(3)} around`,
  );
  const overlap = uvOverlap(cage);
  expect(overlap < kOverlap, `${(100 * overlap).toFixed(2)} % of the cage's UV area is covered twice`);
  expect(
    cage.uvs!.every((x) => x >= 0 && x <= 1),
    "the cage's UVs leave 0..1",
  );
  return faults;
};

/** The least height of a triangle as a share of its longest edge. */
const thinness = (mesh: Mesh, triangle: number): number => {
  const p = corners(mesh, triangle).map((v) => point(mesh, v));
  const longest = Math.max(...p.map((a, k) => length(sub(a, p[(k + 1) % 3]!))));
  return length(faceNormal(mesh, triangle)) / longest ** 2;
};
