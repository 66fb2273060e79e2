import { make } from '../platform/make';
import { element } from '../platform/page';

const kNear = 60; // pixels: a section that starts this close below the bar counts as current

/** Fills the navigation bar with the panel's visible sections, and marks the current one. */
export function setUpSectionNav(): void {
  const bar = element('section-nav', HTMLElement);
  const sections = [...document.querySelectorAll<HTMLElement>('.panel > [data-nav]:not([hidden])')];
  const links = new Map(sections.map((section) => [section, linkTo(section)]));
  bar.replaceChildren(...links.values());

  let current: HTMLElement | undefined;
  const follow = (): void => {
    bar.classList.toggle('more', bar.scrollLeft + bar.clientWidth < bar.scrollWidth - 1);
    const edge = bar.getBoundingClientRect().bottom + kNear;
    const now = sections.findLast((section) => section.getBoundingClientRect().top <= edge) ?? sections[0];
    if (now === current) return;
    current = now;
    for (const [section, link] of links) link.ariaCurrent = section === current ? 'true' : null;
    const link = links.get(current!)!;
    bar.scrollTo({ left: link.offsetLeft - bar.clientWidth / 2 + link.clientWidth / 2 });
  };
  // On a phone the page scrolls, on a desktop the panel.
  addEventListener('scroll', follow, { capture: true, passive: true });
  addEventListener('resize', follow);
  follow();
}

/** Scrolls to a section of the panel, and moves the focus there. */
export function goTo(section: HTMLElement): void {
  if (section instanceof HTMLDetailsElement) section.open = true;
  const reduced = matchMedia('(prefers-reduced-motion: reduce)').matches;
  section.scrollIntoView({ behavior: reduced ? 'instant' : 'smooth', block: 'start' });
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
