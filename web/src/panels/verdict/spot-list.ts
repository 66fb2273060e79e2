import { make } from '../../platform/make';
import type { Session } from '../../state/session';
import { type Spot, spotsOf, whereAre } from '../../state/verdict/spots';
import { marksOf } from '../../view/segments';
import type { Viewer } from '../../view/viewer';

const kGap = 6; // pixels below the verdict

const box = make('div', {
  className: 'spots',
  id: 'spots',
  popover: 'auto',
  role: 'dialog',
  ariaLabel: 'What to look at',
});
box.dataset.testid = 'spots';

/**
 * Opens the list of spots: below the verdict, on a phone at the lower edge. Each line lights its place on the model.
 * @param verdict The button that opens it.
 */
export function showSpots(
  verdict: HTMLElement,
  looked: Parameters<typeof spotsOf>[0],
  viewer: Viewer | undefined,
): void {
  const { session } = looked;
  const spots = spotsOf(looked);
  const items = spots.map((spot) => itemOf(spot, session, viewer));
  const nothing = make('p', {}, 'All of the model is painted.');
  box.replaceChildren(items.length > 0 ? make('ul', {}, ...items) : nothing);
  if (!box.isConnected) document.body.append(box);
  const { bottom, right } = verdict.parentElement!.getBoundingClientRect();
  box.style.setProperty('--top', `${bottom + kGap}px`);
  box.style.setProperty('--right', `${innerWidth - right}px`);
  // Its lines are of this model.
  const end = session.on('leave', () => box.hidePopover());
  box.ontoggle = ({ newState }) => {
    if (newState !== 'closed') return;
    end();
    viewer?.stage.highlight('parts', undefined);
  };
  box.showPopover();
  box.querySelector('button')?.focus({ preventScroll: true });
}

function itemOf({ text, segments, isOfFace, remedy }: Spot, session: Session, viewer: Viewer | undefined): HTMLElement {
  const line = make('button', { type: 'button' }, text);
  const { shown } = session;
  const light = (): void => viewer?.stage.highlight('parts', shown && marksOf(shown, segments));
  const show = (): void => {
    light();
    if (!viewer || !shown) return;
    if (isOfFace) return void viewer.showFace();
    const { object, front } = viewer.stage;
    const where = whereAre(shown, segments);
    const box = where?.box.map((point) => object.localToWorld(point));
    if (box) viewer.controls.lookAt(box, where!.front ?? front);
  };
  line.addEventListener('click', show);
  for (const begin of ['pointerenter', 'focus']) line.addEventListener(begin, light);
  const item = make('li', {}, line);
  if (remedy) {
    const help = make('button', { type: 'button', className: 'quiet' }, remedy.title);
    help.addEventListener('click', () => {
      box.hidePopover();
      remedy.run();
    });
    item.append(help);
  }
  return item;
}
