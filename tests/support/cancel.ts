import type { Page } from 'playwright-core';

/** Cancels as soon as the progress bar appears. Runs in the page: input from outside waits for frames and would be late. */
export function cancelOnceShown(page: Page, way: 'button' | 'Escape'): Promise<void> {
  return page.evaluate(
    (chosen) =>
      new Promise<void>((done) => {
        const bar = document.querySelector<HTMLElement>('[data-testid=progress]')!;
        const watch = new MutationObserver(() => {
          if (bar.hidden) return;
          watch.disconnect();
          if (chosen === 'button') document.querySelector<HTMLElement>('[data-testid=cancel]')!.click();
          else document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
          done();
        });
        watch.observe(bar, { attributes: true });
      }),
    way,
  );
}

/** A script that delays messages to workers by a second, so that tests can see progress and cancel. */
export const kSlowWorker = `
  const { postMessage } = Worker.prototype
  Worker.prototype.postMessage = function (message, options) {
    const sent = structuredClone(message, Array.isArray(options) ? { transfer: options } : options)
    setTimeout(() => postMessage.call(this, sent), 1000)
  }`;
