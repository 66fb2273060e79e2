import { type Edits, type Layer, type LayerStack, maxLayers, type Sheet } from 'cagecast/three/paint';
import { element, showError } from '../platform/page';
import type { Model } from './load-model';
import { haveSameUvs } from './same-uvs';
import type { Session } from './session';

/** Layers that were painted for other cages. */
export interface PutAway {
  readonly layers: readonly Layer[];
  /** Offers others instead. */
  show(layers: readonly Layer[]): void;
}

/**
 * Puts the layers away that were painted for another cage, and offers them again until they are brought back: those for the
 * current cage, or else all. They stay where a cage has the same UVs.
 */
export function putAwayLayers(session: Session, stack: LayerStack, edits: Edits): PutAway {
  const offer = element('put-away', HTMLElement);
  let last: Model | undefined;
  let away: readonly Layer[] = [];
  /** The mesh of the cage that each layer was painted for; not known of those from before the page was opened. */
  const meshes = new WeakMap<Sheet, Model['mesh']>();
  // Undoing brings them back too, and redoing puts them away again.
  const offered = (): Layer[] => away.filter(({ id }) => stack.layers.every((layer) => layer.id !== id));
  const write = (): void => {
    const { length } = offered();
    offer.hidden = length === 0;
    const count = length === 1 ? 'One layer of an earlier cage' : `${length} layers of earlier cages`;
    offer.querySelector('p')!.textContent = `${count} put away.`;
  };
  const show = (layers: readonly Layer[]): void => {
    away = layers;
    write();
  };
  const restyleChecker = (visible: boolean): void => {
    const { base } = stack;
    if (base?.sheet === session.checker) stack.restyle(base, { visible });
  };
  session.on('transfer', ({ cage }) => {
    const before = last;
    last = cage;
    if (!before || haveSameUvs(before, cage)) return;
    edits.cancel(); // a stroke in progress is of the cage before
    const old = stack.layers.filter(({ id }) => id !== stack.base?.id);
    // Nothing else is to be seen now.
    if (old.length === 0) return restyleChecker(true);
    for (const { sheet } of old) meshes.set(sheet, before.mesh);
    const kept = [...offered(), ...old].slice(-maxLayers);
    edits.do('putting layers away', () => {
      for (const { id } of old) stack.remove(id);
      restyleChecker(true);
    });
    show(kept);
  });
  stack.on('change', write);
  element('bring-back', HTMLButtonElement).addEventListener('click', () => {
    const all = offered();
    const own = all.filter(({ sheet }) => {
      const mesh = meshes.get(sheet);
      return mesh && haveSameUvs({ mesh }, last!);
    });
    // As many as there is room for; without any, the stack says so.
    const some = (own.length > 0 ? own : all).slice(0, Math.max(1, maxLayers - stack.layers.length));
    try {
      edits.do('bringing layers back', () => {
        stack.change([], some);
        restyleChecker(false);
      });
      show(offered());
    } catch (error) {
      showError((error as Error).message);
    }
  });
  return {
    get layers() {
      return offered();
    },
    show,
  };
}
