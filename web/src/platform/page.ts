/** Finds an element by id. @throws Error if it is missing. */
export function element<T extends HTMLElement>(id: string, type: new () => T): T {
  const found = document.getElementById(id);
  if (!(found instanceof type)) throw new Error(`the page has no ${type.name} #${id}`);
  return found;
}

const alertBox = element('alert', HTMLElement);
const alertText = element('error', HTMLElement);
const summary = element('summary', HTMLElement);
/** The error that is shown, as it was written. */
let error = '';

/** Shows an error until the next request, or until it is dismissed. */
export function showError(message: string): void {
  alertText.textContent = error = message;
  alertBox.hidden = false;
}

/** Shows an error below those that are shown. */
export function addError(message: string): void {
  showError(`${error}\n${message}`.trim());
}

export function clearError(): void {
  alertBox.hidden = true;
  alertText.textContent = error = '';
}

let announcing: ReturnType<typeof setTimeout> | undefined;

/** Announces a sentence to screen readers; only the last of several within half a second. */
export function announce(sentence: string): void {
  clearTimeout(announcing);
  announcing = setTimeout(() => (summary.textContent = sentence), 500);
}

/** Sets the text of a notice; hides it if empty. */
export function showNotice(id: string, text: string): void {
  const notice = element(id, HTMLElement);
  notice.textContent = text;
  notice.hidden = text === '';
}

element('alert-close', HTMLButtonElement).addEventListener('click', clearError);
