import { make } from '../platform/make';
import type { Session } from '../state/session';
import type { View } from '../state/view-state';

interface Step {
  title: string;
  text: string;
  /** Selects what it is about. */
  about: string;
  /** What is shown meanwhile. */
  view?: Partial<View>;
}

const kSteps: readonly Step[] = [
  {
    title: 'Left and right of the line',
    text: 'On the left, paint lies on eyes, teeth and tongue, as in a plain transfer. On the right, Cagecast leaves them bare. Drag the line.',
    about: '#divider .knob, #other-half', // a phone shows one half of Inspect at a time
    view: { mode: 'compare', split: 0.5 },
  },
  {
    title: 'Paint',
    text: 'Choose the brush or a sticker, and paint on the model. What must stay bare stays bare.',
    about: '#tools',
    view: { mode: 'result' },
  },
  {
    title: 'Your own model',
    text: 'Choose a GLB, VRM or other 3D file here, or drop it anywhere: it is painted at once. Nothing leaves your device.',
    about: '#target-file',
  },
];

/** A way through the page in three steps, in a box on the stage. Escape ends it. */
export class Guide {
  readonly #session: Session;
  readonly #before: View;
  readonly #box = make('div', { className: 'guide' });
  readonly #ended: () => void;

  /** Offers the way. @param ended  Called when it was walked, or is not wanted. */
  constructor(session: Session, ended: () => void) {
    this.#session = session;
    this.#before = session.view;
    this.#ended = ended;
    this.#box.dataset.testid = 'guide';
    this.#box.setAttribute('role', 'dialog');
    this.#box.setAttribute('aria-labelledby', 'guide-title');
    this.#box.addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      event.stopPropagation(); // it would also end a tool
      this.#end();
    });
    document.querySelector('main')!.before(this.#box); // so that it is reached first
    this.#fill('New here?', 'Three steps show what this page does.', [
      ['No, thanks', () => this.#end()],
      ['Show me', () => this.show(0)],
    ]);
  }

  /** Shows one step. */
  show(at: number): void {
    const { title, text, about, view } = kSteps[at]!;
    this.#session.setView({ ...this.#before, ...view });
    this.#mark(about);
    const isLast = at === kSteps.length - 1;
    this.#fill(title, text, [
      ...(isLast ? [] : [['Skip', () => this.#end()] as const]),
      [isLast ? 'Done' : 'Next', () => (isLast ? this.#end() : this.show(at + 1))],
    ]);
    this.#box.querySelector('.row')!.prepend(make('small', {}, `Step ${at + 1} of ${kSteps.length}`));
    this.#box.querySelector<HTMLElement>('button.strong')!.focus();
  }

  #fill(title: string, text: string, buttons: readonly (readonly [string, () => void])[]): void {
    const all = buttons.map(([label, act]) => {
      const className = act === buttons.at(-1)![1] ? 'strong' : 'quiet';
      const button = make('button', { type: 'button', className }, label);
      button.addEventListener('click', act);
      return button;
    });
    const heading = make('h2', { id: 'guide-title' }, title);
    this.#box.replaceChildren(heading, make('p', {}, text), make('div', { className: 'row' }, ...all));
  }

  #mark(about: string | undefined): void {
    for (const marked of document.querySelectorAll('.guided')) marked.classList.remove('guided');
    for (const found of about ? document.querySelectorAll(about) : []) {
      found.closest<HTMLElement>('[popover]')?.showPopover();
      if (found.checkVisibility()) found.classList.add('guided');
      found.scrollIntoView({ block: 'nearest' });
    }
  }

  #end(): void {
    const isWalked = this.#box.querySelector('small') !== null;
    this.#mark(undefined);
    this.#box.remove();
    if (isWalked) this.#session.setView(this.#before);
    this.#ended();
  }
}
