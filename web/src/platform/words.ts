import { Dictionary } from './dictionary';

/** Where texts are, besides the text itself. */
const kAttributes = ['aria-label', 'aria-valuetext', 'aria-roledescription', 'title', 'placeholder', 'alt'];
const kSkipped = '[translate=no], script, style';

/** A text of the page: as the page wrote it, and as it is shown. */
interface Said {
  source: string;
  shown: string;
}

/** By node and, for texts of attributes, their names. */
const said = new WeakMap<Node, Map<string, Said>>();
let dictionary: Dictionary | undefined;
const observer = new MutationObserver(follow);

/** Shows all texts of the page by a dictionary, now and whenever they change; without one, as they were written. */
export function showWords(entries: Readonly<Record<string, string>> | undefined): void {
  dictionary = entries && new Dictionary(entries);
  observer.disconnect();
  renewAll(document.documentElement);
  if (!dictionary) return;
  observer.observe(document.documentElement, {
    ...{ subtree: true, childList: true, characterData: true },
    attributeFilter: kAttributes,
  });
}

function follow(records: readonly MutationRecord[]): void {
  for (const { type, target, attributeName, addedNodes } of records)
    if (type === 'attributes') renewAttribute(target as Element, attributeName!);
    else if (type === 'characterData') renewText(target as Text);
    else for (const node of addedNodes) renewAll(node);
  // What was written just now is no news.
  observer.takeRecords();
}

function renewAll(root: Node): void {
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  for (let node: Node | null = root; node; node = walker.nextNode())
    if (node instanceof Text) renewText(node);
    else if (node instanceof Element) for (const name of kAttributes) renewAttribute(node, name);
}

function renewText(text: Text): void {
  const shown = renewed(text, '', text.data);
  if (shown !== text.data && !text.parentElement?.closest(kSkipped)) text.data = shown;
}

function renewAttribute(element: Element, name: string): void {
  const value = element.getAttribute(name);
  if (value === null || value === '') return;
  const shown = renewed(element, name, value);
  if (shown !== value && !element.closest(kSkipped)) element.setAttribute(name, shown);
}

/** How a text is to be shown. @param now  How it is. */
function renewed(node: Node, name: string, now: string): string {
  const texts = said.get(node);
  const known = texts?.get(name);
  const source = known?.shown === now ? known.source : now;
  const shown = dictionary?.translate(source) ?? source;
  if (shown !== source) said.set(node, (texts ?? new Map<string, Said>()).set(name, { source, shown }));
  else texts?.delete(name);
  return shown;
}
