import type { WebGLRenderer } from 'three';
import type { Edits } from '../layers/edits';
import type { LayerStack } from '../layers/stack';
import { type Choice, offerPaints } from '../panels/paint-picker';
import { element, showError } from '../platform/page';
import { type Intake, setUpFiles } from './files';
import { loadModel, type Model } from './load';
import { loadPaint, type Paint, titleOf } from './paint';
import { fetchFile, kChecker, paintName, type Sample } from './samples';
import { kReading, type Locks, type Session, type Shown, type Wanted } from './session';

const kOwn = 'own';

/** Opens samples and the visitor's own files, and says what is open. */
export class Opener {
  readonly #session: Session;
  readonly #stack: LayerStack;
  readonly #edits: Edits;
  readonly #select = element('sample-select', HTMLSelectElement);
  readonly #renderer: WebGLRenderer | undefined;
  #samples: Sample[] = [];
  /** What is to be said of the files that came in last, once they are on show. */
  #doubts: readonly string[] = [];

  /** @param renderer What shows them, if anything can. */
  constructor(session: Session, stack: LayerStack, edits: Edits, renderer: WebGLRenderer | undefined) {
    this.#session = session;
    this.#stack = stack;
    this.#edits = edits;
    this.#renderer = renderer;
    setUpFiles((intake) => this.#take(intake));
    this.#select.addEventListener('change', () => this.openSample(this.#select.value));
    element('swap', HTMLButtonElement).addEventListener('click', () => session.swap());
    session.on('progress', ({ state }) => {
      if (state === 'working') return;
      if (session.shown) this.#describe(session.shown);
      // Another that was chosen may have been given up, or cannot be had.
      const { sample } = session.shown?.target ?? {};
      if (sample && sample === session.shown?.cage.sample) this.#select.value = sample.name;
      if (state !== 'failed' && this.#doubts.length > 0) showError(this.#doubts.join(' '));
      this.#doubts = [];
    });
    stack.on('change', () => session.shown && this.#describe(session.shown));
  }

  get samples(): readonly Sample[] {
    return this.#samples;
  }

  /** Lists the samples to choose from. */
  listSamples(samples: Sample[]): void {
    this.#samples = samples;
    this.#select.replaceChildren(...samples.map(({ name, title }) => new Option(title, name)));
  }

  /**
   * Opens the sample of that name; there may be none of that name.
   * @param paint Which of its paints, by `paintName`: the first, if it has none of that name.
   * @param locks What is already said about its segments.
   */
  openSample(name: string, paint?: string, locks: Locks = {}): void {
    const sample = this.#samples.find((candidate) => candidate.name === name);
    if (!sample) return;
    this.#select.value = name;
    this.#doubts = [];
    const { target, cage, paints } = sample;
    const chosen = paint === kChecker ? undefined : (paints.find(({ file }) => paintName(file) === paint) ?? paints[0]);
    const model = async (address: string): Promise<Model> => ({
      ...(await loadModel(await fetchFile(address), this.#renderer)),
      sample,
    });
    this.#session.want(
      { target: model(target), cage: model(cage), paint: this.#fetchPaint(sample, chosen) },
      locks,
      true,
    );
  }

  /** Reads a paint of any sample. @param name By `paintName`. @returns Nothing if there is none of that name. */
  async paint(name: string): Promise<Paint | undefined> {
    if (name === kChecker) return this.#session.checker;
    const found = this.#find(name);
    return found && this.#fetchPaint(found.sample, found.paint);
  }

  /** Whether there is a paint of that name, by `paintName`. */
  has(name: string): boolean {
    return name === kChecker || this.#find(name) !== undefined;
  }

  #find(name: string): { sample: Sample; paint: Sample['paints'][number] } | undefined {
    return this.#samples
      .flatMap((sample) => sample.paints.map((paint) => ({ sample, paint })))
      .find(({ paint }) => paintName(paint.file) === name);
  }

  async #fetchPaint(sample: Sample, paint: Sample['paints'][number] | undefined): Promise<Paint> {
    return paint ? { ...(await loadPaint(await fetchFile(paint.file), paint.file)), sample } : this.#session.checker;
  }

  /** Takes in files of the visitor's own. */
  #take({ target, cage, texture, unclear, doubts, all }: Intake): void {
    const wanted: Wanted = {};
    const load = (file: File): Promise<Model> => loadModel(file, this.#renderer, all);
    if (target) wanted.target = load(target);
    if (cage) wanted.cage = load(cage);
    const [one, other] = unclear;
    if (one && other) {
      // Nothing in their names tells: the cage is the one with fewer triangles.
      const pair = Promise.all([load(one), load(other)]).then((models) =>
        models.sort((a, b) => b.mesh.indices.length - a.mesh.indices.length),
      );
      wanted.target = pair.then(([larger]) => larger!);
      wanted.cage = pair.then(([, smaller]) => smaller!);
    }
    if (texture) wanted.paint = loadPaint(texture);
    this.#doubts = doubts;
    this.#session.want(wanted);
  }

  #describe({ target, cage, paint }: Shown): void {
    // Another may have been chosen since, or all been removed.
    const { layers, base } = this.#stack;
    const isOwn = !paint.sample && paint !== this.#session.checker && layers.some(({ sheet }) => sheet === paint);
    const texture = isOwn ? paint : ((base?.sheet as Paint | undefined) ?? { name: 'none' });
    for (const [slot, { name }] of Object.entries({ target, cage, texture })) {
      const label = element(`${slot}-name`, HTMLElement);
      label.textContent = label.title = name;
    }
    const size = ({ mesh }: Model): string => `${(mesh.indices.length / 3).toLocaleString('en')} triangles`;
    element('sizes', HTMLElement).textContent = `Target ${size(target)}, cage ${size(cage)}.`;
    this.#describeOrigin(target.sample !== undefined, cage.sample !== undefined);
    this.#offerPaints({ cage });
  }

  /** Tells what is still a sample's among files of one's own. */
  #describeOrigin(target: boolean, cage: boolean): void {
    const own = this.#select.querySelector<HTMLOptionElement>(`option[value=${kOwn}]`);
    if (target && cage) own?.remove();
    else {
      if (!own) this.#select.append(new Option('Your own files', kOwn));
      this.#select.value = kOwn;
    }
    element('swap', HTMLButtonElement).hidden = target || cage;
    element('hint', HTMLElement).textContent =
      target === cage
        ? 'Choose your own, or drop files anywhere on the page. They stay on this device.'
        : target
          ? 'The cage is yours, the target is still the sample’s: add the target this cage was made for.'
          : 'The target is yours, the cage is still the sample’s: add the cage made for it.';
  }

  /** Puts another paint under everything, as a step that can be undone. */
  async #choose(loaded: Promise<Paint>): Promise<void> {
    let wanted = true;
    const done = this.#session.work(kReading, 0, () => (wanted = false));
    try {
      const paint = await loaded;
      if (!wanted) return;
      this.#edits.do(`choice of ${titleOf(paint)}`, () => this.#stack.setBase(titleOf(paint), paint));
      done();
    } catch (error) {
      if (wanted) this.#session.fail(error);
      this.#offerPaints(this.#session.shown!);
    }
  }

  /** Offers what may lie under everything: the sample's paints, and the checker. */
  #offerPaints({ cage: { sample } }: Pick<Shown, 'cage'>): void {
    const { checker } = this.#session;
    const choices: (Choice & { load(): Promise<Paint> })[] = [
      ...(sample?.paints ?? []).map((paint) => ({
        title: paint.title,
        picture: paint.file,
        load: () => this.#fetchPaint(sample!, paint),
      })),
      { title: checker.name, picture: checker.picture, load: async () => checker },
    ];
    const chosen = choices.findIndex(({ picture }) => picture === this.#stack.base?.sheet.picture);
    offerPaints(choices, chosen, {
      onChoose: (index) => this.#choose(choices[index]!.load()),
      onAdd: async (index) => {
        try {
          const paint = await choices[index]!.load();
          this.#edits.do(`adding of ${titleOf(paint)}`, () => this.#stack.add(titleOf(paint), paint));
        } catch (error) {
          showError((error as Error).message);
        }
      },
    });
  }
}
