import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { setTimeout } from 'node:timers/promises';
import type { Browser } from 'playwright-core';

/** The packages of this folder: bundlers, test runners, old compilers, and peers that only examples need. */
export const hostTools = resolve('tests/release/hosts/node_modules');

/** Runs a command, which must succeed. @returns what it wrote. */
export function run(command: string, args: string[], cwd: string, env: Record<string, string> = {}): string {
  const { status, stdout, stderr } = spawnSync(command, args, {
    cwd,
    encoding: 'utf8',
    env: { ...process.env, NODE_OPTIONS: '', ...env },
  });
  assert.equal(status, 0, `${command} ${args.join(' ')}:\n${stdout}${stderr}`);
  return stdout + stderr;
}

/** An empty folder of a user, into which the packed package is installed as npm does it, without a network. */
export function installPacked(): string {
  const user = mkdtempSync(join(tmpdir(), 'cagecast-host-'));
  const pack = run('npm', ['pack', '--json', '--ignore-scripts', '--pack-destination', user], process.cwd());
  const file = /"filename": "([^"]+)"/.exec(pack)![1]!;
  // Without the setting Parcel does not read "exports".
  const manifest = { private: true, type: 'module', '@parcel/resolver-default': { packageExports: true } };
  writeFileSync(join(user, 'package.json'), JSON.stringify(manifest));
  run('npm', ['install', '--offline', '--no-audit', '--no-fund', '--ignore-scripts', join(user, file)], user);
  return user;
}

/** What an entry of the core does for a user, by a function. */
export const coreOf = (entry: string): string => `
import { CagecastError, classify, cutBorders, init, project, transfer, Zone } from '${entry}';
const mesh = (z) => ({ positions: new Float32Array([0, 0, z, 1, 0, z, 0, 1, z]), indices: new Uint32Array([0, 1, 2]), uvs: new Float32Array([0, 0, 1, 0, 0, 1]) });
const [cage, target] = [mesh(0.1), mesh(0)];
const codeOf = async (call) => { try { return await call() && ''; } catch (error) { return error instanceof CagecastError && error.code; } };
async function core() {
  await init();
  const result = transfer(cage, target);
  const { triangles, cosmeticTriangles } = cutBorders(cage, target, result);
  const decided = classify(project(cage, target), { threshold: 0.2 });
  const codes = [await codeOf(() => transfer(cage, { ...target, positions: new Float32Array(9).fill(NaN) })), await codeOf(() => cutBorders(cage, target, {}))];
  return [...result.uvs, ...result.zones, ...decided.zones, Zone.Culled, [...triangles].every((t) => t === 0), [...cosmeticTriangles].every((one) => one === 1), ...codes].join(' ');
}
`;
export const coreAnswer = '0 0 1 0 0 1 0 0 0 0 0 0 3 true true nonFinitePosition badArgument';

/** A script that prints, or keeps, what the core gives. */
export const coreScript = (entry: string): string => `${coreOf(entry)}
globalThis.answer = await core();`;

/** Each file of the package that a script names: the WebAssembly of the core, both workers, and a template. */
export const programOf = (entry: string): string => `${coreOf(entry)}
import * as worker from 'cagecast/worker';
import { loadTemplate, makeCage } from 'cagecast/cages';
const tetrahedron = { positions: new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]), indices: new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]) };
const steps = [
  core,
  async () => {
    const [{ uvs }, { zones }] = [await worker.transfer(cage, target), await worker.classify(await worker.project(cage, target), { threshold: 0.2 })];
    return [...uvs, ...zones].join(' ');
  },
  async () => {
    const shares = [];
    const { uvs, positions, indices } = await makeCage(tetrahedron, { triangles: 100, voxels: 40, onProgress: (share) => shares.push(share) });
    const failed = await makeCage({ ...tetrahedron, indices: new Uint32Array(0) }).catch((error) => error.name === 'CagecastError' && error.code);
    return [indices.length > 100, uvs.length / 2 === positions.length / 3, shares.at(-1), failed].join(' ');
  },
  async () => (await loadTemplate('car')).kind,
];
export const answer = await Promise.all(steps.map((step) => step().catch((error) => error.message)));
globalThis.answer = answer;
`;
export const answer = [coreAnswer, '0 0 1 0 0 1 0 0 0', 'true true 1 badModel', 'prop'];

/** Opens a page. @returns the answer that it gives in the end. */
export async function answerOf(browser: Browser, address: string): Promise<unknown> {
  const page = await browser.newPage();
  const faults: string[] = [];
  page.on('pageerror', (error) => faults.push(String(error)));
  await page.goto(address);
  let found: unknown;
  // Playwright's own waiting evaluates strings in the page, which a policy may forbid.
  for (const end = Date.now() + 60000; found === undefined && Date.now() < end && faults.length === 0; ) {
    found = await page.evaluate('globalThis.answer');
    await setTimeout(20);
  }
  assert.deepEqual(faults, [], address);
  await page.close();
  return found;
}

/** Makes a folder with packages in it, by links. */
export function linkPackages(folder: string, names: readonly string[], from = resolve('node_modules')): void {
  for (const name of names) {
    mkdirSync(join(folder, 'node_modules', name, '..'), { recursive: true });
    symlinkSync(join(from, name), join(folder, 'node_modules', name));
  }
}

/** Checks the types of a program in a folder of its own, strictly. @param tsc  The compiler, of a package. */
export function checkTypes(tsc: string, folder: string, program: string, options: object): void {
  const compilerOptions = {
    ...{ target: 'es2022', lib: ['es2022', 'dom'], strict: true, noEmit: true, types: [], preserveSymlinks: true },
    ...options,
  };
  mkdirSync(folder, { recursive: true });
  for (const [name, text] of Object.entries({
    'package.json': '{ "type": "module" }',
    'tsconfig.json': JSON.stringify({ compilerOptions, files: ['program.ts'] }),
    'program.ts': program,
  }))
    writeFileSync(join(folder, name), text);
  run(process.execPath, [join(tsc, 'bin/tsc'), '-p', '.'], folder);
}
