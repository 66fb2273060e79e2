import { ask } from '../platform/ask';
import type { Requested } from '../state/scene';
import type { Session } from '../state/session';

const kPatience = 10_000; // milliseconds

/**
 * Says of what was asked for just now that it does not come, or has failed to, and offers to try again: it may come meanwhile.
 * @param isWanted Whether it still is.
 * @returns Ends that.
 */
export function watchOver(
  title: string,
  loading: Promise<unknown>,
  again: () => void,
  isWanted = (): boolean => true,
): () => void {
  let close = (): void => {};
  const say = (text: string): void => {
    if (isWanted()) close = ask({ text, answers: [{ title: 'Try again', run: again }] });
  };
  const slow = setTimeout(() => say(`${title}: still waiting for the server.`), kPatience);
  const end = (): void => {
    clearTimeout(slow);
    close();
  };
  loading.then(end, () => {
    clearTimeout(slow);
    say(`${title}: not loaded.`);
  });
  return end;
}

/** The same of a sample, until it is shown, or something else is requested. */
export function watchOverSample(session: Session, title: string, requested: Requested, again: () => void): void {
  const isWanted = (): boolean => session.requested.target === requested.target;
  const end = watchOver(title, Promise.all(Object.values(requested)), again, isWanted);
  const off = session.on('progress', ({ state }) => {
    // What has failed can be tried until something else is begun.
    if (state === 'failed' || (state === 'working' && isWanted())) return;
    off();
    end();
  });
}
