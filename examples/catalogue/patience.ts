// Redis may be away, full or busy for a while. No job may fail, and no program end, because of that.
import { setTimeout } from 'node:timers/promises';
import { redisTrouble } from './failure.ts';

const pauseMs = 250;
let told = '';

/** Says what keeps Redis from answering, once; '' when it answers again. */
export function tellTrouble(trouble: string): void {
  if (trouble === told) return;
  told = trouble;
  console.error(`${new Date().toISOString()} ${trouble ? `${trouble}. Waiting …` : 'Redis answers again'}`);
}

/**
 * Asks Redis, again and again until it answers.
 * @param isEnding  Whether nobody waits for the answer any more.
 * @throws what is no trouble that passes.
 */
export async function patiently<T>(ask: () => Promise<T>, isEnding = () => false): Promise<T> {
  for (let hasWaited = false; ; hasWaited = true) {
    try {
      const answer = await ask();
      if (hasWaited) tellTrouble('');
      return answer;
    } catch (error) {
      const trouble = redisTrouble(error);
      if (trouble === undefined || isEnding()) throw error;
      tellTrouble(trouble);
      await setTimeout(pauseMs * (1 + Math.random()));
    }
  }
}
