import { execFileSync } from 'node:child_process';

/** What a script prints in a process of its own, started with flags if there are any. */
export const printed = (script: string, ...flags: string[]): string =>
  execFileSync(process.execPath, [...flags, '--input-type=module', '-e', script], {
    encoding: 'utf8',
    timeout: 60_000,
  }).trim();
