import { type Edits, Emitter, type Layer, type LayerStack, maxLayers, type Sheet } from '#three';
import type { Model } from './model';
import type { Paint } from './paint';
import { haveSameUvs } from './same-uvs';
import type { Scene } from './scene';
import type { Session } from './session';

/** The paint of an earlier cage around the current target. */
export interface EarlierPaint {
  /** Also what came with a sample. */
  layers: readonly Layer[];
  cage: Model['mesh'];
}

/**
 * Puts the layers away that were painted for another cage, and offers them again until they are brought back: those for the
 * current cage, or else all. They stay where a cage has the same UVs. `earlier` can be carried over to the current cage.
 */
export class PutAwayLayers extends Emitter<{ change: undefined }> {
  readonly #session: Session;
  readonly #stack: LayerStack;
  readonly #edits: Edits;
  #last: Pick<Scene, 'target' | 'cage'> | undefined;
  #earlier: (EarlierPaint & { target: Model }) | undefined;
  #away: readonly Layer[] = [];
  /** The mesh of the cage that each layer was painted for; not known of those from before the page was opened. */
  readonly #meshes = new WeakMap<Sheet, Model['mesh']>();
  /** The target on which each was drawn. */
  readonly #targets = new WeakMap<Sheet, Model>();

  constructor(session: Session, stack: LayerStack, edits: Edits) {
    super();
    this.#session = session;
    this.#stack = stack;
    this.#edits = edits;
    session.on('transfer', ({ target, cage }) => this.#onCage({ target, cage }));
    stack.on('change', () => this.emit('change', undefined));
  }

  /** All that are away. Undoing brings them back too, and redoing puts them away again. */
  get layers(): readonly Layer[] {
    return this.#away.filter(({ id }) => this.#stack.layers.every((layer) => layer.id !== id));
  }

  /** Those that are offered: of this target, or for its cage. */
  get offered(): readonly Layer[] {
    return this.layers.filter(
      ({ sheet }) => this.#targets.get(sheet) === this.#last?.target || this.#isForCage({ sheet }),
    );
  }

  #isForCage({ sheet }: Pick<Layer, 'sheet'>): boolean {
    const mesh = this.#meshes.get(sheet);
    return mesh !== undefined && haveSameUvs({ mesh }, this.#last!.cage);
  }

  /** The paint that was put away last, if the current target is the one that it was drawn on, and nothing is drawn since. */
  get earlier(): EarlierPaint | undefined {
    const { layers } = this.#stack;
    const isBare = layers.every((layer) => this.#isGiven(layer));
    return isBare && this.#earlier?.target === this.#last?.target ? this.#earlier : undefined;
  }

  /** Adds what `earlier` has become for the current cage. @throws Error if there is no room. */
  carryOver(name: string, sheet: Sheet): void {
    const carried = this.#earlier?.layers ?? [];
    this.#edits.do('carrying the paint over', () => {
      this.#stack.add(name, sheet);
      this.#showGiven(false);
    });
    this.#earlier = undefined;
    this.show(this.#away.filter(({ id }) => carried.every((layer) => layer.id !== id)));
  }

  /** Offers others instead. */
  show(layers: readonly Layer[]): void {
    this.#away = layers;
    // Those of a project are of its model.
    for (const { sheet } of layers)
      if (this.#last && !this.#targets.has(sheet)) this.#targets.set(sheet, this.#last.target);
    this.emit('change', undefined);
  }

  /** Brings back as many as there is room for. @throws Error if there is room for none. */
  bringBack(): void {
    const all = this.offered;
    const own = all.filter((layer) => this.#isForCage(layer));
    // Without any room, the stack says so.
    const room = Math.max(1, maxLayers - this.#stack.layers.length);
    this.#edits.do('bringing layers back', () => {
      this.#stack.change([], (own.length > 0 ? own : all).slice(0, room));
      this.#showGiven(false);
    });
    this.show(this.layers);
  }

  #showGiven(visible: boolean): void {
    const { base } = this.#stack;
    if (base && this.#isGiven(base)) this.#stack.restyle(base, { visible });
  }

  /** Whether a layer is what a cage is painted with until there is something else. */
  #isGiven({ sheet }: Layer): boolean {
    return sheet === this.#session.checker || (sheet as Sheet & Partial<Paint>).drawn !== undefined;
  }

  #onCage(now: Pick<Scene, 'target' | 'cage'>): void {
    const before = this.#last;
    this.#last = now;
    if (!before || haveSameUvs(before.cage, now.cage)) return;
    this.#edits.cancel(); // a stroke in progress is of the cage before
    const shown = this.#stack.layers.filter((layer) => layer.visible && !this.#isGiven(layer));
    if (shown.length > 0) this.#earlier = { layers: shown, cage: before.cage.mesh, target: before.target };
    if (this.#earlier && haveSameUvs({ mesh: this.#earlier.cage }, now.cage)) this.#earlier = undefined;
    const old = this.#stack.layers.filter(({ id }) => id !== this.#stack.base?.id);
    // Nothing else is to be seen now.
    if (old.length === 0) {
      this.#showGiven(true);
      this.emit('change', undefined);
      return;
    }
    for (const { sheet } of old) {
      this.#meshes.set(sheet, before.cage.mesh);
      this.#targets.set(sheet, before.target);
    }
    const kept = [...this.layers, ...old].slice(-maxLayers);
    this.#edits.do('putting layers away', () => {
      for (const { id } of old) this.#stack.remove(id);
      this.#showGiven(true);
    });
    this.show(kept);
  }
}
