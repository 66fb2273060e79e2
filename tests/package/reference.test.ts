import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import type { Mesh, Preset, TransferResult } from 'cagecast';
import { nativeCommand, packages } from '../support/native.js';
import { head, modelFolders, readPlain, type Scene, soup } from './scenes.js';

let native: string;
const folder = mkdtempSync(join(tmpdir(), 'cagecast-reference-'));

interface Answer {
  uvs: Float32Array;
  zones: Uint8Array;
  triangles: Uint32Array;
  distances: Float32Array;
  segments: Uint32Array;
  stable: Uint8Array;
  stats: { points: number; culled: boolean; exposedArea: number; coveredArea: number }[];
  cosmeticTriangles: Uint8Array;
  /** 6 per triangle, with the preset `default`; else none. */
  cornerUvs: Float32Array;
  /** 1 per triangle with corner UVs, by the reference alone: 0 where rounding decides them. */
  stableCorners: Uint8Array;
}

function writeScene(path: string, { cage, target }: Scene): void {
  const parts: Uint8Array[] = [Buffer.from('CAGESCN1')];
  const add = (array: Float32Array | Uint32Array) =>
    parts.push(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  for (const { positions, indices, uvs, groups } of [cage, target] satisfies Mesh[]) {
    add(new Uint32Array([positions.length / 3, indices.length]));
    parts.push(new Uint8Array([uvs ? 1 : 0, groups ? 1 : 0, 0, 0]));
    add(positions);
    add(Uint32Array.from(indices));
    if (uvs) add(uvs);
    if (groups) add(groups);
  }
  writeFileSync(path, Buffer.concat(parts));
}

function readAnswer(path: string): Answer {
  const bytes = new Uint8Array(readFileSync(path));
  const view = new DataView(bytes.buffer);
  let at = 8;
  assert.equal(Buffer.from(bytes.subarray(0, 8)).toString(), 'CAGEREF1');
  const u32 = () => view.getUint32((at += 4) - 4, true);
  const f64 = () => view.getFloat64((at += 8) - 8, true);
  const take = (length: number) => {
    const part = bytes.slice(at, at + length);
    at += Math.ceil(length / 4) * 4;
    return part;
  };
  const [vertices, segments] = [u32(), u32()];
  const perVertex = {
    uvs: new Float32Array(take(8 * vertices).buffer),
    zones: take(vertices),
    triangles: new Uint32Array(take(4 * vertices).buffer),
    distances: new Float32Array(take(4 * vertices).buffer),
    segments: new Uint32Array(take(4 * vertices).buffer),
    stable: take(vertices),
    stats: Array.from({ length: segments }, () => ({
      points: u32(),
      culled: u32() === 1,
      exposedArea: f64(),
      coveredArea: f64(),
    })),
  };
  const [triangles, corners] = [u32(), u32()];
  const cosmeticTriangles = take(triangles);
  const cornerUvs = new Float32Array(take(4 * corners).buffer);
  return {
    ...perVertex,
    cosmeticTriangles,
    cornerUvs,
    stableCorners: at < bytes.length && corners > 0 ? take(triangles) : new Uint8Array(0),
  };
}

/** What the reference, or with `--product` the native library, answers. */
function ask(scene: Scene, preset: Preset, threshold: number, ...flags: string[]): Answer {
  const [sceneFile, resultFile] = [join(folder, 'scene'), join(folder, 'result')];
  writeScene(sceneFile, scene);
  const { status, stderr } = spawnSync(
    native,
    [sceneFile, resultFile, '--preset', preset, '--threshold', String(threshold), ...flags],
    { encoding: 'utf8' },
  );
  assert.equal(status, 0, `${native} failed: ${stderr}`);
  return readAnswer(resultFile);
}

/** Asserts that every stable vertex has the reference's zone, triangle and UV, every stable triangle its verdict and its corners' UVs. @returns a line about it. */
function compare(reference: Answer, result: TransferResult, indices: Mesh['indices']): string {
  const vertices = reference.zones.length;
  assert.equal(result.zones.length, vertices);
  let unstable = 0;
  const differences: string[] = [];
  for (let v = 0; v < vertices; ++v) {
    if (!reference.stable[v]) {
      ++unstable;
      continue;
    }
    const same =
      reference.zones[v] === result.zones[v] &&
      reference.triangles[v] === result.triangles[v] &&
      Math.abs(reference.uvs[2 * v]! - result.uvs[2 * v]!) <= 1e-5 &&
      Math.abs(reference.uvs[2 * v + 1]! - result.uvs[2 * v + 1]!) <= 1e-5;
    if (!same)
      differences.push(
        `vertex ${v}: zone ${result.zones[v]} for ${reference.zones[v]}, triangle ${result.triangles[v]} for ${reference.triangles[v]}, uv ${result.uvs.subarray(2 * v, 2 * v + 2)} for ${reference.uvs.subarray(2 * v, 2 * v + 2)}`,
      );
  }
  let unstableTriangles = 0;
  assert.equal(result.cornerUvs.length, reference.cornerUvs.length);
  for (let t = 0; t < indices.length / 3; ++t) {
    if (
      [0, 1, 2].every((k) => reference.stable[indices[3 * t + k]!]) &&
      result.cosmeticTriangles[t] !== reference.cosmeticTriangles[t]
    ) {
      differences.push(`triangle ${t}: cosmetic ${result.cosmeticTriangles[t]} for ${reference.cosmeticTriangles[t]}`);
    }
    if (reference.cornerUvs.length === 0) continue;
    if (!reference.stableCorners[t]) {
      ++unstableTriangles;
      continue;
    }
    const [ours, theirs] = [result.cornerUvs, reference.cornerUvs].map((all) => [
      ...all.subarray(6 * t, 6 * t + 6),
    ]) as [number[], number[]];
    if (ours.some((value, i) => Math.abs(value - theirs[i]!) > 1e-5))
      differences.push(`triangle ${t}: corners ${ours} for ${theirs}`);
  }
  const line = `${vertices} vertices, ${differences.length} differences, ${unstable} vertices and the corners of ${unstableTriangles} triangles unstable`;
  assert.equal(differences.length, 0, `${line}\n${differences.slice(0, 5).join('\n')}`);
  assert.deepEqual(result.segments, reference.segments);
  return line;
}

function unstableShare({ stable }: Answer): number {
  return stable.filter((one) => one === 0).length / stable.length;
}

/** A hash of the bits of an answer. */
function hash({
  uvs,
  zones,
  triangles,
  distances,
  segments,
  cosmeticTriangles,
  cornerUvs,
}: Omit<Answer, 'stable' | 'stats' | 'stableCorners'>): string {
  const sum = createHash('sha256');
  for (const array of [uvs, zones, triangles, distances, segments, cosmeticTriangles, cornerUvs])
    sum.update(new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
  return sum.digest('hex');
}

describe('the package gives the answer of the reference, and the bits of the native library', () => {
  let builds: [string, Awaited<ReturnType<typeof packages>>['inline']][] = [];

  before(async () => {
    native = nativeCommand();
    builds = Object.entries(await packages());
  });
  after(() => rmSync(folder, { recursive: true, force: true }));

  const scenes: (() => Promise<Scene>)[] = [
    ...[1, 2, 3, 4, 5, 6].map((seed) => async () => head(seed)),
    ...[1, 2, 3, 4, 5, 6].map((seed) => async () => soup(seed)),
    ...modelFolders().map((model) => async () => ({
      name: basename(model),
      cage: await readPlain(join(model, 'cage.glb')),
      target: await readPlain(join(model, 'target.glb')),
    })),
  ];
  for (const [i, makeScene] of scenes.entries()) {
    const isModel = i >= 12;
    const name = isModel ? basename(modelFolders()[i - 12]!) : `${i < 6 ? 'head' : 'soup'}, seed ${(i % 6) + 1}`;
    for (const preset of ['paper', 'default'] as const) {
      test(`${name}, ${preset}`, async (context) => {
        const scene = await makeScene();
        for (const threshold of isModel ? [0.5] : [0.5, 0.2]) {
          const reference = ask(scene, preset, threshold);
          const product = ask(scene, preset, threshold, '--product');
          for (const [build, { transfer }] of builds) {
            const result = transfer(scene.cage, scene.target, { preset, threshold });
            assert.equal(hash(result), hash(product), `${build}: not the bits of the native library`);
            assert.deepEqual(
              result.segmentStats.map(({ points, culled, exposedArea, coveredArea }) => ({
                points,
                culled,
                exposedArea,
                coveredArea,
              })),
              product.stats,
              `${build}: not the segments of the native library`,
            );
            context.diagnostic(
              `${name}, ${preset}, ${build}, threshold ${threshold}: ${compare(reference, result, scene.target.indices)}`,
            );
          }
          if (isModel)
            assert.ok(unstableShare(reference) <= 0.01, `${unstableShare(reference)} of the vertices are unstable`);
        }
      });
    }
  }
});
