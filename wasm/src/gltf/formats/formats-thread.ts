// What runs in a worker: it reads one file, and is ended.

import { nodeModule } from '../../core/node.js';
import { firstLine } from '../../scene/input-error.js';
import { listen } from '../../worker/thread-of.js';
import type { Answer, Question } from './protocol.js';
import { countArrays } from './reading/count-arrays.js';

/** Characters of a message at most: some hold a line of the file. */
const kMaxText = 300;

/** The file that holds the processor time of this thread, on Linux. */
function threadTimes(): string | undefined {
  if (globalThis.process?.platform !== 'linux') return undefined;
  try {
    return `/proc/${nodeModule('node:fs')!.readlinkSync('/proc/thread-self')}/schedstat`;
  } catch {
    return undefined;
  }
}

const waiting = new Map<number, (found: Uint8Array | undefined) => void>();

listen<Question, Answer>(async (question, post) => {
  if ('ask' in question) {
    waiting.get(question.ask)!(question.found);
    return;
  }
  const { bytes, format, limits } = question;
  for (const name of ['log', 'warn', 'error'] as const) console[name] = () => {}; // of what loaders leave out
  // No name in a file leads from an object to its prototype.
  Reflect.deleteProperty(Object.prototype, '__proto__');
  const read = (name: string) =>
    new Promise<Uint8Array | undefined>((resolve) => {
      const ask = waiting.size;
      waiting.set(ask, resolve);
      post({ ask, name });
    });
  const check = countArrays(limits);
  try {
    // Loaded only now, so that the loaders know no other constructors of arrays.
    const { readModel } = await import('./reading/read-model.js');
    post({ begun: true, times: threadTimes() });
    const onMissing = (name: string, reason: string) => post({ missing: [name, reason] });
    const glb = await readModel(format, bytes, { read, onMissing, limits });
    check();
    post({ glb }, glb ? [glb.buffer] : []);
  } catch (error) {
    let wrong = firstLine(error);
    try {
      check(); // what it exceeded says more than what followed from it
    } catch (exceeded) {
      wrong = firstLine(exceeded);
    }
    post({ wrong: wrong.slice(0, kMaxText) });
  }
});
