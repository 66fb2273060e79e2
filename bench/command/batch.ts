// Measures `cagecast batch` with the samples: how much of the cores it uses, and how much more it does than one process for each job.
//
//   npx tsx bench/command/batch.ts [jobs]     default: 200; the machine must be idle otherwise

import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { availableParallelism, tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const assets = fileURLToPath(new URL('../../examples/samples', import.meta.url));
const command = fileURLToPath(new URL('../../dist/cli.js', import.meta.url));
const jobs = Number(process.argv[2] ?? 200);
const folder = mkdtempSync(join(tmpdir(), 'cagecast-batch-'));

/** Seconds of processor time of all processes that have ended. */
function childSeconds(): number {
  const times = execFileSync('sh', ['-c', `cat /proc/${process.pid}/stat`], { encoding: 'utf8' })
    .split(') ')[1]!
    .split(' ');
  return (Number(times[13]) + Number(times[14])) / 100; // cutime, cstime in ticks
}

/** Runs the command. @return Seconds on the clock, and of processor time. */
function run(...args: string[]): { wall: number; cpu: number } {
  const [began, before] = [performance.now(), childSeconds()];
  execFileSync(process.execPath, [command, ...args], { stdio: 'ignore' });
  return { wall: (performance.now() - began) / 1000, cpu: childSeconds() - before };
}

try {
  mkdirSync(join(folder, 'in'));
  for (let i = 0; i < jobs; i++) copyFileSync(join(assets, 'lizard/target.glb'), join(folder, 'in', `${i}.glb`));
  const rules = ['--cage', join(assets, 'lizard/cage.glb'), '--texture', join(assets, 'lizard/paint-tiger.png')];
  const cores = availableParallelism();
  const { wall, cpu } = run('batch', join(folder, 'in/*.glb'), ...rules, '-o', join(folder, 'out/{name}.glb'));
  const single = Array.from({ length: 7 }, (_, i) =>
    run('transfer', join(folder, 'in', `${i}.glb`), ...rules, '-o', join(folder, `one-${i}.glb`)),
  ).sort((a, b) => a.wall - b.wall)[3]!;
  console.log(`batch: ${jobs} jobs in ${wall.toFixed(2)} s, ${(jobs / wall).toFixed(0)} jobs/s`);
  console.log(`cores in use: ${((100 * cpu) / (wall * cores)).toFixed(0)} % of ${cores}`);
  console.log(`one process for each job, one after the other: ${(1 / single.wall).toFixed(1)} jobs/s (median of 7)`);
  console.log(`ratio: ${((jobs / wall) * single.wall).toFixed(1)}`);
} finally {
  rmSync(folder, { recursive: true, force: true });
}
