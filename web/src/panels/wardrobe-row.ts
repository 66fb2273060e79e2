import type { Texture } from 'three';
import type { LayerStack } from '#three';
import { exportAll } from '../export/export-all';
import type { Drawings } from '../loading/drawn/drawings';
import { entriesOf, keptEntry, sampleEntry } from '../loading/entries';
import { fitLike } from '../loading/fit-like';
import { TransferClient } from '../loading/transfer-client';
import { download } from '../platform/download';
import { addError, announce, element, showError } from '../platform/page';
import type { CageMaker } from '../state/cage-maker';
import type { Loader } from '../state/model';
import type { Paint } from '../state/paint';
import type { Sample } from '../state/sample';
import type { Session } from '../state/session';
import { type Avatar, kMaxAvatars } from '../state/wardrobe/avatar';
import type { KeptWardrobe } from '../state/wardrobe/kept';
import type { Surroundings } from '../state/wardrobe/surroundings';
import { Wardrobe } from '../state/wardrobe/wardrobe';
import type { Viewer } from '../view/viewer';
import { type Feet, WardrobeStage } from '../view/wardrobe/wardrobe-stage';

/** What the wardrobe needs of the page. */
export interface WardrobePage {
  session: Session;
  loader: Loader;
  viewer: Viewer;
  stack: LayerStack;
  maker: Pick<CageMaker, 'choose'>;
  drawings: Pick<Drawings, 'find' | 'draw'>;
  /** The composite of the layers. */
  paint: Texture;
  /** Encodes it. */
  png(): Promise<Blob>;
  samples(): readonly Sample[];
  /** Called when the wardrobe may have changed. */
  onChange(): void;
}

const kTap = 6; // pixels that a pointer may move during a tap

const kRow = `
  <div class="wardrobe-note" id="wardrobe-note" hidden>
    <p role="status" data-testid="wardrobe-note"></p>
    <button type="button" class="quiet" id="fit-all" data-testid="fit-all">Put it on all</button>
  </div>
  <div class="wardrobe-row">
    <label class="toggle"><input type="checkbox" id="show-all" data-testid="show-all" /><span>Show all</span></label>
    <ol class="avatars" id="avatars" data-testid="avatars" aria-label="Avatars"></ol>
    <label class="file add" title="Add files"><span class="unseen">Add files</span><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="M12 5v14M5 12h14" /></svg><input type="file" id="wardrobe-input" data-testid="wardrobe-input" multiple accept=".glb,.gltf,.vrm,.bin,.png,.jpg,.jpeg,.webp,.ktx2" /></label>
    <select id="wardrobe-sample" data-testid="wardrobe-sample" aria-label="Add a sample"></select>
  </div>`;

const kAvatar = `
  <button type="button" class="avatar"><i aria-hidden="true"></i><span class="name"></span><span class="unseen">, </span><span class="state"></span></button>
  <button type="button" class="icon remove"><svg viewBox="0 0 24 24" aria-hidden="true" focusable="false"><path d="M6 6l12 12M18 6 6 18"/></svg></button>`;

/** The names of the avatars: in a row on the stage, or below the feet of those who stand side by side. */
export class WardrobeRow {
  readonly #page: WardrobePage;
  readonly #stage: WardrobeStage;
  readonly #wardrobe: Wardrobe;
  readonly #list: HTMLOListElement;
  readonly #all: HTMLInputElement;
  readonly #export: HTMLButtonElement;
  #said = '';
  readonly #items = new Map<Avatar, HTMLLIElement>();

