import { mkdir, readFile, rm, writeFile } from 'node:fs/promises';
import { output, root } from '../native.js';
import { writeScene, type Scene } from '../scene-file.js';

/** The brute-force reference as a command; its source tells the formats of its files. */
export const reference = process.env['CAGECAST_REFERENCE'] ?? `${root}build/release/tests/core/cagecast_reference`;

/** A way to transfer. */
export interface Variant {
  preset: 'paper' | 'earlier' | 'default';
  /** A step that is left out. */
  without?: string;
  threshold?: number;
}

/** What is measured of an answer. */
export interface Answer {
  /** 2 per vertex. */
  uvs: Float32Array;
  /** 1 per vertex: 0 cosmetic; the others must not be painted. */
  zones: Uint8Array;
  /** 1 per vertex: the nearest cage triangle. */
  triangles: Uint32Array;
  /** 1 per vertex: the distance to it. */
  distances: Float32Array;
  /** 1 per triangle. */
  cosmeticTriangles: Uint8Array;
  /** 6 per triangle, with seams; else empty. */
  cornerUvs: Float32Array;
  /** 1 per vertex. */
  segments: Uint32Array;
  /** 1 per segment, as in the sums of step 5. */
  sums: { area: number; exposed: number; covered: number; sunk: number; culled: boolean }[];
}

/** Builds the reference, and what turns glTF files into scenes. */
export async function buildReference(): Promise<void> {
  await output('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING']);
  const targets = process.env['CAGECAST_REFERENCE'] === undefined ? ['cagecast_bench', 'cagecast_reference'] : ['cagecast_bench'];
  await output('cmake', ['--build', '--preset', 'release', '--target', ...targets]);
}

let asked = 0;

/** Asks the reference. */
export async function ask(scene: Scene, { preset, without, threshold }: Variant): Promise<Answer> {
  const folder = `${root}build/bench/quality`;
  await mkdir(folder, { recursive: true });
  const name = `${folder}/${process.pid}-${asked++}`;
  const [question, answer] = [`${name}.scene`, `${name}.answer`];
  try {
    await writeFile(question, writeScene(scene));
    const options = [...(without === undefined ? [] : ['--without', without]), ...(threshold === undefined ? [] : ['--threshold', String(threshold)])];
    await output(reference, [question, answer, '--unchecked', '--preset', preset, ...options]);
    return parse(await readFile(answer));
  } finally {
    await rm(question, { force: true });
    await rm(answer, { force: true });
  }
}

function parse(bytes: Buffer): Answer {
  let at = 8;
  const u32 = (): number => bytes.readUInt32LE((at += 4) - 4);
  const take = (length: number): Uint8Array => {
    const part = Uint8Array.prototype.slice.call(bytes, at, at + length);
    at += Math.ceil(length / 4) * 4;
    return part;
  };
  if (bytes.toString('latin1', 0, 8) !== 'CAGEREF1') throw new Error('the reference wrote no answer');
  const [vertices, segments] = [u32(), u32()];
  const uvs = new Float32Array(take(8 * vertices).buffer);
  const zones = take(vertices);
  const triangles = new Uint32Array(take(4 * vertices).buffer);
  const distances = new Float32Array(take(4 * vertices).buffer);
  const segmentOf = new Uint32Array(take(4 * vertices).buffer);
  take(vertices); // stable
  const f64 = (): number => bytes.readDoubleLE((at += 8) - 8);
  const stats = Array.from({ length: segments }, () => ({ points: u32(), culled: u32() === 1, exposed: f64(), covered: f64() }));
  const [count, corners] = [u32(), u32()];
  const cosmeticTriangles = take(count);
  const cornerUvs = new Float32Array(take(4 * corners).buffer);
  if (corners > 0) take(count); // stable
  const sums = stats.map(({ culled, exposed, covered }) => ({ area: f64(), exposed, covered, sunk: f64(), culled }));
  return { uvs, zones, triangles, distances, cosmeticTriangles, cornerUvs, segments: segmentOf, sums };
}
