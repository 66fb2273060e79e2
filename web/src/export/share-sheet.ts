import type { Texture } from 'three';
import type { LayerStack } from '#three';
import { handOver } from '../platform/download';
import { face } from '../platform/face';
import { requireGraphics } from '../platform/graphics';
import { element, showError } from '../platform/page';
import type { Session } from '../state/session';
import type { LightName } from '../state/view-state';
import type { Viewer } from '../view/viewer';
import { type Card, drawCards } from './card';

const kPreview = 0.5; // of the size of a card
const kPicture = 2;
const kTurnSeconds = 12; // of a whole turn of the turntable
const kRest = 150; // milliseconds without a change until the preview follows

/** Connects what the sheet for sharing has of pictures: the preview, picture, film, light, background, the view in the room. */
export class ShareSheet {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #paint: Texture;
  readonly #sheet = element('share', HTMLElement);
  readonly #canvas = element('card', HTMLCanvasElement);
  readonly #name = element('card-name', HTMLInputElement);
  readonly #isClear = element('clear-picture', HTMLInputElement);
  #timer: ReturnType<typeof setTimeout> | undefined;
  #isFilming = false;
  #isDrawing = false;

  constructor(session: Session, viewer: Viewer, { stack, paint }: { stack: LayerStack; paint: Texture }) {
    this.#paint = paint;
    this.#session = session;
    this.#viewer = viewer;
    session.on('transfer', ({ target: { name, sample } }) => {
      this.#name.value = (sample?.title ?? name).replace(/\.\w+$/, '').replaceAll('_', ' ');
    });
    for (const event of ['zones', 'view'] as const) session.on(event, () => this.#refresh());
    stack.on('change', () => this.#refresh());
    // A card moves the camera, too, and back.
    viewer.controls.onMove(() => this.#isDrawing || this.#refresh());
    for (const input of [this.#name, this.#isClear]) input.addEventListener('input', () => this.#refresh());
    this.#sheet.addEventListener('toggle', () => this.#show());
    this.#setUpLight();
    const picture = element('save-picture', HTMLButtonElement);
    picture.addEventListener('click', () => this.#try('The picture could not be saved', () => this.#savePicture()));
    this.#setUpFilm();
    this.#setUpRoom();
    for (const id of ['save-picture', 'share-preview', 'picture']) element(id, HTMLElement).hidden = false;
    this.#show();
  }

  /** The preview follows, once nothing changes for a moment. */
  #refresh(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#show(), kRest);
  }

  #show(): void {
    if (!this.#isFilming && this.#canvas.checkVisibility() && this.#session.shown) this.#draw(this.#canvas, kPreview);
  }

  /** Nobody shares a comparison that was not looked for. */
  get #card(): Card {
    const { view } = this.#session;
    const { background } = view;
    const shown = view.mode === 'compare' && face() === 'play' ? ({ ...view, mode: 'result' } as const) : view;
    return { name: this.#name.value, background, isClear: this.#isClear.checked, view: shown };
  }

  #draw(canvas: HTMLCanvasElement, ratio: number): void {
    this.#isDrawing = true;
    drawCards(this.#viewer, canvas, this.#card, ratio)();
    this.#isDrawing = false;
  }

  /** What goes wrong is said on the stage. */
  async #try(what: string, act: () => Promise<void>): Promise<void> {
    try {
      requireGraphics(this.#viewer.renderer);
      await act();
    } catch (error) {
      if (this.#sheet.matches(':popover-open')) this.#sheet.hidePopover();
      showError(`${what}: ${(error as Error).message}`);
    }
  }

  get #stem(): string {
    return this.#session.shown!.target.name.replace(/\.\w+$/, '');
  }

  async #savePicture(): Promise<void> {
    const canvas = document.createElement('canvas');
    this.#draw(canvas, kPicture);
    const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done));
    if (!blob) throw new Error('the browser cannot encode the picture');
    await handOver(blob, `${this.#stem}.png`);
  }

  /** Offers to record a film, where the browser can. */
  #setUpFilm(): void {
    const button = element('save-film', HTMLButtonElement);
    const note = button.querySelector('small')!;
    button.hidden = !('MediaRecorder' in globalThis);
    button.addEventListener('click', async () => {
      if (button.ariaBusy || !this.#session.shown) return;
      button.ariaBusy = 'true';
      this.#isFilming = true;
      const picture = element('save-picture', HTMLButtonElement);
      picture.disabled = true; // It would draw over the film.
      await this.#try('The film could not be recorded', async () => {
        const { record } = await import('./film');
        const of = { canvas: this.#canvas, card: { ...this.#card, isClear: false }, paint: this.#paint };
        const film = await record(this.#viewer, of, (left) => (note.textContent = `${left} s left`));
        await handOver(film, `${this.#stem}.${film.type.startsWith('video/mp4') ? 'mp4' : 'webm'}`);
      });
      this.#isFilming = false;
      picture.disabled = false;
      this.#viewer.studio.setBackground(this.#session.view.background);
      this.#turn();
      this.#refresh();
      button.ariaBusy = null;
      note.textContent = 'five seconds';
    });
  }

  #turn(): void {
    const isOn = element('turntable', HTMLInputElement).checked;
    this.#viewer.controls.turntable(isOn ? kTurnSeconds : undefined);
  }

  #setUpLight(): void {
    const session = this.#session;
    const light = element('light', HTMLSelectElement);
    const own = element('own-background', HTMLInputElement);
    const color = element('background', HTMLInputElement);
    const setBackground = (): void => session.setView({ background: own.checked ? color.value : '' });
    light.addEventListener('change', () => session.setView({ light: light.value as LightName }));
    own.addEventListener('change', setBackground);
    color.addEventListener('input', () => {
      own.checked = true;
      setBackground();
    });
    element('turntable', HTMLInputElement).addEventListener('change', () => this.#turn());
    session.on('view', (view) => {
      light.value = view.light;
      own.checked = view.background !== '';
      if (view.background) color.value = view.background;
    });
  }

  /** Offers to show the model in the room, where the device can. */
  #setUpRoom(): void {
    const button = element('show-room', HTMLButtonElement);
    navigator.xr?.isSessionSupported('immersive-ar').then(
      (can) => (button.hidden = !can),
      () => {}, // it may be forbidden
    );
    button.addEventListener('click', async () => {
      if (!this.#session.shown) return;
      try {
        const { showInRoom } = await import('./room');
        await showInRoom(this.#viewer);
      } catch (error) {
        const { name, message } = error as Error;
        const why = name === 'NotAllowedError' ? 'the browser was not allowed to use the camera' : message;
        showError(`The model cannot be shown in your room: ${why.replace(/\.$/, '')}.`);
      }
    });
  }
}
