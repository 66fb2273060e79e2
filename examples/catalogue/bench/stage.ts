// What the measurements and the disaster need: models, and the programs of the recipe.
import { type ChildProcess, spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { Document, NodeIO } from '@gltf-transform/core';
import type { OwnRedis } from '../redis.ts';

/** Where it happens. The programs find it by the environment. */
export interface Stage {
  folder: string;
  inputs: string;
  outputs: string;
  redis: OwnRedis;
}

/** Quads along and around each model by default: 264 triangles. */
const usualDetail = 12;

/** A sphere as a GLB. */
function sphere(radius: number, detail: number): Promise<Uint8Array> {
  const [positions, uvs, indices]: [number[], number[], number[]] = [[], [], []];
  for (let r = 0; r <= detail; ++r)
    for (let s = 0; s <= detail; ++s) {
      const [theta, phi] = [(Math.PI * r) / detail, (2 * Math.PI * (s % detail)) / detail];
      const flat = r % detail === 0 ? 0 : Math.sin(theta);
      positions.push(radius * flat * Math.cos(phi), radius * flat * Math.sin(phi), radius * Math.cos(theta));
      uvs.push(s / detail, r / detail);
      if (r === detail || s === detail) continue;
      const a = r * (detail + 1) + s;
      const b = a + detail + 1;
      if (r > 0) indices.push(a, b, a + 1);
      if (r < detail - 1) indices.push(a + 1, b, b + 1);
    }
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (type: 'VEC3' | 'VEC2' | 'SCALAR', array: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>) =>
    document.createAccessor().setType(type).setArray(array).setBuffer(buffer);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor('VEC3', new Float32Array(positions)))
    .setAttribute('TEXCOORD_0', accessor('VEC2', new Float32Array(uvs)))
    .setIndices(accessor('SCALAR', new Uint32Array(indices)));
  const node = document.createNode('sphere').setMesh(document.createMesh().addPrimitive(primitive));
  document.createScene().addChild(node);
  return new NodeIO().writeBinary(document);
}

/** A line of a manifest for some transfers, of 20 to each target; writes the models that are not there. */
export async function transfers(
  { inputs }: Stage,
  jobs: number,
  settings: object,
  detail = usualDetail,
): Promise<object> {
  mkdirSync(inputs, { recursive: true });
  const models = async (name: string, count: number, radius: (i: number) => number) => {
    const names = Array.from({ length: count }, (_, i) => `${name}-${i}.glb`);
    for (const [i, file] of names.entries())
      if (!existsSync(join(inputs, file))) writeFileSync(join(inputs, file), await sphere(radius(i), detail));
    return names;
  };
  const target = await models('target', Math.ceil(jobs / 20), (i) => 1 + i / 1e5);
  const cage = await models('cage', 20, (i) => 1.1 + i / 1000);
  return { kind: 'transfer', target, cage, settings };
}

/** Writes a manifest. @returns its path */
export function manifestOf({ folder }: Stage, lines: object[]): string {
  const path = join(folder, 'manifest.jsonl');
  writeFileSync(path, lines.map((line) => `${JSON.stringify(line)}\n`).join(''));
  return path;
}

export interface Program {
  process: ChildProcess;
  /** What it has printed until now. */
  text(): string;
  /** Its exit code. */
  ended: Promise<number | null>;
}

/** Starts a program of the recipe. */
export function start(name: string, args: string[] = [], env: Record<string, string> = {}): Program {
  const path = fileURLToPath(new URL(`../${name}.ts`, import.meta.url));
  const child = spawn(process.execPath, ['--import', import.meta.resolve('tsx'), path, ...args], {
    env: { ...process.env, ...env },
    stdio: ['ignore', 'pipe', 'pipe'],
  });
  let text = '';
  for (const stream of [child.stdout, child.stderr]) stream.on('data', (chunk) => (text += chunk));
  return { process: child, text: () => text, ended: once(child, 'close').then(([code]) => code) };
}

/** Ends programs that run. */
export async function end(programs: Program[]): Promise<void> {
  for (const { process } of programs) process.kill();
  await Promise.all(programs.map(({ ended }) => ended));
}
