import { download } from '../platform/download';
import { element, showError } from '../platform/page';
import type { Session } from '../scene/session';
import type { LightName } from '../view/light';
import type { Viewer } from '../view/viewer';

/** Connects what makes a picture of the model: light, background, turntable, saving. */
export function setUpPicture(session: Session, viewer: Viewer): void {
  const light = element('light', HTMLSelectElement);
  const own = element('own-background', HTMLInputElement);
  const color = element('background', HTMLInputElement);
  const turntable = element('turntable', HTMLInputElement);
  const setBackground = (): void => session.setView({ background: own.checked ? color.value : '' });
  light.addEventListener('change', () => session.setView({ light: light.value as LightName }));
  own.addEventListener('change', setBackground);
  color.addEventListener('input', () => {
    own.checked = true;
    setBackground();
  });
  turntable.addEventListener('change', () => (viewer.turntable = turntable.checked));
  session.on('view', (view) => {
    light.value = view.light;
    own.checked = view.background !== '';
    if (view.background) color.value = view.background;
  });
  element('save-picture', HTMLButtonElement).addEventListener('click', async () => {
    try {
      download(await viewer.picture(), 'cagecast.png');
    } catch (error) {
      showError(`The picture could not be saved: ${(error as Error).message}`);
    }
  });
  element('picture', HTMLElement).hidden = false;
}
