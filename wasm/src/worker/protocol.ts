import type { CagecastError } from '../api/index.js';

/** A call for a worker: a function by name, and its arguments. */
export interface Request {
  id: number;
  fn: string;
  args: unknown[];
}

/** The answer to a call, or what makes its error; or, before it, how far the call is: a share 0..1, and what it does. */
export type Reply =
  | { id: number; result: unknown }
  | { id: number; error: ConstructorParameters<typeof CagecastError> }
  | { id: number; progress: [share: number, stage: string] };

/** A worker on some host, and what it is sent. */
export interface Thread<Message = Request> {
  post(message: Message, move: ArrayBuffer[]): void;
  /** Ends it at once, even during a call. */
  terminate(): void;
  /** Says whether there is work: an idle worker must not keep a process alive. */
  setBusy(busy: boolean): void;
}

/** How a thread is started; `onFailure` tells that it could not start or that it died. */
export type Spawn = (onReply: (reply: Reply) => void, onFailure: (message: string) => void) => Thread;
