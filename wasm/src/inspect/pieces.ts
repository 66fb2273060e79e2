import { project, type TransferOptions } from '../api/index.js';
import { CagecastError } from '../core/error.js';
import { counted, type Finding } from './finding.js';
import type { Scene } from './scene.js';
import { hasArea } from './segments.js';

/** From so many segments on, it is tried whether they almost touch. */
const kMany = 50;
/** At most this share of the segments is left if their vertices are welded. */
const kFew = 0.2;
/** The tolerances that are tried, as shares of the diagonal. */
const kTolerances = [1e-6, 1e-5, 1e-4];

/** Reports a target in many pieces that almost touch, and the tolerance that joins them. Cost: up to three projections if there are many. */
export function checkPieces({ cage, target, result }: Scene, options: TransferOptions): Finding[] {
  const pieces = result.segmentStats.filter(hasArea).length;
  if (pieces < kMany) return [];
  for (const weldTolerance of kTolerances) {
    if (weldTolerance <= (options.weldTolerance ?? 0)) continue;
    const joined = piecesAt(weldTolerance);
    if (joined === undefined) return [];
    if (joined > kFew * pieces) continue;
    return [
      {
        code: 'piecesApart',
        weight: 0.4,
        sentence: `The target is in ${counted(pieces, 'piece')} that almost touch, which are painted or not one by one; welded, ${joined === 1 ? 'one is' : `${joined} are`} left`,
        advice: `Merge its vertices by distance, or set a weld tolerance of ${weldTolerance}.`,
        numbers: { pieces, joined, weldTolerance },
      },
    ];
  }
  return [];

  function piecesAt(weldTolerance: number): number | undefined {
    try {
      return project(cage, target, { preset: 'paper', weldTolerance }).segmentStats.filter(hasArea).length;
    } catch (error) {
      // There is a limit to how many vertices may be within it.
      if (error instanceof CagecastError) return undefined;
      throw error;
    }
  }
}
