import type { Edits, Layer, LayerStack, Sheet } from '#three';
import { ask, kAskedFor, type Question } from '../platform/ask';
import { onFace } from '../platform/face';
import { element, showError } from '../platform/page';
import type { Locks } from '../state/choices';
import type { Intake } from '../state/intake';
import { carriedBy, madeOf, sampleOf } from '../state/made-cages';
import { asCage, asTarget, hasFace, type Loader, type Model, ownCage } from '../state/model';
import { isOffered, type Paint, titleOf } from '../state/paint';
import { haveSameUvs } from '../state/same-uvs';
import { kChecker, type Sample, type Samples } from '../state/sample';
import type { Requested, Shown } from '../state/scene';
import { kReading, type Session } from '../state/session';
import type { WardrobeOfPage } from '../state/wardrobe/kept';
import type { Drawings } from './drawn/drawings';
import { setUpFiles } from './files';
import { loadPaint, readImage } from './load-paint';
import { type Choice, offerPaints } from './paint-picker';
import { fetchFile, paintName } from './samples';
import { tellApart } from './tell-apart';
import { watchOverSample } from './watch-over';

const kOwn = 'own';

/** In which way a sample is opened. */
interface HowOpened {
  /** The paint that it begins with, by `paintName`; the first of its own by default. */
  paint?: string | undefined;
  /** Locks of its segments. */
  locks?: Locks;
  /** Gives it another cage, for which its own paints are not. */
  cageFor?: (target: Model) => Promise<Model>;
}

/** Opens samples and the user's own files, and shows what is open. */
export class Opener implements Samples {
  readonly #session: Session;
  readonly #stack: LayerStack;
  readonly #edits: Edits;
  readonly #select = element('sample-select', HTMLSelectElement);
  readonly #loader: Loader;
  /** The paints that are drawn for any cage. */
  readonly drawings: Drawings;
  /** Takes several models. */
  wardrobe: Pick<WardrobeOfPage, 'take'> | undefined;
  #samples: Sample[] = [];
  /** Warnings about the latest files, shown once these are loaded. */
  #warnings: readonly string[] = [];
  /** The cage whose paints are listed, and pictures of the drawn ones, once they are there. */
  #offered: { cage: Model; pictures: readonly string[] } | undefined;
  /** The base paint that was chosen last. */
  #chosen: Promise<Paint> | undefined;

  /** Ends the reading of the files that are asked for. */
  readonly #reading = new Map<'target' | 'cage', AbortController>();

  /** Gives a cage to a model that was opened alone. */
  cageFor: ((target: Model) => Promise<Model>) | undefined;
  /** Opens a saved project. */
  onProject: ((file: File) => void) | undefined;
  /** Takes an image that is to be a sticker. */
  onPicture: ((image: ImageBitmap) => Question['answers']) | undefined;
  /** Called with each requested target, and without one before the shown model is put aside. */
  onReplace: ((target?: Promise<Model>) => void) | undefined;

