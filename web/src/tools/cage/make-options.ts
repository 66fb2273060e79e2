import type { CageModel } from 'cagecast/cages';
import { extract, type History } from '#three';
import { make } from '../../platform/make';
import { announce, element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import type { Model } from '../../state/model';
import type { Session } from '../../state/session';
import type { Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { BareBrush } from './bare-brush';

const kSteps = 40;
const kMakeDelay = 700; // milliseconds after the last change before the cage is made again

/** A value on a slider with equal ratios between its steps; its lowest position, 0, is automatic. */
const valueAt = (step: number, least: number, most: number): number =>
  step === 0 ? 0 : least * (most / least) ** ((step - 1) / (kSteps - 1));

/** The choices for made cages: distance, fineness, and parts and spots to leave bare. */
export class MakeOptionsPanel {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #maker: CageMaker;
  readonly #parts = element('make-parts', HTMLFieldSetElement);
  #target: Model | undefined;
  /** By part: whether it is painted unless the user chooses otherwise. */
  #usual: boolean[] = [];
  /** The marks that the cage is made with. */
  #bare: Uint8Array | undefined;
  #waiting: ReturnType<typeof setTimeout> | undefined;

  constructor(session: Session, viewer: Viewer, maker: CageMaker, tools: Tools, history: History) {
    this.#session = session;
    this.#viewer = viewer;
    this.#maker = maker;
    for (const name of ['offset', 'triangles'] as const)
      element(`make-${name}`, HTMLInputElement).addEventListener('input', () => {
        this.#write();
        this.#change();
      });
    this.#parts.addEventListener('change', () => this.#change());
    for (const end of ['pointerleave', 'focusout'])
      this.#parts.addEventListener(end, () => viewer.stage.highlight('parts', undefined));
    session.on('transfer', () => {
      this.#bare = session.bare;
      void this.#list();
    });
    session.on('zones', () => {
      if (session.bare === this.#bare) return;
      this.#bare = session.bare;
      this.#change();
    });
    this.#bare = session.bare;
    new BareBrush(session, viewer, tools, history);
    maker.choices = (model) => this.#choices(model);
    this.#write();
    void this.#list();
  }

  get #offset(): number {
    return Number(valueAt(element('make-offset', HTMLInputElement).valueAsNumber, 0.001, 0.05).toPrecision(2));
  }

  get #triangles(): number {
    return Number(valueAt(element('make-triangles', HTMLInputElement).valueAsNumber, 100, 10_000).toPrecision(2));
  }

  #write(): void {
    const show = (name: string, text: string): void => {
      element(`make-${name}-value`, HTMLOutputElement).value = text;
      element(`make-${name}`, HTMLInputElement).setAttribute('aria-valuetext', text);
    };
    const { format } = new Intl.NumberFormat('en', { maximumSignificantDigits: 2 });
    show('offset', this.#offset > 0 ? `${format(100 * this.#offset)} % of its size` : 'automatic');
    show('triangles', this.#triangles > 0 ? `about ${this.#triangles.toLocaleString('en')}` : 'automatic');
  }

  /** Makes a cage again if it was made here. */
  #change(): void {
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => this.#maker.isMade && void this.#maker.make(), kMakeDelay);
  }

  /** Lists the parts of the current target; those with names of bare parts are switched off. */
  async #list(): Promise<void> {
    const { target } = this.#session.shown ?? {};
    if (!target || target === this.#target) return;
    this.#target = target;
    clearTimeout(this.#waiting);
    this.#parts.hidden = true;
    const [engine, read] = await Promise.all([
      import('cagecast/cages'),
      // The model on the stage has overlays.
      this.#maker.read(target),
    ]);
    const { names } = extract(read.loaded);
    const bare = await engine.excludedByName(names);
    const { primitives } = target.mesh;
    if (target !== this.#target || names.length !== primitives.length || names.length < 2) return;
    this.#usual = bare.map((isBare) => !isBare);
    const rows = primitives.map(({ name, firstTriangle, triangleCount }, part) => {
      const input = make('input', { type: 'checkbox', checked: this.#usual[part]! });
      const row = make('label', { className: 'check' }, input, make('span', { translate: false }, name));
      const show = (): void => {
        const marks = new Uint8Array(target.mesh.indices.length / 3);
        this.#viewer.stage.highlight('parts', marks.fill(1, firstTriangle, firstTriangle + triangleCount));
      };
      for (const begin of ['pointerenter', 'focusin']) row.addEventListener(begin, show);
      return row;
    });
    this.#parts.replaceChildren(this.#parts.querySelector('legend')!, ...rows);
    this.#parts.hidden = false;
    if (this.#parts.offsetParent) announce(`${rows.length} parts can be switched.`);
  }

  #choices({ groups }: CageModel): ReturnType<NonNullable<CageMaker['choices']>> {
    const options = { offset: this.#offset, triangles: this.#triangles };
    if (this.#session.shown?.target !== this.#target) return { options };
    const painted = [...this.#parts.querySelectorAll('input')].map(({ checked }) => checked);
    if (!groups || painted.every((on, part) => on === this.#usual[part])) return { options };
    const inSpite = (of: boolean) =>
      painted.flatMap((on, part) => (on === of && on !== this.#usual[part] ? [part] : []));
    return { options: { ...options, parts: { keep: inSpite(true), exclude: inSpite(false) } } };
  }
}
