import { download, handOver, isTouched } from '../platform/download';
import { announce, element, showError, showNotice } from '../platform/page';
import type { Session } from '../state/session';
import { type Code, codeFor } from './code';
import { endingOf } from './ending';
import type { Baked, PaintInto } from './export-messages';
import { type Link, type Linked, linkOf } from './links';
import { zonesJson } from './zones';

/** The panel “Share”: the model, the zones, code and a link. */
export class ExportPanel {
  readonly #session: Session;
  readonly #linked: Linked;
  readonly #png: () => Promise<Blob>;
  readonly #link = element('share-link', HTMLAnchorElement);
  readonly #code = element('code', HTMLElement);
  #due = false;
  #requests = 0;

  /** @param png Encodes the composite of the layers, in the cage's UVs. */
  constructor(linked: Linked, png: () => Promise<Blob>) {
    const { session } = linked;
    this.#session = session;
    this.#linked = linked;
    this.#png = png;
    const section = element('share', HTMLElement);
    element('export-glb', HTMLButtonElement).addEventListener('click', () => this.#exportGlb());
    element('export-zones', HTMLButtonElement).addEventListener('click', () => {
      download(new Blob([zonesJson(session)], { type: 'application/json' }), `${this.#stem}-zones.json`);
    });
    this.#link.addEventListener('click', (event) => {
      if (event.ctrlKey || event.metaKey || event.shiftKey) return; // it is opened elsewhere
      event.preventDefault();
      void this.#copyLink();
    });
    this.#link.addEventListener('keydown', (event) => {
      if (event.key !== ' ') return;
      event.preventDefault(); // of scrolling: links do not take it for a click, as buttons do
      void this.#copyLink();
    });
    // Update the link before it is used: the camera may have moved.
    for (const event of ['pointerdown', 'focus'] as const) this.#link.addEventListener(event, () => this.#refresh());
    element('copy-code', HTMLButtonElement).addEventListener('click', () =>
      this.#copy(this.#code.textContent!, 'Code copied.'),
    );
    for (const input of section.querySelectorAll<HTMLInputElement>('[name=code]'))
      input.addEventListener('change', () => this.#refresh());
    section.addEventListener('toggle', () => this.#refresh());
    for (const event of ['zones', 'view', 'paint'] as const) session.on(event, () => this.refresh());
    session.on('transfer', () => this.#offerTextures());
    session.on('leave', () => (element('copy-note', HTMLElement).textContent = ''));
    const buttons = section.querySelectorAll<HTMLButtonElement>('.actions button');
    for (const button of buttons) button.disabled = true;
    session.on('zones', () => buttons.forEach((button) => (button.disabled = false)));
  }

  /** Updates link and code; throttled. */
  refresh(): void {
    if (this.#due) return;
    this.#due = true;
    setTimeout(() => {
      this.#due = false;
      this.#refresh();
    }, 100);
  }

  #refresh(): void {
    if (!this.#session.shown) return;
    const kind = document.querySelector<HTMLInputElement>('#share [name=code]:checked')!.value as keyof Code;
    this.#code.textContent = codeFor(this.#session)[kind];

    showNotice(
      'pose-note',
      this.#session.moved
        ? 'The model and the code use the undeformed shape of the file, the zones the deformed one that you see.'
        : '',
    );
    if (this.#link.checkVisibility()) void this.#refreshLink();
  }

  /** Writes the link: strokes are packed for it. @returns Its fragment, if there is a link. */
  async #refreshLink(): Promise<string | undefined> {
    const request = ++this.#requests;
    let [link, hint]: [Link | undefined, string] = [undefined, 'The link could not be made.'];
    try {
      link = await linkOf(this.#linked);
      hint = hintOf(link);
    } catch {
      // Such as without a network, before the templates are there.
    }
    if (request !== this.#requests) return link?.hash;
    if (link) this.#link.href = link.hash;
    else this.#link.removeAttribute('href');
    this.#link.ariaDisabled = link ? null : 'true';
    this.#link.querySelector('small')!.textContent = kindOf(link);
    element('link-hint', HTMLElement).textContent = hint;
    return link?.hash;
  }

  get #stem(): string {
    return this.#session.shown!.target.name.replace(/\.\w+$/, '');
  }

  /** Enables baking into textures if the model has some. */
  #offerTextures(): void {
    const { primitives } = this.#session.shown!.target.mesh;
    const textured = primitives.some(
      ({ mesh: { material, geometry } }) =>
        [material].flat().some((one) => 'map' in one && one.map) && geometry.hasAttribute('uv'),
    );
    const texture = document.querySelector<HTMLInputElement>('#paint-into [value=texture]')!;
    texture.disabled = !textured;
    element('no-texture', HTMLElement).hidden = textured;
    if (!textured) document.querySelector<HTMLInputElement>('#paint-into [value=overlay]')!.checked = true;
    showNotice('export-note', '');
  }

  async #exportGlb(): Promise<void> {
    const button = element('export-glb', HTMLButtonElement);
    // Not disabled, so that it keeps the focus.
    if (button.ariaBusy) return;
    const session = this.#session;
    if (session.isReplacing)
      return showNotice('export-note', 'Another model or cage is on its way. Save once it is there.');
    button.ariaBusy = 'true';
    showNotice('export-note', '');
    const abort = new AbortController();
    const { signal } = abort;
    const done = session.work('Saving the model', 0.1, { abort: () => abort.abort() });
    try {
      const { exportGlb } = await import('./export-glb');
      const stem = this.#stem;
      const { shown, rules, choices } = session;
      const into = document.querySelector<HTMLInputElement>('#paint-into :checked')!.value as PaintInto;
      const { glb, baked } = await exportGlb({ ...shown!, rules, choices }, await this.#png(), into, signal);
      signal.throwIfAborted();
      await handOver(glb, `${stem}-painted.${endingOf(shown!.target.name)}`);
      announce(`Model saved: ${(glb.size / 1e6).toFixed(1)} megabytes.`);
      showNotice('export-note', baked ? bakedNote(baked) : '');
    } catch (error) {
      if (signal.aborted) showNotice('export-note', 'The model was not saved.');
      else showError(error instanceof Error ? error.message : String(error));
    } finally {
      done();
      button.ariaBusy = null;
    }
  }

  async #copyLink(): Promise<void> {
    const hash = await this.#refreshLink();
    if (!hash) return;
    const url = new URL(hash, document.baseURI).href;
    // Where it cannot be shared, or that was refused, it is copied.
    const shared = isTouched() && navigator.share ? navigator.share({ url, title: document.title }) : Promise.reject();
    shared.catch((error?: Error) => {
      if (error?.name !== 'AbortError') void this.#copy(url, 'Link copied.');
    });
  }

  async #copy(text: string, done: string): Promise<void> {
    const note = element('copy-note', HTMLElement);
    try {
      await navigator.clipboard.writeText(text);
      note.textContent = done;
    } catch {
      note.textContent =
        'This browser does not allow copying. Copy the link from its context menu, or select the code.';
    }
    setTimeout(() => (note.textContent = ''), 4000);
  }
}

