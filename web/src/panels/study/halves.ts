import { face } from '../../platform/face';
import { element } from '../../platform/page';
import type { Session } from '../../state/session';
import type { Study } from '../../state/study/study';
import { type Half, kHalves } from '../../state/view-state';
import { lookOf } from '../../view/overlay/looks';
import type { Viewer } from '../../view/viewer';
import { kMethodNames } from './methods';

const kSides = ['left', 'right'] as const;

/** Lets each half of the view show a way to transfer; on a phone one half at a time, with a switch. */
export function setUpHalves(session: Session, study: Study, { stage }: Viewer): void {
  const menus = kSides.map((side) => {
    const menu = element(`half-${side}`, HTMLSelectElement);
    for (const half of kHalves) menu.add(new Option(kMethodNames[half], half));
    menu.addEventListener('change', () => session.setView({ [side]: menu.value as Half }));
    return menu;
  });
  const box = element('halves', HTMLElement);
  box.hidden = false;
  const phone = matchMedia('(width < 40em)');
  /** What the halves paint now. */
  const painted: unknown[] = [];
  const paint = (): void => {
    const { view } = session;
    kSides.forEach((side, at) => {
      const half = view[side];
      const decision =
        view.mode === 'compare' && lookOf(half, side) === side && half !== 'result' ? study.decided?.[half] : undefined;
      if (decision !== painted[at]) stage.setHalf(side, (painted[at] = decision) as typeof decision);
    });
  };
  const follow = (): void => {
    const { mode, split } = session.view;
    const isShown = face() === 'inspect' && mode === 'compare';
    box.style.visibility = isShown ? 'visible' : 'hidden'; // in its place, so that the model stays in its own
    kSides.forEach((side, at) => (menus[at]!.value = session.view[side]));
    if (isShown && phone.matches && split > 0 && split < 1) session.setView({ split: 0 });
    else paint();
  };
  session.on('view', follow);
  session.on('transfer', () => (painted.length = 0)); // the overlay is another one
  study.on('decided', paint);
  phone.addEventListener('change', () => (phone.matches ? follow() : session.setView({ split: 0.5 })));
  follow();
  element('other-half', HTMLButtonElement).addEventListener('click', () =>
    session.setView({ split: session.view.split > 0.5 ? 0 : 1 }),
  );
}
