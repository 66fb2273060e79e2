import { setTimeout } from 'node:timers/promises';
import type { Kind } from '../../../examples/catalogue/kinds/kind.ts';

/** A kind of job for tests, which takes any settings. */
const kind = (run: Kind['run']): Kind => ({ version: 1, inputs: { target: 'required' }, ending: '.txt', run });

export default {
  /** Answers after a while, with as many bytes as its input. */
  slow: kind(async ({ target }, { ms }) => {
    await setTimeout(Number(ms));
    return { facts: { bytes: target!.length }, output: Buffer.alloc(target!.length, 'x') };
  }),
  /** Fails with a text, or tells it as a fact. */
  tell: kind(async (_, { text, isFact }) => {
    if (!isFact) throw new Error(String(text));
    return { facts: { verdict: String(text), [String(text)]: text } };
  }),
  hang: {
    ...kind(async () => {
      for (;;);
    }),
    seconds: 2,
  },
  hog: kind(async () => {
    const held: Buffer[] = [];
    for (;;) {
      held.push(Buffer.alloc(2e7, 1));
      await setTimeout(10);
    }
  }),
  die: kind(async () => process.abort()),
  /** Ends the worker itself, as a machine that is switched off does. */
  kill: kind(async () => {
    process.kill(process.ppid, 'SIGKILL');
    return setTimeout(60_000) as never;
  }),
} satisfies Record<string, Kind>;
