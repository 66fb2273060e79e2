import type { Thread } from '../../worker/protocol.js';
import { threadOf, threadOfNode } from '../../worker/thread-of.js';
import type { Answer, Question } from './protocol.js';

/** Starts a worker for one file. @param megabytes  Of its heap at most, where the host can limit that. */
export function spawn(
  onAnswer: (answer: Answer) => void,
  onFailure: (message: string) => void,
  megabytes: number,
): Thread<Question> {
  const url = import.meta.url.replace(/[^/]*$/, 'formats-thread.js');
  if (typeof Worker !== 'function')
    return threadOfNode(url, onAnswer, onFailure, {
      execArgv: [],
      resourceLimits: { maxOldGenerationSizeMb: megabytes },
    });
  // Bundlers find the worker's script only in this form.
  const start = () => new Worker(new URL('./formats-thread.js', import.meta.url), { type: 'module' });
  return threadOf(start, url, onAnswer, onFailure);
}
