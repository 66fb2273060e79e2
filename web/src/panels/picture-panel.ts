import { handOver } from '../platform/download';
import { requireGraphics } from '../platform/graphics';
import { element, showError } from '../platform/page';
import type { Session } from '../state/session';
import type { LightName } from '../state/view-state';
import type { Viewer } from '../view/viewer';

const kPicturePixels = 2; // of a saved picture, per pixel of the page
const kTurnSeconds = 12; // of a whole turn of the turntable

/** Connects what makes a picture of the model: light, background, turntable, saving, the view in the room. */
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
  const turn = (): void => viewer.controls.turntable(turntable.checked ? kTurnSeconds : undefined);
  turntable.addEventListener('change', turn);
  session.on('view', (view) => {
    light.value = view.light;
    own.checked = view.background !== '';
    if (view.background) color.value = view.background;
  });
  const picture = element('save-picture', HTMLButtonElement);
  picture.addEventListener('click', async () => {
    try {
      await handOver(await screenshot(viewer), 'cagecast.png');
    } catch (error) {
      showError(`The picture could not be saved: ${(error as Error).message}`);
    }
  });
  offerFilm(session, viewer, turn);
  offerRoom(session, viewer);
  picture.hidden = element('picture', HTMLElement).hidden = false;
}

/** What is seen, without controls, as a PNG. @throws Error if the browser cannot draw or encode it. */
async function screenshot(viewer: Viewer): Promise<Blob> {
  const { renderer } = viewer;
  requireGraphics(renderer);
  const ratio = renderer.getPixelRatio();
  renderer.setPixelRatio(Math.max(ratio, kPicturePixels));
  viewer.draw();
  const blob = await new Promise<Blob | null>((done) => renderer.domElement.toBlob(done));
  renderer.setPixelRatio(ratio);
  viewer.draw();
  if (!blob) throw new Error('the browser cannot encode the picture');
  return blob;
}

/** Offers to record a film, where the browser can. @param ended Called after it. */
function offerFilm(session: Session, viewer: Viewer, ended: () => void): void {
  const button = element('save-film', HTMLButtonElement);
  const note = button.querySelector('small')!;
  button.hidden = !('MediaRecorder' in globalThis);
  button.addEventListener('click', async () => {
    if (button.ariaBusy || !session.shown) return;
    button.ariaBusy = 'true';
    try {
      const { record } = await import('../export/film');
      const film = await record(viewer, session.view.background, (left) => (note.textContent = `${left} s left`));
      await handOver(film, `cagecast.${film.type.startsWith('video/mp4') ? 'mp4' : 'webm'}`);
    } catch (error) {
      showError(`The film could not be recorded: ${(error as Error).message}`);
    }
    ended();
    button.ariaBusy = null;
    note.textContent = 'five seconds';
  });
}

/** Offers to show the model in the room, where the device can. */
function offerRoom(session: Session, viewer: Viewer): void {
  const button = element('show-room', HTMLButtonElement);
  navigator.xr?.isSessionSupported('immersive-ar').then(
    (can) => (button.hidden = !can),
    () => {}, // it may be forbidden
  );
  button.addEventListener('click', async () => {
    if (!session.shown) return;
    try {
      const { showInRoom } = await import('./room');
      await showInRoom(viewer);
    } catch (error) {
      const { name, message } = error as Error;
      const why = name === 'NotAllowedError' ? 'the browser was not allowed to use the camera' : message;
      showError(`The model cannot be shown in your room: ${why.replace(/\.$/, '')}.`);
    }
  });
}
