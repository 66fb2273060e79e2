import { init, transfer } from 'cagecast';
import type { Scene } from '../scene-file.js';
import { transferByBvh, type PeerTimings } from './bvh-peer.js';

/** One run of each, one right after the other; ms of wall time. */
export interface Pair {
  /** What a caller waits for: checking, copying in and out, and the work itself. */
  cagecast: number;
  stages: Record<string, number>;
  peer?: PeerTimings;
}

export interface Race {
  pairs: Pair[];
  /** Vertices at which the two answers differ; only where the peer ran. */
  otherZones?: number;
  otherTriangles?: number;
}

/** How to race. */
export interface RaceOptions {
  runs: number;
  /** Rounds before them that are not counted, while the engine compiles and optimises. */
  warmUp: number;
  withPeer: boolean;
}

/** Runs the package and the peer in turn, in this realm. */
export async function race(scene: Scene, { runs, warmUp, withPeer }: RaceOptions): Promise<Race> {
  await init();
  const pairs: Pair[] = [];
  let otherZones = 0;
  let otherTriangles = 0;
  for (let i = -warmUp; i < runs; ++i) {
    const start = performance.now();
    const ours = transfer(scene.cage, scene.target);
    const cagecast = performance.now() - start;
    const peer = withPeer ? transferByBvh(scene) : undefined;
    if (i >= 0) pairs.push({ cagecast, stages: { ...ours.timings }, ...(peer && { peer: peer.timings }) });
    if (i !== runs - 1 || peer === undefined) continue;
    for (let v = 0; v < ours.zones.length; ++v) {
      otherZones += Number(ours.zones[v] !== peer.zones[v]);
      otherTriangles += Number(ours.triangles[v] !== peer.triangles[v]);
    }
  }
  return { pairs, ...(withPeer && { otherZones, otherTriangles }) };
}
