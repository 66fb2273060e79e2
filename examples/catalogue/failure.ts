/** Why a job failed, in the words of the dead-letter list and the metrics. */
export const reasons = {
  broken: 'an input or a setting cannot be used',
  unfit: 'the cage does not fit',
  limit: 'more bytes, memory or time than allowed',
  missing: 'an input is not there, or is another than when it was submitted',
  refused: 'a path outside the input folder, or a server that is not allowed',
  network: 'a server, the network or a disk did not answer as it should; may pass',
  crash: 'the process that did the job died; tried again until it has died three times',
  unexpected: 'an error of the program: please report it',
} as const;

export type Reason = keyof typeof reasons;

/** How a job fails. Its message begins with the reason. */
export class Failure extends Error {
  readonly reason: Reason;
  /** What was found out nevertheless. */
  readonly facts: object | undefined;

  constructor(reason: Reason, text: string, facts?: object) {
    super(`${reason}: ${text.split('\n', 1)[0]!.slice(0, 500)}`);
    this.reason = reason;
    this.facts = facts;
  }

  /** Whether it can help to try again. */
  get mayPass(): boolean {
    return this.reason === 'network' || this.reason === 'crash';
  }
}

/** Any error as a failure. */
export const asFailure = (error: unknown): Failure =>
  error instanceof Failure ? error : new Failure('unexpected', error instanceof Error ? error.message : String(error));

/** The reason that a message begins with, as BullMQ keeps it. */
export function reasonOf(message: string | undefined): Reason {
  const [word = ''] = (message ?? '').split(':', 1);
  if (word in reasons) return word as Reason;
  // What BullMQ itself says of a job that stalled too often.
  return /stalled/.test(message ?? '') ? 'crash' : 'unexpected';
}
