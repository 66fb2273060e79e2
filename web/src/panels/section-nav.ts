import { element } from '../platform/page';

const kNear = 60; // pixels below the bar that a section may begin and still be the one in view

/** Fills the bar that leads to the panel's sections, and marks the one in view. Sections that are hidden are left out. */
export function setUpJump(): void {
  const bar = element('jump', HTMLElement);
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
  // On a phone the page scrolls, on a desk the panel does.
  addEventListener('scroll', follow, { capture: true, passive: true });
  addEventListener('resize', follow);
  follow();
}

function linkTo(section: HTMLElement): HTMLAnchorElement {
  const link = document.createElement('a');
  link.href = `#${section.id}`;
  link.textContent = section.dataset.nav!;
  link.addEventListener('click', (event) => {
    // The address says what is shown, not how far the panel is scrolled.
    event.preventDefault();
    if (section instanceof HTMLDetailsElement) section.open = true;
    const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
    section.scrollIntoView({ behavior: calm ? 'instant' : 'smooth', block: 'start' });
    section.tabIndex = -1;
    section.focus({ preventScroll: true });
  });
  return link;
}
