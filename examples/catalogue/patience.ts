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

/** Whether Redis does not answer at the moment. */
export const isInTrouble = (): boolean => told !== '';

/** Asks Redis, again and again until it answers. @throws what is no trouble that passes. */
export async function patiently<T>(ask: () => Promise<T>): Promise<T> {
  for (let hasWaited = false; ; hasWaited = true) {
    try {
      const answer = await ask();
      if (hasWaited) tellTrouble('');
      return answer;
    } catch (error) {
      const trouble = redisTrouble(error);
      if (trouble === undefined) throw error;
      tellTrouble(trouble);
      await setTimeout(pauseMs * (1 + Math.random()));
    }
  }
}
