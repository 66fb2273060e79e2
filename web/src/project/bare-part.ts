import type { Session } from '../scene/session';
import { listOf, numberOf } from './checks';
import type { Contribution } from './project';

const kMostRuns = 1_000_000;

/** What the user marked to stay bare. */
export function barePart(session: Session): Contribution {
  return {
    name: 'bare',
    isWork: true,
    save: () => session.bare && runsOf(session.bare),
    read(saved) {
      const runs = listOf(saved, kMostRuns, 'marks');
      return { shown: () => session.setBare(marksOf(runs, session.shown!.target.mesh.indices.length / 3)) };
    },
  };
}

const kRuns = new WeakMap<Uint8Array, number[]>();

/** Marks as lengths of runs: of triangles without, then with marks, and so on. */
function runsOf(marks: Uint8Array): number[] {
  let runs = kRuns.get(marks);
  if (runs) return runs;
  kRuns.set(marks, (runs = []));
  for (let from = 0, mark = 0; from < marks.length; mark = 1 - mark) {
    const end = marks.indexOf(1 - mark, from);
    const to = end < 0 ? marks.length : end;
    runs.push(to - from);
    from = to;
  }
  return runs;
}

/** The marks that runs tell of. @param count Of triangles. */
function marksOf(runs: readonly unknown[], count: number): Uint8Array {
  const marks = new Uint8Array(count);
  let from = 0;
  runs.forEach((run, at) => {
    const to = from + numberOf(run, 0, count - from, 0);
    marks.fill(at % 2, from, to);
    from = to;
  });
  return marks;
}
