// The page that measures: what its first use of the package costs, and races of the package and a peer. It imports nothing at its
// start but what reads the input.
import type { Preset } from 'cagecast';
import { readScene, type Scene } from '../scene-file.js';

/** Milliseconds of a page's first use of the package. */
export interface FirstUse {
  /** Fetching (from this machine), parsing and running the script. */
  import: number;
  /** Compiling and instantiating the module. */
  init: number;
  transfer: number;
  total: number;
}

/** How to race. */
export interface RaceOptions {
  /** How often the two take turns. */
  turns: number;
  /** About how long a turn is, in ms; at least one run. */
  turnMs: number;
  /** Runs before them, while the engine compiles and optimises. */
  warmUp: number;
  withPeer: boolean;
}

/** Milliseconds of each turn's fastest run: whatever else the machine does in a turn, it leaves one run alone. */
export interface RaceResult {
  cagecast: number[];
  peer: number[];
  /** At how many vertices the peer says another zone. */
  otherZones: number;
}

const load = async (url: string): Promise<Scene> => readScene(await (await fetch(url)).arrayBuffer());
const cagecast = (): Promise<typeof import('cagecast')> => import('cagecast');

async function firstUse(url: string, preset: Preset): Promise<FirstUse> {
  const { cage, target } = await load(url);
  const start = performance.now();
  const { init, transfer } = await cagecast();
  const imported = performance.now();
  await init();
  const started = performance.now();
  transfer(cage, target, { preset });
  const done = performance.now();
  return { import: imported - start, init: started - imported, transfer: done - started, total: done - start };
}

/** Times a call over and over; the fastest run. */
function turn(work: () => void, runs: number): number {
  let fastest = Infinity;
  for (let i = 0; i < runs; ++i) {
    const began = performance.now();
    work();
    fastest = Math.min(fastest, performance.now() - began);
  }
  return fastest;
}

/** Races the preset `paper`. As on a page whose model moves, a result is written into the arrays of the one before. */
async function race(url: string, { turns, turnMs, warmUp, withPeer }: RaceOptions): Promise<RaceResult> {
  const scene = await load(url);
  const { init, transfer, Zone } = await cagecast();
  const { searchByBvh, weld } = await import('./bvh-peer.js');
  await init();
  const ours = () => (reuse = transfer(scene.cage, scene.target, { preset: 'paper', reuse }));
  let reuse: ReturnType<typeof transfer> | undefined;
  const points = weld(scene.target);
  const theirs = (): Uint8Array => searchByBvh(scene, points);
  const runs = [ours, ...(withPeer ? [theirs] : [])].map((work) => ({
    work,
    count: Math.max(1, Math.round(turnMs / turn(work, warmUp))),
  }));
  const times: number[][] = [[], []];
  for (let i = 0; i < turns; ++i) runs.forEach(({ work, count }, who) => void times[who]!.push(turn(work, count)));
  let otherZones = 0;
  if (withPeer) {
    const zones = theirs();
    // What is culled, which needs segments, the peer does not decide.
    ours().zones.forEach((zone, v) => {
      if (zones[points.ofVertex[v]!] !== (zone === Zone.Culled ? Zone.Cosmetic : zone)) ++otherZones;
    });
  }
  return { cagecast: times[0]!, peer: times[1]!, otherZones };
}

Object.assign(window, { firstUse, race });