  constructor(session: Session, stack: LayerStack, edits: Edits, loader: Loader, drawings: Drawings) {
    this.#session = session;
    this.drawings = drawings;
    session.paintFor = (cage) => this.#paintFor(cage);
    this.#stack = stack;
    this.#edits = edits;
    this.#loader = loader;
    setUpFiles(
      (intake) => this.#open(intake),
      (files) => this.wardrobe?.take(files) ?? false,
    );
    this.#select.addEventListener('change', () => this.openSample(this.#select.value));
    element('swap', HTMLButtonElement).addEventListener('click', () => session.swap());
    session.on('progress', ({ state }) => {
      if (state === 'working') return;
      if (session.shown) this.#describe(session.shown);
      // The chosen one may have been cancelled or failed to load.
      const { sample } = session.shown?.target ?? {};
      if (sample && sample === session.shown?.cage.sample) this.#select.value = sample.name;
      if (state !== 'failed' && this.#warnings.length > 0) showError(this.#warnings.join(' '));
      this.#warnings = [];
    });
    session.on('cancel', () => this.#endReading('target', 'cage'));
    for (const event of ['change', 'select'] as const)
      stack.on(event, () => session.shown && this.#describe(session.shown));
  }

  get samples(): readonly Sample[] {
    return this.#samples;
  }

  /** Fills the list of samples: in Play, without test cases. */
  listSamples(samples: Sample[]): void {
    this.#samples = samples;
    onFace((shown) => {
      const { value } = this.#select;
      const offered = samples.filter(({ name, test }) => shown === 'inspect' || !test || name === value);
      const own = value === kOwn ? [new Option('Your own files', kOwn)] : [];
      this.#select.replaceChildren(...offered.map(({ name, title }) => new Option(title, name)), ...own);
      if (value) this.#select.value = value;
    });
  }

  /**
   * Opens a sample by name; does nothing if there is none.
   * @param how In which way; as the sample is, by default.
   */
  openSample(name: string, how: HowOpened = {}): void {
    const sample = this.#samples.find((candidate) => candidate.name === name);
    if (!sample) return;
    this.#select.value = name;
    this.#warnings = [];
    this.#endReading('target', 'cage');
    const model = async (address: string): Promise<Model> => ({
      ...(await this.#loader.loadOwn(await fetchFile(address))),
      sample,
    });
    const target = model(sample.target);
    // The cage of a sample without paints of its own is a template already.
    const cage = how.cageFor && sample.paints.length > 0 ? target.then(how.cageFor) : model(sample.cage);
    const requested = { target, cage, paint: this.#firstPaint(sample, how, cage) };
    this.#request(requested, how.locks, true);
    watchOverSample(this.#session, sample.title, requested, () => this.openSample(name, how));
  }

  /** The paint a sample opens with: the named one, else its first, else one that is drawn for its cage. */
  async #firstPaint(sample: Sample, { paint: name, cageFor }: HowOpened, loading: Promise<Model>): Promise<Paint> {
    if (name === kChecker) return this.#session.checker;
    const paints = cageFor || this.drawings.find(name ?? '') ? [] : sample.paints;
    const own = paints.find(({ file }) => paintName(file) === name) ?? paints[0];
    if (own) return this.#fetchPaint(sample, own);
    return this.#drawFor(asCage(await loading), name);
  }

  #request(requested: Requested, locks?: Locks, together?: boolean): void {
    if (requested.target) this.onReplace?.(requested.target);
    this.#session.request(requested, locks, together);
  }

  /** Loads a paint of any sample. @param name By `paintName`. @returns Undefined if there is none. */
  async paint(name: string): Promise<Paint | undefined> {
    if (name === kChecker) return this.#session.checker;
    const drawn = this.drawings.find(name);
    if (drawn) return this.drawings.draw(drawn, this.#session.shown!.cage);
    const found = this.find(name);
    return found && this.#fetchPaint(found.sample, found.paint);
  }

  /** Whether there is a paint of that name, by `paintName`. */
  has(name: string): boolean {
    return name === kChecker || this.drawings.find(name) !== undefined || this.find(name) !== undefined;
  }

  /** A sample's paint by `paintName`. */
  find(name: string): { sample: Sample; paint: Sample['paints'][number] } | undefined {
    return this.#samples
      .flatMap((sample) => sample.paints.map((paint) => ({ sample, paint })))
      .find(({ paint }) => paintName(paint.file) === name);
  }

  async #fetchPaint(sample: Sample, paint: Sample['paints'][number]): Promise<Paint> {
    return { ...(await loadPaint(await fetchFile(paint.file), paint.file)), sample };
  }

  /** The paint of a cage that comes without one: as the base is drawn, or drawn afresh if that was made for another cage. */
  async #paintFor(loading: Promise<Model>): Promise<Paint> {
    const { shown, checker } = this.#session;
    const cage = asCage(await loading);
    const base = this.#stack.base?.sheet as Paint | undefined;
    const { paint } = carriedBy(cage.files[0]!);
    if (paint && shown?.cage.files[0] !== cage.files[0]) {
      const own = await loadPaint(paint).catch(() => undefined);
      if (own) return own;
    }
    const isOwn = base !== undefined && !isOffered(base, checker);
    // What is drawn for a face differs.
    const fits = shown && haveSameUvs(shown.cage, cage) && (hasFace(shown.cage) || !hasFace(cage));
    if (shown && (isOwn || fits)) return shown.paint;
    return this.#drawFor(cage, base?.drawn);
  }

  /** Draws the named paint, or what a cage begins with. */
  #drawFor(cage: Model, name = ''): Promise<Paint> {
    const drawn = this.drawings.find(name) ?? this.drawings.firstFor(cage);
    return this.drawings.draw(drawn, cage).catch(() => this.#session.checker);
  }

  /** Opens the user's own files. */
  #open({ target, cage, texture, image, project, unclear, warnings, all }: Intake): void {
    if (project) this.onProject?.(project);
    else if (image) void this.#openImage(image, warnings);
    if (project || image) return;
    const requested: Requested = {};
    const load = (slot: 'target' | 'cage', file: File): Promise<Model> => {
      this.#endReading(slot);
      const abort = new AbortController();
      this.#reading.set(slot, abort);
      return this.#loader.load(file, all, abort.signal);
    };
    if (target) requested.target = load('target', target);
    if (cage) requested.cage = load('cage', cage);
    if (unclear.length > 0) {
      const open = (target: File, cage?: File): void =>
        this.#open({ target, cage, texture, unclear: [], warnings, all });
      void tellApart(unclear, open, this.wardrobe && (() => this.wardrobe!.take(all, true)));
      return;
    }
    if (requested.target && !requested.cage) requested.cage = this.#cageOf(requested.target);
    if (texture) requested.paint = loadPaint(texture);
    if (texture && !target && !cage && this.#session.isMakingCage) {
      void this.#use(requested.paint!, (paint) => this.#session.reportPaint(paint));
      return;
    }
    this.#warnings = warnings;
    this.#request(requested);
  }

  /** Opens an image that came alone: a square of a power of two is a paint, any other a sticker; so is a JPEG where there is a face. */
  async #openImage(image: File, warnings: string[]): Promise<void> {
    const open = (): void => this.#open({ texture: image, unclear: [], warnings, all: [image] });
    const bitmap = await readImage(image).catch(() => undefined); // as a paint, it is said what is wrong
    const cage = this.#session.shown?.cage;
    const mayBeFace = image.type === 'image/jpeg' && cage !== undefined && hasFace(cage);
    const isPaint = !bitmap || (isSheet(bitmap) && !mayBeFace);
    if (isPaint || !this.onPicture) return open();
    const others = this.onPicture(bitmap);
    const text = `${image.name}: click where it belongs on the model.`;
    // On a phone it lies over the model.
    ask({ text, answers: [...others, { title: 'Use as a whole paint', run: open }], lasts: kAskedFor });
  }

  /** Nobody waits for these files any more. */
  #endReading(...slots: readonly ('target' | 'cage')[]): void {
    for (const slot of slots) this.#reading.get(slot)?.abort();
  }