/** What a link is to. */
const kindOf = (link: Link | undefined): string =>
  link && link.omitted.length > 0 ? 'without your layers' : link?.isLook ? 'to the look' : 'to this view';

function hintOf(link: Link | undefined): string {
  if (!link) return 'This look fits this model alone, so no link can carry it. Save the model, or a project.';
  if (link.omitted.length > 0)
    return `The link leaves out ${listOf(link.omitted)}: a link has no images of your own, and few strokes. The model and a project file have them.`;
  return link.isLook
    ? 'The link has the look, not your model: it is shown on a sample, and whoever opens it can wear it. Your file stays on this device.'
    : 'The link opens this sample with its paints, your strokes and stickers, the view and the camera.';
}

const kMaxNames = 3;
const kOverlapping = 0.005; // less is due to touching seams

/** Names in a sentence; of many, the first few. */
function listOf(names: readonly string[]): string {
  const most = kMaxNames - 1;
  const few = names.length > kMaxNames ? [...names.slice(0, most), `${names.length - most} more`] : names;
  return new Intl.ListFormat('en').format(few);
}

/** A summary of the baking, for people. */
function bakedNote({ textures, overlays, overlapping }: Baked): string {
  const list = listOf(overlays);
  return [
    `The paint is in ${textures === 1 ? 'one' : textures || 'none'} of the model’s own textures.`,
    ...(overlays.length > 0 ? [`On ${list} it is an overlay, because there is no suitable texture.`] : []),
    ...(overlapping > kOverlapping
      ? [
          `The model’s own UVs overlap, for example in mirrored halves, so ${(100 * overlapping).toFixed(0)} % of the paint was left out.`,
        ]
      : []),
  ].join(' ');
}
