import assert from 'node:assert/strict';
import { type ExecFileSyncOptions, execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';

/**
 * A program of the core's tests, built if it is not of this code: `cagecast_reference` writes scenes, `cagecast_read_gltf` reads files.
 * CAGECAST_REFERENCE names another `cagecast_reference`, beside which the others are.
 */
export function nativeCommand(program = 'cagecast_reference'): string {
  const given = process.env['CAGECAST_REFERENCE'];
  const native = join(dirname(given ?? 'build/release/tests/core/cagecast_reference'), program);
  if (given === undefined) {
    // Scenes of yesterday would prove nothing.
    const options: ExecFileSyncOptions = { stdio: ['ignore', 'ignore', 'inherit'] };
    if (!existsSync('build/release/build.ninja')) execFileSync('cmake', ['--preset', 'release'], options);
    execFileSync('cmake', ['--build', '--preset', 'release', '--target', program], options);
  }
  assert.ok(existsSync(native), `${native} is missing`);
  return native;
}
