import type { Page } from 'playwright-core';

/** Gives the work up as soon as the bar shows it. Within the page: a key or a click from outside waits for frames, and comes late. */
export function giveUpOnceShown(page: Page, way: 'button' | 'Escape'): Promise<void> {
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

/** A worker that is slow to begin: however quick the machine, there is time to see it work, and to give it up. Sending costs what it does. */
export const kSlowWorker = `
  const { postMessage } = Worker.prototype
  Worker.prototype.postMessage = function (message, options) {
    const sent = structuredClone(message, Array.isArray(options) ? { transfer: options } : options)
    setTimeout(() => postMessage.call(this, sent), 1000)
  }`;
