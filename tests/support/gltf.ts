import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import type { Accessor, Document, Primitive } from '@gltf-transform/core';
import type { TransferResult } from 'cagecast';

export * from './glb.js';

/**
 * What the Khronos validator says about a file, by its path or its bytes.
 * @param most  The mildest that counts: 0 errors, 1 warnings, 2 information such as what is unused, 3 hints.
 */
export async function validate(file: string | Uint8Array, most = 0): Promise<string[]> {
  const validator = createRequire(import.meta.url)('gltf-validator') as {
    validateBytes(
      bytes: Uint8Array,
      options: object,
    ): Promise<{ issues: { messages: { severity: number; code: string; message: string; pointer: string }[] } }>;
  };
  const { issues } = await validator.validateBytes(
    new Uint8Array(typeof file === 'string' ? readFileSync(file) : file),
    {
      maxIssues: 100,
    },
  );
  return issues.messages
    .filter(({ severity }) => severity <= most)
    .map(({ code, message, pointer }) => `${pointer}: ${code}: ${message}`);
}

/** The primitives of all meshes of a document. */
export const primitivesOf = (document: Document): Primitive[] =>
  document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());

/** Whether a transfer has added a primitive. */
export const isOverlay = (primitive: Primitive): boolean => primitive.getExtras()['cagecastOverlay'] === true;

/** A UV of a file, decoded. */
export const storedUv = (uvs: Accessor, vertex: number): number[] => uvs.getElement(vertex, []);

/** Asserts that a UV of a file is as near to the one that was computed as 16 bits can be. */
export function assertNear(stored: ArrayLike<number>, computed: ArrayLike<number>, text: string): void {
  for (let k = 0; k < 2; ++k)
    assert.ok(Math.abs(stored[k]! - computed[k]!) <= 0.5001 / 65535, `${text}: ${stored[k]}, not ${computed[k]}`);
}

/**
 * Asserts that a primitive has what was transferred to it: the UV and the zone of each corner; and what it had before: its
 * vertices in their order, with copies after them that are like their sources in all attributes and morph targets.
 * @param first  Where the primitive begins in the arrays of the result.
 * @returns how many vertices were added.
 */
export function assertTransferred(
  before: Primitive,
  written: Primitive,
  result: TransferResult,
  first = { vertex: 0, triangle: 0 },
): number {
  const vertices = before.getAttribute('POSITION')!.getCount();
  const all = written.getAttribute('POSITION')!.getCount();
  const cornersOf = (primitive: Primitive) =>
    [
      ...(primitive.getIndices()?.getArray() ?? Array(primitive.getAttribute('POSITION')!.getCount()).keys()),
    ] as number[];
  const [old, corners] = [cornersOf(before), cornersOf(written)];
  assert.equal(corners.length, old.length);
  const sources = Array.from({ length: all }, (_, v) => v);
  corners.forEach((vertex, i) => {
    if (vertex < vertices) assert.equal(vertex, old[i]);
    else sources[vertex] = old[i]!;
  });

  const uvSet = written
    .listSemantics()
    .find((name) => name.startsWith('TEXCOORD_') && before.getAttribute(name) === null);
  assert.ok(uvSet);
  const zones = written.getAttribute('_NCZ')!.getArray()!;
  const uvs = written.getAttribute(uvSet)!;
  corners.forEach((vertex, i) => {
    const at = result.cornerUvs.length > 0 ? 2 * (3 * first.triangle + i) : -1;
    const expected =
      at >= 0
        ? result.cornerUvs.subarray(at, at + 2)
        : result.uvs.subarray(2 * (first.vertex + vertex), 2 * (first.vertex + vertex) + 2);
    assertNear(storedUv(uvs, vertex), expected, `corner ${i}`);
  });
  assert.deepEqual(
    [...zones],
    sources.map((v) => result.zones[first.vertex + v]),
  );

  const sameAs = (a: Accessor, b: Accessor, name: string) => {
    assert.equal(b.getNormalized(), a.getNormalized(), name);
    const size = a.getElementSize();
    const [from, to] = [a.getArray()!, b.getArray()!];
    assert.equal(to.constructor, from.constructor, name);
    assert.equal(to.length, size * all, name);
    sources.forEach((source, v) =>
      assert.deepEqual(
        to.subarray(size * v, size * (v + 1)),
        from.subarray(size * source, size * (source + 1)),
        `${name} of vertex ${v}`,
      ),
    );
  };
  for (const name of before.listSemantics()) sameAs(before.getAttribute(name)!, written.getAttribute(name)!, name);
  before.listTargets().forEach((target, t) => {
    for (const name of target.listSemantics())
      sameAs(target.getAttribute(name)!, written.listTargets()[t]!.getAttribute(name)!, `target ${t}: ${name}`);
  });
  return all - vertices;
}
