/** Finds an element the page cannot do without. @throws Error that names the id. */
export function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${type.name} #${id}`);
  return found;
}

const alertBox = element('alert', HTMLElement);
const alertText = element('error', HTMLElement);
const summary = element('summary', HTMLElement);

/** Tells what went wrong, until the next thing is tried or the message is dismissed. */
export function showError(message: string): void {
  alertText.textContent = message;
  alertBox.hidden = false;
}

export function clearError(): void {
  alertBox.hidden = true;
  alertText.textContent = '';
}

let announcing: ReturnType<typeof setTimeout> | undefined;

/** Says a sentence to screen readers, once nothing newer was said for half a second. */
export function announce(sentence: string): void {
  clearTimeout(announcing);
  announcing = setTimeout(() => (summary.textContent = sentence), 500);
}

/** Puts a line into a `<p>` that is out of the way while it is empty. */
export function showNotice(id: string, text: string): void {
  const notice = element(id, HTMLElement);
  notice.textContent = text;
  notice.hidden = text === '';
}

element('alert-close', HTMLButtonElement).addEventListener('click', clearError);
