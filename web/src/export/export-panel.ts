import { download } from '../platform/download';
import { announce, element, showError, showNotice } from '../platform/page';
import type { Session } from '../scene/session';
import { type Code, codeFor } from './code';
import type { PaintInto } from './export-messages';
import { type Linked, linkOf } from './links';
import type { Baked } from './texture/bake';
import { zonesJson } from './zones';

/** Lets what is shown be taken away: as a model, as zones, as code, as a link. */
export class Take {
  readonly #session: Session;
  readonly #linked: Linked;
  readonly #png: () => Promise<Blob>;
  readonly #link = element('share-link', HTMLAnchorElement);
  readonly #code = element('code', HTMLElement);
  #due = false;

  /** @param png Makes a PNG of what the paints look like together, in the cage's UVs. */
  constructor(linked: Linked, png: () => Promise<Blob>) {
    const { session } = linked;
    this.#session = session;
    this.#linked = linked;
    this.#png = png;
    const section = element('take', HTMLElement);
    element('export-glb', HTMLButtonElement).addEventListener('click', () => this.#exportGlb());
    element('export-zones', HTMLButtonElement).addEventListener('click', () => {
      download(new Blob([zonesJson(session)], { type: 'application/json' }), `${this.#stem}-zones.json`);
    });
    this.#link.addEventListener('click', () => this.#copyLink());
    // Before it is followed, dragged or copied by other means: the model may have been turned.
    for (const event of ['pointerdown', 'focus'] as const) this.#link.addEventListener(event, () => this.#refresh());
    element('copy-code', HTMLButtonElement).addEventListener('click', () =>
      this.#copy(this.#code.textContent!, 'The code is copied.'),
    );
    for (const input of section.querySelectorAll<HTMLInputElement>('[name=code]'))
      input.addEventListener('change', () => this.#refresh());
    for (const event of ['zones', 'view', 'paint'] as const) session.on(event, () => this.refresh());
    session.on('transfer', () => this.#offerTextures());
    const buttons = section.querySelectorAll<HTMLButtonElement>('.actions button');
    for (const button of buttons) button.disabled = true;
    session.on('zones', () => buttons.forEach((button) => (button.disabled = false)));
  }

  /** Brings link and code up to date, but not for every step of what is dragged. */
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
    const kind = document.querySelector<HTMLInputElement>('#take [name=code]:checked')!.value as keyof Code;
    this.#code.textContent = codeFor(this.#session)[kind];

    showNotice(
      'pose-note',
      this.#session.moved ? 'Model and code are of the shape that the file has, zones of the one that you see.' : '',
    );
    const link = linkOf(this.#linked);
    if (link) this.#link.href = link;
    else this.#link.removeAttribute('href');
    this.#link.ariaDisabled = link ? null : 'true';
    element('take-hint', HTMLElement).textContent = !link
      ? 'A link can only lead to samples: your own files stay on this device.'
      : this.#linked.layers.left > 0
        ? 'The link leaves out paints of your own: they stay on this device.'
        : 'The link opens this sample with its paints, rules and view, seen from where you see it.';
  }

  get #stem(): string {
    return this.#session.shown!.target.name.replace(/\.\w+$/, '');
  }

  /** Lets the paint go into textures where the model has some. */
  #offerTextures(): void {
    const { parts } = this.#session.shown!.target.mesh;
    const textured = parts.some(
      ({ mesh: { material, geometry } }) =>
        [material].flat().some((one) => 'map' in one && one.map) && geometry.hasAttribute('uv'),
    );
    const texture = document.querySelector<HTMLInputElement>('#paint-into [value=texture]')!;
    texture.disabled = !textured;
    if (!textured) document.querySelector<HTMLInputElement>('#paint-into [value=overlay]')!.checked = true;
    showNotice('export-note', '');
  }

  async #exportGlb(): Promise<void> {
    const button = element('export-glb', HTMLButtonElement);
    // Not disabled: that would take the keyboard from it.
    if (button.ariaBusy) return;
    button.ariaBusy = 'true';
    showNotice('export-note', '');
    try {
      const { exportGlb } = await import('./export-glb');
      const stem = this.#stem;
      const into = document.querySelector<HTMLInputElement>('#paint-into :checked')!.value as PaintInto;
      const { glb, baked } = await exportGlb(this.#session, await this.#png(), into);
      download(glb, `${stem}-painted.glb`);
      announce(`The model is saved: ${(glb.size / 1e6).toFixed(1)} megabytes.`);
      showNotice('export-note', baked ? sayBaked(baked) : '');
    } catch (error) {
      showError(error instanceof Error ? error.message : String(error));
    } finally {
      button.ariaBusy = null;
    }
  }

  #copyLink(): void {
    this.#refresh();
    if (this.#link.hasAttribute('href')) this.#copy(this.#link.href, 'The link is copied.');
  }

  async #copy(text: string, done: string): Promise<void> {
    const note = element('take-note', HTMLElement);
    try {
      await navigator.clipboard.writeText(text);
      note.textContent = done;
    } catch {
      note.textContent = 'This browser does not let the page copy: take it from the address bar, or select it.';
    }
    setTimeout(() => (note.textContent = ''), 4000);
  }
}

const kMostNames = 3;
const kCrowded = 0.005; // less is seams that touch

/** What became of the paint, in words. */
function sayBaked({ textures, overlays, crowded }: Baked): string {
  const names =
    overlays.length > kMostNames
      ? [...overlays.slice(0, kMostNames - 1), `${overlays.length - kMostNames + 1} more`]
      : overlays;
  const list = new Intl.ListFormat('en').format(names);
  return [
    `The paint is in ${textures === 1 ? 'one texture' : `${textures || 'no'} textures`} of the model’s own.`,
    ...(overlays.length > 0 ? [`Over ${list} it is an overlay, for want of a texture that can hold it.`] : []),
    ...(crowded > kCrowded
      ? [
          `The model’s own UVs overlap, as where halves are mirrored: ${(100 * crowded).toFixed(0)} % of the paint has no place of its own, and gave way.`,
        ]
      : []),
  ].join(' ');
}
