import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import { setFlagsFromString } from 'node:v8';
import * as simd from 'cagecast';
import * as simdBorders from 'cagecast/borders';

const built = 'build/release/tests/core/cagecast_reference';

/**
 * The brute-force reference and the native library behind one command, built if it is not of this code; CAGECAST_REFERENCE names
 * another. tests/core/reference_main.cpp tells what it does.
 */
export function nativeCommand(): string {
  const given = process.env['CAGECAST_REFERENCE'];
  const native = given ?? built;
  if (given === undefined) {
    // A reference of yesterday's library would prove nothing.
    if (!existsSync('build/release/build.ninja'))
      execFileSync('cmake', ['--preset', 'release'], { stdio: ['ignore', 'ignore', 'inherit'] });
    execFileSync('cmake', ['--build', '--preset', 'release', '--target', 'cagecast_reference'], {
      stdio: ['ignore', 'ignore', 'inherit'],
    });
  }
  assert.ok(existsSync(native), `${native} is missing`);
  return native;
}

/** Lets Node do what newer ones do by themselves: multiply and add in one go. */
function allowFusing(): void {
  if (Number.parseFloat(process.versions.v8) < 11.4) setFlagsFromString('--experimental-wasm-relaxed-simd');
}

/**
 * The package with its WebAssembly as it is shipped, where the host does not fuse multiply-adds and where it does, and built without
 * SIMD; ready. The latter is built if it is not of this code; CAGECAST_SCALAR names the folder of another.
 */
export async function packages(): Promise<Record<'SIMD' | 'fused' | 'scalar', typeof simd & typeof simdBorders>> {
  const given = process.env['CAGECAST_SCALAR'];
  if (given === undefined)
    execFileSync(process.execPath, ['wasm/tools/build.mjs', '--preset', 'wasm-scalar'], { stdio: 'inherit' });
  const load = (name: string) => import(pathToFileURL(resolve(given ?? 'build/wasm-scalar/package', name)).href);
  const scalar = {
    ...((await load('index.js')) as typeof simd),
    ...((await load('borders.js')) as typeof simdBorders),
  };
  const { validate } = WebAssembly;
  WebAssembly.validate = () => false;
  await Promise.all([simd.init(), scalar.init()]);
  WebAssembly.validate = validate;
  allowFusing();
  const fused: typeof simd & typeof simdBorders = {
    ...(await import('cagecast/slim')),
    ...(await import('cagecast/slim/borders')),
  };
  const { compile } = WebAssembly;
  const shipped = ['cagecast', 'cagecast-borders'].map((name) => readFileSync(`dist/${name}.wasm`));
  const fusedSizes: number[] = [];
  WebAssembly.compile = (bytes) => {
    if (!shipped.some((file) => file.equals(bytes as Uint8Array))) fusedSizes.push(bytes.byteLength);
    return compile(bytes);
  };
  await fused.init();
  const mesh = {
    positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0),
    indices: Uint32Array.of(0, 1, 2),
    uvs: Float32Array.of(0, 0, 1, 0, 0, 1),
  };
  await fused.cutBorders(mesh, mesh, fused.transfer(mesh, mesh)); // compiles the module that cuts
  WebAssembly.compile = compile;
  assert.deepEqual(
    fusedSizes,
    shipped.map(({ length }) => length),
    'this Node fuses multiply-adds',
  );
  return { SIMD: { ...simd, ...simdBorders }, fused, scalar };
}
