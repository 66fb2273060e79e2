import { type Face, onFace, showFace } from '../platform/face';
import { make } from '../platform/make';
import { element } from '../platform/page';
import type { Session } from '../state/session';

const kNear = 60; // pixels: a section that starts this close below the bar counts as current

/**
 * Fills the navigation bar with the panel's visible sections, and marks the current one. On a phone it opens the sheet in Play.
 * @param onSheet Called when that opens or closes.
 */
export function setUpSectionNav(session: Session, onSheet: (open: boolean) => void): void {
  let wasOpen = false;
  const tell = (): void => {
    const open = isSheet() && isSheetOpen();
    if (open !== wasOpen) onSheet((wasOpen = open));
  };
  new MutationObserver(tell).observe(document.documentElement, { attributeFilter: ['data-sheet', 'data-face'] });
  addEventListener('resize', tell);
  const bar = element('section-nav', HTMLElement);
  sheet.addEventListener('click', () => openSheet(!isSheetOpen()));
  // The options of a tool are there once it is chosen; on a phone the stage has most of them.
  const options = element('tool-options', HTMLElement);
  const lacking = element('sticker-text', HTMLElement).closest<HTMLElement>('[data-for]')!;
  new MutationObserver(() => {
    if (!options.hidden && !(isSheet() && lacking.hidden)) reveal(element('paint', HTMLElement));
  }).observe(options, { attributeFilter: ['hidden'] });
  // The keyboard gets to what is in it.
  element('controls', HTMLElement).addEventListener('focusin', ({ target }) => {
    if (!(target as Element).closest('.section-bar')) openSheet(true);
  });
  const sections = [...document.querySelectorAll<HTMLElement>('.panel > [data-nav]')];
  const links = new Map(sections.map((section) => [section, linkTo(section)]));
  bar.replaceChildren(...links.values());

  let current: HTMLElement | undefined;
  const follow = (): void => {
    bar.classList.toggle('more', bar.scrollLeft + bar.clientWidth < bar.scrollWidth - 1);
    const edge = bar.getBoundingClientRect().bottom + kNear;
    const seen = sections.filter((section) => section.checkVisibility());
    const now = seen.findLast((section) => section.getBoundingClientRect().top <= edge) ?? seen[0];
    if (now === current) return;
    current = now;
    for (const [section, link] of links) link.ariaCurrent = section === current ? 'true' : null;
    const link = links.get(current!)!;
    bar.scrollTo({ left: link.offsetLeft - bar.clientWidth / 2 + link.clientWidth / 2 });
  };
  // On a phone the page scrolls, on a desktop the panel.
  addEventListener('scroll', follow, { capture: true, passive: true });
  // What a model, or the face, does not show has no link.
  const offer = (): void => {
    for (const [section, link] of links) link.hidden = !section.checkVisibility() || section.matches(':popover-open');
    follow();
  };
  addEventListener('resize', offer);
  onFace(offer);
  session.on('zones', offer);
}

const sheet = element('sheet', HTMLButtonElement);

/** Whether the panel is a sheet at the lower edge: on a phone, in Play. */
const isSheet = (): boolean => sheet.checkVisibility();

const isSheetOpen = (): boolean => document.documentElement.dataset.sheet === 'open';

/** Opens or closes the sheet. */
function openSheet(open: boolean): void {
  document.documentElement.dataset.sheet = open ? 'open' : 'closed';
  sheet.ariaExpanded = String(open);
  sheet.ariaLabel = open ? 'Close the panel' : 'Open the panel';
}

/** Shows a section of the panel without moving the focus. */
export function reveal(section: HTMLElement): void {
  openSheet(true);
  const reduced = matchMedia('(prefers-reduced-motion: reduce)').matches;
  section.scrollIntoView({ behavior: reduced ? 'instant' : 'smooth', block: 'start' });
}

/** Scrolls to a section of the panel, on the face that has it, and moves the focus there. */
export function goTo(section: HTMLElement): void {
  if (section.dataset.in) showFace(section.dataset.in as Face);
  if (section instanceof HTMLDetailsElement) section.open = true;
  reveal(section);
  section.tabIndex = -1;
  section.focus({ preventScroll: true });
}

function linkTo(section: HTMLElement): HTMLAnchorElement {
  const link = make('a', { href: `#${section.id}` }, section.dataset.nav!);
  link.addEventListener('click', (event) => {
    // The URL fragment is used for links to a view.
    event.preventDefault();
    goTo(section);
  });
  return link;
}
