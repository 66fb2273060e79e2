import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import * as simd from 'cagecast';

const built = 'build/release/tests/core/cagecast_reference';

/**
 * The command that writes the scenes of the core's tests (tests/core/reference/main.cpp), built if it is not of this code;
 * CAGECAST_REFERENCE names another.
 */
export function nativeCommand(): string {
  const given = process.env['CAGECAST_REFERENCE'];
  const native = given ?? built;
  if (given === undefined) {
    // Scenes of yesterday would prove nothing.
    if (!existsSync('build/release/build.ninja'))
      execFileSync('cmake', ['--preset', 'release'], { stdio: ['ignore', 'ignore', 'inherit'] });
    execFileSync('cmake', ['--build', '--preset', 'release', '--target', 'cagecast_reference'], {
      stdio: ['ignore', 'ignore', 'inherit'],
    });
  }
  assert.ok(existsSync(native), `${native} is missing`);
  return native;
}

/** The package with its WebAssembly as it is shipped, inlined and beside it; ready. */
export async function packages(): Promise<Record<'inline' | 'slim', typeof simd>> {
  const slim = await import('cagecast/slim');
  await Promise.all([simd.init(), slim.init()]);
  return { inline: simd, slim };
}
