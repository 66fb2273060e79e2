import { dismiss } from '../platform/ask';
import { clearError, element, showError, showNotice } from '../platform/page';
import type { Model } from '../state/model';
import { kReading, type Progress, type Session } from '../state/session';

const kBlind =
  'WebGL 2 is not available in this browser, so there is no 3D view. The transfer works all the same; see the numbers in the panel.';

/** The text of the status badge; tests read its attribute. */
type Status = 'loading' | 'working' | 'ready' | 'error';

/** Shows progress and errors. @param blind Whether there is no view, for lack of WebGL. */
export function showStatus(session: Session, blind: boolean): void {
  const status = element('status', HTMLElement);
  const show = (to: Status): void => {
    status.textContent = to;
    status.dataset.state = to;
  };
  if (blind) {
    element('stage', HTMLElement).classList.add('blind');
    element('view', HTMLCanvasElement).hidden = true;
    showNotice('stage-notice', kBlind);
  }
  const bar = new ProgressBar(session);
  let said: Model | undefined;
  session.on('transfer', ({ target }) => {
    if (target.damage && target !== said) showError(target.damage);
    said = target;
  });
  session.on('progress', (progress) => {
    bar.show(progress);
    // Words about the shown model are not about the awaited one.
    const isFirst = session.isLeaving && !document.documentElement.hasAttribute('data-leaving');
    document.documentElement.toggleAttribute('data-leaving', session.isLeaving);
    if (isFirst && session.shown) dismiss();
    switch (progress.state) {
      case 'working':
        // Keep messages about the files while later stages run.
        if (progress.stage === kReading || status.dataset.state === 'error') clearError();
        return show('working');
      case 'ready':
        showNotice('stage-notice', blind ? kBlind : '');
        return show('ready');
      case 'waiting':
        showNotice(
          'stage-notice',
          `Now add a ${progress.missing.map((slot) => (slot === 'target' ? 'model' : slot)).join(' and a ')}.`,
        );
        return show('loading');
      case 'failed':
        showError(progress.error.message);
        if (!session.shown) showNotice('stage-notice', 'Nothing to show yet. Drop a model here.');
        return show('error');
    }
  });
}

const kPatience = 300; // milliseconds before the bar appears

/** The progress bar, and cancelling with its button or the Escape key. */
class ProgressBar {
  readonly #box = element('progress', HTMLElement);
  readonly #bar = element('progress-bar', HTMLProgressElement);
  #due: ReturnType<typeof setTimeout> | undefined;

  constructor(session: Session) {
    element('cancel', HTMLButtonElement).addEventListener('click', () => session.cancel());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape' && !this.#box.hidden) session.cancel();
    });
  }

  show(progress: Progress): void {
    if (progress.state !== 'working') {
      clearTimeout(this.#due);
      this.#due = undefined;
      this.#box.hidden = true;
      return;
    }
    this.#due ??= setTimeout(() => (this.#box.hidden = false), kPatience);
    this.#bar.value = progress.share;
    element('progress-stage', HTMLElement).textContent = `${progress.stage}…`;
  }
}