  /** The cage of a target that was opened alone: its own, one the user has opened before, or a new one, fitted or made. */
  async #cageOf(loading: Promise<Model>): Promise<Model> {
    const before = this.#session.requested.cage?.catch(() => undefined);
    const target = asTarget(await loading);
    const own = ownCage(target);
    if (own) return own;
    const last = await before;
    if (last && !last.sample && !madeOf(last.files[0]!)) return last;
    try {
      if (this.cageFor) return await this.cageFor(target);
    } catch (error) {
      if (!last) throw error;
      showError((error as Error).message);
    }
    return last!;
  }

  #describe({ target, cage }: Shown): void {
    const { layers, base } = this.#stack;
    const paints = layers.map(({ sheet }) => sheet as Sheet & Partial<Paint>);
    const texture = paints.findLast(({ file, sample }) => file && !sample) ?? base?.sheet;
    const names = { target: target.name, cage: cage.name, texture: (texture as Paint | undefined)?.name ?? 'none' };
    for (const [slot, name] of Object.entries(names)) {
      const label = element(`${slot}-name`, HTMLElement);
      label.textContent = label.title = name;
      label.translate = !name.includes('.'); // the names of files are their owner's
    }
    const size = ({ mesh }: Model): string => `${(mesh.indices.length / 3).toLocaleString('en')} triangles`;
    const { leftOut } = target.mesh;
    const others = leftOut.length > 0 ? ` Left out: ${leftOut.join(', ')}.` : '';
    const menu = element('menu-name', HTMLElement);
    menu.translate = target.sample !== undefined;
    menu.textContent = target.sample?.title ?? target.name;
    element('sizes', HTMLElement).textContent = `Model ${size(target)}, cage ${size(cage)}.${others}`;
    this.#describeOrigin({ target, cage });
    void this.#offerPaints({ cage });
  }

  /** Says which of the models still belongs to a sample. */
  #describeOrigin({ target, cage }: Pick<Shown, 'target' | 'cage'>): void {
    const own = this.#select.querySelector<HTMLOptionElement>(`option[value=${kOwn}]`);
    if (target.sample && cage.sample) own?.remove();
    else {
      if (!own) this.#select.append(new Option('Your own files', kOwn));
      this.#select.value = kOwn;
    }
    const isMade = madeOf(cage.files[0]!)?.target === target.files[0];
    element('swap', HTMLButtonElement).hidden = isMade || Boolean(target.sample ?? cage.sample);
    element('hint', HTMLElement).textContent =
      isMade || !target.sample === !cage.sample
        ? 'Choose your own files, or drop them anywhere on the page. They stay on this device.'
        : target.sample
          ? 'The cage is yours, but the model is still the sample’s. Add the model that your cage was made for.'
          : 'The model is yours, but the cage is a sample’s. Add the cage that was made for your model, or make one.';
  }

  /** The layer of an offered paint that is selected, or else the uppermost one: it covers those below. */
  get #top(): Layer | undefined {
    const { selected, layers, base } = this.#stack;
    const isMeant = (layer?: Layer): boolean =>
      layer?.visible === true && isOffered(layer.sheet, this.#session.checker);
    return isMeant(selected) ? selected : (layers.findLast(isMeant) ?? base);
  }

  /** Puts a paint in place of that one, as an undo step. */
  async #choose(loaded: Promise<Paint>): Promise<void> {
    const { isMakingCage, shown } = this.#session;
    const set = (sheet: Paint): unknown =>
      this.#edits.do(`choosing ${titleOf(sheet)}`, () => {
        const [top, name] = [this.#top, titleOf(sheet)];
        if (!top || top === this.#stack.base) this.#stack.setBase(name, sheet);
        else this.#stack.change([top], [{ ...top, name, sheet }]);
      });
    this.#chosen = loaded;
    if (isMakingCage)
      return this.#use(loaded, (paint) => {
        if (loaded === this.#chosen && shown!.cage === this.#session.shown!.cage) set(paint);
      });
    let isRequested = true;
    const done = this.#session.work(kReading, 0, { abort: () => (isRequested = false) });
    try {
      const paint = await loaded;
      if (!isRequested) return;
      set(paint);
      done();
    } catch (error) {
      if (isRequested) this.#session.fail(error);
      void this.#offerPaints(this.#session.shown!);
    }
  }

  /** Does something with a paint once it is loaded; a cage that is being made goes on. */
  async #use(loading: Promise<Paint>, act: (paint: Paint) => unknown): Promise<void> {
    try {
      act(await loading);
    } catch (error) {
      showError((error as Error).message);
      void this.#offerPaints(this.#session.shown!);
    }
  }

  /** Lists the base paints: at once the sample's, and the checker; those that are drawn once there are pictures of them. */
  async #offerPaints({ cage }: Pick<Shown, 'cage'>): Promise<void> {
    if (this.#offered?.cage !== cage) this.#offered = { cage, pictures: [] };
    const offered = this.#offered;
    this.#listPaints(offered);
    const pictures = await this.drawings.pictures(cage).catch(() => []);
    if (offered !== this.#offered || offered.pictures === pictures) return;
    offered.pictures = pictures;
    this.#listPaints(offered);
  }

  #listPaints({ cage, pictures }: { cage: Model; pictures: readonly string[] }): void {
    const { checker } = this.#session;
    const sample = sampleOf(cage);
    const drawn = this.drawings.listFor(cage);
    const choices: (Choice & { drawn?: string; load(): Promise<Paint> })[] = [
      ...(sample?.paints ?? []).map((paint) => ({
        title: paint.title,
        picture: paint.file,
        load: () => this.#fetchPaint(sample!, paint),
      })),
      ...drawn.flatMap((paint, i) => {
        const [title, picture] = [paint.title, pictures[i]];
        return picture
          ? [{ title, picture, kind: paint.kind, drawn: paint.name, load: () => this.drawings.draw(paint, cage) }]
          : [];
      }),
      { title: checker.name, picture: checker.picture, load: async () => checker },
    ];
    const top = this.#top?.sheet as Paint | undefined;
    const chosen = choices.findIndex(({ picture, drawn }) => (drawn ? drawn === top?.drawn : picture === top?.picture));
    offerPaints(choices, chosen, {
      onChoose: (index) => this.#choose(choices[index]!.load()),
      onAdd: (index) =>
        this.#use(choices[index]!.load(), (paint) =>
          this.#edits.do(`adding ${titleOf(paint)}`, () => this.#stack.add(titleOf(paint), paint)),
        ),
    });
  }
}

/** Whether an image has the shape of most textures: a square of a power of two. */
const isSheet = ({ width, height }: ImageBitmap): boolean => width === height && (width & (width - 1)) === 0;
