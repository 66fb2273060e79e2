import type { Session } from '../session';
import { damaged, listOf, numberOf } from './checks';
import type { Contribution } from './project';

const kMaxRuns = 1_000_000;
/** Of all models together: marks take a byte each. */
export const kMaxMarks = 2 ** 26;

/** What the user marked to stay bare. */
export function barePart(session: Session): Contribution {
  return {
    name: 'bare',
    isWork: true,
    save: () => session.bare && runsOf(session.bare),
    read(saved) {
      const marks = marksOf(saved);
      return { shown: () => session.keepBare(session.shown!.target, marks) };
    },
  };
}

const kRuns = new WeakMap<Uint8Array, number[]>();

/** Marks as lengths of runs: of triangles without, then with marks, and so on. */
export function runsOf(marks: Uint8Array): number[] {
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

/** The marks that saved runs stand for. @param most  How many there may be. @throws Error that says how many there are. */
export function marksOf(saved: unknown, most = kMaxMarks): Uint8Array {
  const runs = listOf(saved, kMaxRuns, 'marks').map((run) => Math.floor(numberOf(run, 0, kMaxMarks, 0)));
  const count = runs.reduce((sum, run) => sum + run, 0);
  if (count > most) damaged(`it has too many marks, ${kMaxMarks - most + count}: more than ${kMaxMarks}`);
  const marks = new Uint8Array(count);
  let from = 0;
  runs.forEach((run, at) => {
    marks.fill(at % 2, from, from + run);
    from += run;
  });
  return marks;
}
