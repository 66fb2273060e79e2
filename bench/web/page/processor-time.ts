import type { Page } from 'playwright-core';

/** What the page's main thread did. Milliseconds of its own processor time: a busy machine does not count against it. */
export interface Work {
  /** Of the longest task; between tasks the page takes input and draws. */
  longest: number;
  total: number;
}

/**
 * Measures the tasks of the page's main thread while something is done.
 * @param until Something that the browser notes as it loads a page, by its name in traces: what comes after it does not count.
 */
export async function mainThreadWork(page: Page, action: () => Promise<unknown>, until?: string): Promise<Work> {
  const browser = page.context().browser()!;
  await browser.startTracing(page, { categories: ['toplevel', 'loading'] });
  let trace: { traceEvents: TraceEvent[] };
  try {
    await action();
  } finally {
    trace = JSON.parse((await browser.stopTracing()).toString());
  }
  const threads = trace.traceEvents.filter(
    ({ name, args }) => name === 'thread_name' && args?.name === 'CrRendererMain',
  );
  const isMain = ({ pid, tid }: TraceEvent): boolean =>
    threads.some((thread) => thread.pid === pid && thread.tid === tid);
  const end = until === undefined ? Infinity : trace.traceEvents.find(({ name }) => name === until)?.ts;
  if (end === undefined) throw new Error(`the trace has no ${until}`);
  // The page's own process is the busiest of its kind.
  const byProcess = new Map<number, number[]>();
  for (const event of trace.traceEvents) {
    if (event.name !== 'ThreadControllerImpl::RunTask' || event.tdur === undefined || event.ts > end || !isMain(event))
      continue;
    byProcess.set(event.pid, [...(byProcess.get(event.pid) ?? []), event.tdur / 1000]);
  }
  const work = [...byProcess.values()].map((tasks) => ({
    longest: Math.max(...tasks),
    total: tasks.reduce((sum, task) => sum + task, 0),
  }));
  const busiest = work.sort((a, b) => b.total - a.total)[0];
  if (!busiest) throw new Error('the trace has no tasks of a main thread');
  return busiest;
}

/** Milliseconds of processor time that `compute` takes where tests' limits in milliseconds were set. */
export const kComputation = 300;

/**
 * Computes what always takes the page's thread the same: others on the same processor stretch even processor time, and what is
 * measured can be held against this.
 * @param tasks So many, of equal length.
 */
export function compute(page: Page, tasks = 1): Promise<unknown> {
  return page.evaluate(async (tasks) => {
    let [a, b, c, d] = [1, 2, 3, 4];
    for (let task = 0; task < tasks; task++) {
      for (let i = 0; i < 50_000_000 / tasks; i++) {
        a = (Math.imul(a, 1_664_525) + 1_013_904_223) | 0;
        b = (Math.imul(b, 22_695_477) + 12_345) | 0;
        c = ((c ^ (c << 7)) + i) | 0;
        d = ((d ^ (d >>> 3)) + i) | 0;
      }
      await new Promise((done) => setTimeout(done));
    }
    return a ^ b ^ c ^ d;
  }, tasks);
}

interface TraceEvent {
  name: string;
  pid: number;
  tid: number;
  /** When it began, in microseconds. */
  ts: number;
  /** Processor time, in microseconds. */
  tdur?: number;
  args?: { name?: string };
}

const kRuns = 3;
const kTasks = 10;

/**
 * Processor time of the longest task of an action, in ms: the minimum of three runs, relative to a fixed computation in tasks of
 * 30 ms.
 * @param undo Called before the action is repeated.
 */
export async function longestTask(
  page: Page,
  action: () => Promise<unknown>,
  undo: () => Promise<unknown> = async () => {},
): Promise<number> {
  const runs: number[] = [];
  while (runs.length < kRuns) {
    if (runs.length > 0) await undo();
    const { longest } = await mainThreadWork(page, action);
    const same = await mainThreadWork(page, () => compute(page, kTasks));
    runs.push(longest / Math.max(1, same.longest / (kComputation / kTasks)));
  }
  return Math.min(...runs);
}
