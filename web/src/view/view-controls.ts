import { face, onFace, showFace } from '../platform/face';
import { element } from '../platform/page';
import type { Session } from '../state/session';
import { kPlayModes, type Mode, showsPaint } from '../state/view-state';
import { setUpDivider } from './divider';

/** Connects the controls of the view. */
export function setUpViewControls(session: Session): void {
  const strip = element('view-mode', HTMLElement);
  const modes = [...strip.querySelectorAll('input')];
  const switches = (['paint', 'cage', 'seeThrough'] as const).map((name) => ({
    name,
    input: element(`show-${name}`, HTMLInputElement),
  }));
  const compare = element('compare', HTMLInputElement);
  const divider = setUpDivider((split) => session.setView({ split }));
  for (const input of modes) input.addEventListener('change', () => session.setView({ mode: input.value as Mode }));
  compare.addEventListener('change', () => session.setView({ mode: compare.checked ? 'compare' : 'result' }));
  for (const { name, input } of switches)
    input.addEventListener('change', () => session.setView({ [name]: input.checked }));

  const isOfPlay = (): boolean => kPlayModes.includes(session.view.mode);
  onFace((shown) => {
    if (shown === 'play')
      session.setView({
        mode: isOfPlay() ? session.view.mode : 'result',
        paint: true,
        cage: false,
        left: 'naive',
        right: 'result',
      });
  });
  session.on('view', (view) => {
    // Such as by a link: it is shown with the controls that belong to it.
    if (face() === 'play' && !(isOfPlay() && view.paint)) showFace('inspect');
    for (const input of modes) {
      input.checked = input.value === view.mode;
      // On a phone the strip has to be scrolled.
      if (input.checked)
        strip.scrollTo({
          left: input.offsetParent instanceof HTMLElement ? input.offsetParent.offsetLeft - strip.clientWidth / 3 : 0,
        });
    }
    compare.checked = view.mode === 'compare';
    for (const { name, input } of switches) input.checked = view[name];
    switches[0]!.input.disabled = !showsPaint(view.mode);
    switches[2]!.input.parentElement!.hidden = view.mode !== 'zones';
    divider.show(view.mode === 'compare', view.split);
  });
  // Browsers keep the state of fields on reload.
  const mode = modes.find(({ checked }) => checked)!.value as Mode;
  session.setView({ mode, ...Object.fromEntries(switches.map(({ name, input }) => [name, input.checked])) });
}
