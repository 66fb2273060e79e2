import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';
import * as simd from 'cagecast';

const built = 'build/release/tests/core/cagecast_reference';

/**
 * The brute-force reference and the native library behind one command, built if it is not of this code; CAGECAST_REFERENCE names
 * another. tests/core/reference/main.cpp tells what it does.
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

/**
 * The package with its WebAssembly as it is shipped, inlined and beside it, and built without SIMD; ready. The latter is built if it
 * is not of this code; CAGECAST_SCALAR names the folder of another.
 */
export async function packages(): Promise<Record<'SIMD' | 'slim' | 'scalar', typeof simd>> {
  const given = process.env['CAGECAST_SCALAR'];
  if (given === undefined)
    execFileSync(process.execPath, ['wasm/tools/build.mjs', '--preset', 'wasm-scalar'], { stdio: 'inherit' });
  const folder = given ?? 'build/wasm-scalar/package';
  const scalar = (await import(pathToFileURL(resolve(folder, 'index.js')).href)) as typeof simd;
  const slim = await import('cagecast/slim');
  await Promise.all([simd.init(), slim.init(), scalar.init()]);
  return { SIMD: simd, slim, scalar };
}
