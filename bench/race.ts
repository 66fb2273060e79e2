import { readFileSync } from 'node:fs';
import type { Spread } from './native.js';
import { median, spread } from './statistics.js';
import type { Block, Who } from './web/runner.js';

/** How to race. */
export interface RaceOptions {
  /** How often the two take turns. */
  turns: number;
  /** About how long a turn is; at least one run. */
  turnMs: number;
  /** Runs of each before them, while the engine compiles and optimises. */
  warmUp: number;
  withPeer: boolean;
}

/** The package against the same pipeline on three-mesh-bvh, in one realm. */
export interface RaceResult {
  turns: number;
  /** ms of CPU time of the thread that runs scripts, per transfer. */
  cagecast: Spread;
  /** Medians in ms of wall time, over turns. */
  stages: Record<string, number>;
  peer?: { total: Spread; stages: Record<string, number>; ratio: number; otherZones: number; otherTriangles: number };
}

/** Where transfers run: in a page, or in this process. */
export interface Realm {
  /** Of the process whose main thread runs them. */
  pid: number;
  run(who: Who, runs: number): Promise<Block> | Block;
  differences():
    | Promise<{ otherZones: number; otherTriangles: number }>
    | { otherZones: number; otherTriangles: number };
}

/**
 * CPU time of a process's main thread in ms. Times of a page are measured like this too, and not by the clock on the wall:
 * what else the machine does falls on the long runs more often than on the short ones, and would flatter us.
 */
export function cpuTime(pid: number): number {
  return Number(readFileSync(`/proc/${pid}/schedstat`, 'utf8').split(' ')[0]) / 1e6;
}

/** One turn: CPU time per transfer, and the steps. */
export async function turn(realm: Realm, who: Who, runs: number): Promise<{ cpu: number; block: Block }> {
  const start = cpuTime(realm.pid);
  const block = await realm.run(who, runs);
  const cpu = (cpuTime(realm.pid) - start) / runs;
  if (!(cpu > 0)) throw new Error(`process ${realm.pid} used no CPU time: it is not the one that runs transfers`);
  return { cpu, block };
}

/** Warms up, and finds how many runs make a turn. */
export async function warmUp(realm: Realm, who: Who, runs: number, turnMs: number): Promise<number> {
  const { times } = await realm.run(who, runs);
  return Math.max(1, Math.round(turnMs / median(times.slice(runs >> 1))));
}

export async function race(realm: Realm, options: RaceOptions): Promise<RaceResult> {
  const runs = {
    cagecast: await warmUp(realm, 'cagecast', options.warmUp, options.turnMs),
    peer: options.withPeer ? await warmUp(realm, 'peer', options.warmUp, options.turnMs) : 0,
  };
  const pairs: { cagecast: number; peer: number }[] = [];
  const stages: Record<Who, Record<string, number>[]> = { cagecast: [], peer: [] };
  for (let i = 0; i < options.turns; ++i) {
    const pair = { cagecast: 0, peer: 0 };
    for (const who of ['cagecast', 'peer'] as const) {
      if (runs[who] === 0) continue;
      const { cpu, block } = await turn(realm, who, runs[who]);
      pair[who] = cpu;
      stages[who].push(block.stages);
    }
    pairs.push(pair);
  }
  const medians = (of: Record<string, number>[]): Record<string, number> =>
    Object.fromEntries(Object.keys(of[0]!).map((stage) => [stage, median(of.map((s) => s[stage]!))]));
  return {
    turns: options.turns,
    cagecast: spread(pairs.map(({ cagecast }) => cagecast)),
    stages: medians(stages.cagecast),
    ...(options.withPeer && {
      peer: {
        total: spread(pairs.map(({ peer }) => peer)),
        stages: medians(stages.peer),
        ratio: median(pairs.map(({ cagecast, peer }) => peer / cagecast)),
        ...(await realm.differences()),
      },
    }),
  };
}
