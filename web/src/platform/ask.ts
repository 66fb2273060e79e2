import { make } from './make';
import { element } from './page';

/** A message on the stage, and what can be done about it. */
export interface Question {
  text: string;
  answers: readonly { title: string; run(): void }[];
  /** Whether people must answer first: it takes the focus, and Escape dismisses it. Otherwise it is a status message. */
  isDialog?: boolean;
  /** Milliseconds until it goes by itself; stays by default. */
  lasts?: number;
}

/** How long a message stays that says what to do next: milliseconds. */
export const kAskedFor = 15_000;

const box = element('ask', HTMLElement);
let timer: ReturnType<typeof setTimeout> | undefined;
let shown: Question | undefined;
/** A message that came while another was to be read first. */
let waiting: Question | undefined;
/** What had the focus before the box took it. */
let before: Element | null = null;

/**
 * Shows a message on the stage in place of the last one; after it, if people must answer that first. One that goes by itself gives way to
 * one that stays, and comes after it.
 * @returns Takes it away, unless another one has taken its place.
 */
export function ask(question: Question): () => void {
  const isUrgent = shown?.isDialog ? question.isDialog : !question.lasts || !shown || shown.lasts;
  if (!isUrgent) waiting = question;
  else {
    if (shown?.lasts && !question.lasts) waiting = shown;
    show(question);
  }
  return () => {
    if (waiting === question) waiting = undefined;
    if (shown === question) close();
  };
}

function show(question: Question): void {
  if (!box.contains(document.activeElement)) before = document.activeElement;
  hide();
  const { text, answers, isDialog = false, lasts } = question;
  shown = question;
  box.role = isDialog ? 'dialog' : 'status';
  const buttons = answers.map(({ title, run }) => button('quiet', title, run));
  const dismiss = button('icon', '✕', () => {});
  dismiss.ariaLabel = 'Dismiss the message';
  box.replaceChildren(make('p', { id: 'ask-text' }, text), ...buttons, dismiss);
  box.hidden = false;
  if (isDialog) buttons[0]?.focus();
  const leave = (): void => {
    // Who is about to use it gets the time.
    if (box.matches(':hover, :focus-within')) timer = setTimeout(leave, lasts);
    else close();
  };
  if (lasts) timer = setTimeout(leave, lasts);
}

function button(className: string, title: string, run: () => void): HTMLButtonElement {
  const made = make('button', { type: 'button', className }, title);
  made.addEventListener('click', () => {
    close();
    run();
  });
  return made;
}

/** Takes a message away that nobody has to answer: it was about what gives way to something else. */
export function dismiss(): void {
  waiting = undefined;
  if (shown && !shown.isDialog) close();
}

function close(): void {
  hide();
  const next = waiting;
  waiting = undefined;
  if (next) show(next);
}

function hide(): void {
  clearTimeout(timer);
  shown = undefined;
  const hadFocus = box.contains(document.activeElement);
  box.hidden = true;
  if (hadFocus && before instanceof HTMLElement) before.focus({ preventScroll: true });
}

box.addEventListener('keydown', (event) => {
  if (event.key !== 'Escape') return;
  event.stopPropagation(); // it would also end a tool
  close();
});
