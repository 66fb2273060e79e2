import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after } from 'node:test';

/** Makes a folder for the tests of a file, which is removed after them. @returns it, and what gives paths in it. */
export function temporaryFolder(name: string): { folder: string; at: (...names: string[]) => string } {
  const folder = mkdtempSync(join(tmpdir(), `cagecast-${name}-`));
  after(() => rmSync(folder, { recursive: true, force: true }));
  return { folder, at: (...names) => join(folder, ...names) };
}
