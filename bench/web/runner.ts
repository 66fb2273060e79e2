import { init, type TransferResult, transfer } from 'cagecast';
import type { Scene } from '../scene-file.js';
import { median } from '../statistics.js';
import { type PeerResult, transferByBvh } from './bvh-peer.js';
import { Kept } from './kept.js';

/** The package, or the same pipeline on three-mesh-bvh. */
export type Who = 'cagecast' | 'peer';

/** Several transfers, one after the other. */
export interface Block {
  runs: number;
  /** Wall time of each, in ms. */
  times: number[];
  /** Their median, step by step. All of them, on their way out of a page, would take a fortieth of the package's own time. */
  stages: Record<string, number>;
}

/**
 * Runs transfers of one scene in this realm, page or process: the method of the poster, which is what the peer does. As on a page
 * whose model moves, answers are thrown away: both write them into the arrays of the one before.
 */
export class Runner {
  private result: TransferResult | undefined;
  private readonly kept = new Kept();

  private constructor(private readonly scene: Scene) {}

  static async start(scene: Scene): Promise<Runner> {
    await init();
    return new Runner(scene);
  }

  run(who: Who, runs: number): Block {
    const times: number[] = [];
    const stages: Record<string, number[]> = {};
    for (let i = 0; i < runs; ++i) {
      const start = performance.now();
      const { timings } = this.transferBy(who);
      times.push(performance.now() - start);
      for (const [stage, time] of Object.entries(timings)) (stages[stage] ??= []).push(time);
    }
    return {
      runs,
      times,
      stages: Object.fromEntries(Object.entries(stages).map(([stage, all]) => [stage, median(all)])),
    };
  }

  /** At how many vertices the two answers differ. */
  differences(): { otherZones: number; otherTriangles: number } {
    const [ours, theirs] = [this.transferBy('cagecast'), this.transferBy('peer')];
    const count = (a: ArrayLike<number>, b: ArrayLike<number>): number =>
      Array.from(a).filter((value, v) => value !== b[v]).length;
    return { otherZones: count(ours.zones, theirs.zones), otherTriangles: count(ours.triangles, theirs.triangles) };
  }

  private transferBy(who: Who): TransferResult | PeerResult {
    if (who === 'peer') return transferByBvh(this.scene, this.kept);
    return (this.result = transfer(this.scene.cage, this.scene.target, { preset: 'paper', reuse: this.result }));
  }
}