  constructor(page: WardrobePage) {
    const { session, viewer, paint, loader, stack } = page;
    this.#page = page;
    this.#stage = new WardrobeStage(session, viewer, paint, (feet) => this.#place(feet));
    this.#wardrobe = new Wardrobe({
      session,
      loader,
      transferer: new TransferClient(),
      fit: fitLike,
      drawing: () => this.#drawing(),
      choose: (model, progress) => page.maker.choose(model, progress),
      view: this.#stage,
      errors: { show: showError, add: addError },
    });
    for (const event of ['change', 'pictures'] as const) stack.on(event, () => this.#wardrobe.refresh());
    element('wardrobe-bar', HTMLElement).innerHTML = kRow;
    this.#list = element('avatars', HTMLOListElement);
    this.#all = element('show-all', HTMLInputElement);
    this.#export = element('export-all', HTMLButtonElement);
    this.#all.addEventListener('change', () => (this.#wardrobe.showsAll = this.#all.checked));
    this.#export.addEventListener('click', () => void this.#exportAll());
    element('fit-all', HTMLButtonElement).addEventListener('click', () => this.#wardrobe.fitAll());
    const input = element('wardrobe-input', HTMLInputElement);
    input.addEventListener('change', () => {
      const files = [...(input.files ?? [])];
      input.value = ''; // lets the user choose the same file again
      this.add(files);
    });
    this.#listSamples();
    this.#wardrobe.list.on('change', () => {
      this.#show();
      page.onChange();
    });
    this.#pickOnStage();
    this.#show();
  }

  /** Adds models, with their cages if there are some among the files. @param instead Of the sample on the stage. */
  add(files: readonly File[], instead = false): void {
    const entries = entriesOf(files, this.#page.loader);
    if (entries.length === 0) {
      showError('There is no model among these files: choose GLB, glTF or VRM files.');
      return;
    }
    const { active } = this.#wardrobe.list;
    this.#addAll(entries, instead && active.sample ? active : undefined);
  }

  #drawing(): ReturnType<Surroundings['drawing']> {
    const { stack, drawings } = this.#page;
    const base = stack.base?.visible ? (stack.base.sheet as Partial<Paint>) : undefined;
    const drawn = drawings.find(base?.drawn ?? '');
    return drawn && { name: drawn.name, draw: (cage) => drawings.draw(drawn, cage) };
  }

  /** Moves the focus to the avatar on the stage, or to the first where that one is still to come. */
  focus(): void {
    const item = this.#items.get(this.#wardrobe.list.active) ?? this.#list.firstElementChild;
    item?.querySelector('button')?.focus({ preventScroll: true });
  }

  /** Only the model on the stage is shown from now on. */
  close(): void {
    this.#all.checked = this.#wardrobe.showsAll = false;
  }

  /** What a project has of it. */
  get kept(): KeptWardrobe {
    return this.#wardrobe.kept;
  }

  /** Brings the avatars of a project back. */
  restore({ at, all, avatars }: KeptWardrobe): void {
    const { samples, loader } = this.#page;
    this.#wardrobe.restore(
      avatars.map((avatar) => keptEntry(avatar, samples(), loader)),
      at,
    );
    if (this.#all.checked !== all) this.#all.click();
  }

  #addAll(entries: Parameters<Wardrobe['add']>[0], instead?: Avatar): void {
    void this.#wardrobe.add(entries, instead);
    if (!this.#all.checked) this.#all.click();
  }

  #listSamples(): void {
    const select = element('wardrobe-sample', HTMLSelectElement);
    const samples = this.#page.samples();
    select.replaceChildren(new Option('Add sample', ''), ...samples.map(({ name, title }) => new Option(title, name)));
    select.addEventListener('change', () => {
      const sample = samples.find(({ name }) => name === select.value);
      select.value = '';
      if (sample) this.#addAll([sampleEntry(sample, this.#page.loader)]);
    });
  }

  #show(): void {
    const { all: avatars, active } = this.#wardrobe.list;
    for (const [avatar, item] of this.#items) {
      if (avatars.includes(avatar)) continue;
      const focused = item.contains(document.activeElement);
      item.remove();
      this.#items.delete(avatar);
      if (focused) this.focus();
    }
    const isAlone = !this.#all.checked || avatars.length < 2;
    for (const avatar of avatars) {
      const item = this.#items.get(avatar) ?? this.#makeItem(avatar);
      if (isAlone) item.className = item.style.cssText = '';
      fill(item, avatar, avatar === active, avatars.length > 1);
    }
    const items = avatars.map((avatar) => this.#items.get(avatar)!);
    if (items.some((item, at) => item !== this.#list.children[at])) this.#list.replaceChildren(...items);
    const ready = avatars.filter(({ files, doing }) => files.length > 0 && doing === '');
    // What is painted by hand is for the cage on the stage alone.
    const isDrawn = this.#page.stack.layers.length === 1;
    const taking = ready.filter(({ takesPaint, own }) => takesPaint || (own && isDrawn));
    const note = element('wardrobe-note', HTMLElement);
    note.hidden = taking.length === ready.length || ready.length < Math.max(2, avatars.length); // all are ready
    const text = `${taking.length} of ${ready.length} wear this paint.`;
    const said = note.querySelector('p')!;
    if (!note.hidden && this.#said !== text) said.textContent = this.#said = text;
    for (const control of [element('wardrobe-input', HTMLInputElement), element('wardrobe-sample', HTMLSelectElement)])
      control.disabled = avatars.length >= kMaxAvatars;
    this.#export.disabled = !ready.some(isPainted);
    this.#export.hidden = avatars.length < 2;
  }

  #makeItem(avatar: Avatar): HTMLLIElement {
    const item = document.createElement('li');
    item.innerHTML = kAvatar;
    const [choose, remove] = item.querySelectorAll('button') as unknown as [HTMLButtonElement, HTMLButtonElement];
    choose.addEventListener('click', () => this.#wardrobe.activate(avatar));
    choose.addEventListener('keydown', (event) => {
      if (event.key === 'Delete') this.#remove(avatar);
    });
    remove.addEventListener('click', () => this.#remove(avatar));
    this.#items.set(avatar, item);
    this.#list.append(item);
    return item;
  }

  #remove(avatar: Avatar): void {
    this.#wardrobe.remove(avatar);
    announce(`${avatar.name} removed.`);
  }

  /** Puts names below the feet of those who are seen. */
  #place(feet: readonly Feet[]): void {
    const { all, active } = this.#wardrobe.list;
    const { clientWidth, clientHeight } = element('view', HTMLCanvasElement);
    const seen = all.filter((avatar) => avatar === active || avatar.standing);
    feet.forEach(({ x, y, width }, i) => {
      const item = this.#items.get(seen[i]!);
      if (!item) return;
      // Elsewhere the name is in the row.
      const isSeen = x > 0 && x < clientWidth && y > 0 && y < clientHeight;
      item.classList.toggle('placed', isSeen);
      item.style.cssText = !isSeen
        ? ''
        : `translate: calc(${x.toFixed(1)}px - 50%) ${y.toFixed(1)}px; max-width: max(${width.toFixed()}px, 6rem)`;
    });
  }

  /** A tap on a model beside the one on the stage puts it there. */
  #pickOnStage(): void {
    const canvas = element('view', HTMLCanvasElement);
    let pressed: PointerEvent | undefined;
    canvas.addEventListener('pointerdown', (event) => (pressed = event.button === 0 ? event : undefined));
    canvas.addEventListener('pointerup', (event) => {
      if (
        !pressed ||
        this.#page.viewer.pointing.tool ||
        Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > kTap
      )
        return;
      const figure = this.#stage.at(event.clientX, event.clientY);
      const found = figure && this.#wardrobe.list.all.find(({ standing }) => standing === figure);
      if (found) this.#wardrobe.activate(found);
    });
  }

  async #exportAll(): Promise<void> {
    const button = this.#export;
    // Not disabled, so that it keeps the focus.
    if (button.ariaBusy) return;
    button.ariaBusy = 'true';
    const note = button.querySelector('small')!;
    const { session, png } = this.#page;
    const { all: avatars, active } = this.#wardrobe.list;
    const taking = avatars.filter((avatar) => isPainted(avatar) && avatar.doing === '');
    try {
      const report = (done: number): void => void (note.textContent = `Saving ${done + 1} of ${taking.length}`);
      const { file, count, troubles } = await exportAll(taking, session, active, await png(), report);
      download(file, 'avatars-painted.zip');
      announce(`${count} avatars saved: ${(file.size / 1e6).toFixed(1)} megabytes.`);
      const late = avatars.filter(({ doing }) => doing !== '').length;
      const reportLeft = (count: number, why: string): void => {
        if (count > 0) troubles.push(`${count} of the avatars ${count === 1 ? 'was' : 'were'} left out: ${why}.`);
      };
      reportLeft(late, 'not ready yet');
      reportLeft(avatars.length - taking.length - late, 'of another cage');
      if (troubles.length > 0) showError(troubles.join(' '));
    } catch (error) {
      showError((error as Error).message);
    } finally {
      button.ariaBusy = null;
      note.textContent = 'one ZIP';
    }
  }
}

const isPainted = ({ takesPaint, own }: Avatar): boolean => takesPaint || own !== undefined;

/** What is said of an avatar that is painted. */
const kVerdictWords: Record<Avatar['verdict'], string> = {
  '': 'painted',
  good: 'painted',
  usable: 'looks off?',
  unfit: 'does not look right',
};

function fill(item: HTMLLIElement, avatar: Avatar, isActive: boolean, isRemovable: boolean): void {
  const { name, verdict, cage, doing, files } = avatar;
  const isWorn = isPainted(avatar);
  const [choose, remove] = item.querySelectorAll('button') as unknown as [HTMLButtonElement, HTMLButtonElement];
  item.querySelector('.name')!.textContent = name;
  const state = doing || (!cage ? 'bare' : !isWorn ? 'other paint' : kVerdictWords[verdict]);
  item.querySelector('.state')!.textContent = state;
  item.dataset.verdict = doing || !cage || !isWorn ? '' : verdict || 'good';
  choose.ariaPressed = String(isActive);
  choose.ariaDisabled = files.length === 0 ? 'true' : null;
  choose.title = state;
  remove.ariaLabel = `Remove ${name}`;
  remove.hidden = !isRemovable || !isActive;
}
