import type { LayerStack } from 'cagecast/three/paint';
import type { Texture } from 'three';
import { element, showError } from '../platform/page';
import { modelsAmong } from '../scene/files';
import type { Sample } from '../scene/samples';
import type { Session } from '../scene/session';
import type { Viewer } from '../view/viewer';
import { type KeptWardrobe, kAlone } from './kept';
import type { WardrobeStrip } from './wardrobe-strip';

const kSeveral = 3; // models that cannot be a target and its cage

/** What the wardrobe needs of the page. */
export interface Surroundings {
  session: Session;
  viewer: Viewer;
  stack: LayerStack;
  /** The composite of the layers. */
  paint: Texture;
  /** Encodes it. */
  png(): Promise<Blob>;
  samples(): readonly Sample[];
  /** Told when the wardrobe may have changed. */
  onChange(): void;
}

/** The wardrobe, as the rest of the page sees it. */
export interface WardrobeOfPage {
  /** Adds dropped files. @returns False if they are not for it. */
  take(files: readonly File[]): boolean;
  /** What a project has of it. */
  readonly kept: KeptWardrobe;
  restore(kept: KeptWardrobe): void;
  /** Called when it may have changed. */
  onChange: () => void;
}

/** The wardrobe, which loads when it is opened. */
export function setUpWardrobe(surroundings: Omit<Surroundings, 'onChange'>): WardrobeOfPage {
  const button = element('open-wardrobe', HTMLButtonElement);
  const strip = element('wardrobe', HTMLElement);
  let loaded: Promise<WardrobeStrip> | undefined;
  let opened: WardrobeStrip | undefined;
  /** What is to be brought back, until it is loaded. */
  let kept = kAlone;
  const open = async (): Promise<WardrobeStrip> => {
    strip.hidden = false;
    button.ariaExpanded = 'true';
    const onChange = (): void => wardrobe.onChange();
    loaded ??= import('./wardrobe-strip').then(
      ({ WardrobeStrip }) => (opened = new WardrobeStrip({ ...surroundings, onChange })),
    );
    return loaded;
  };
  const failed = (error: Error): void => showError(error.message);
  button.addEventListener('click', () => {
    if (strip.hidden) return void open().then((opened) => opened.focus(), failed);
    strip.hidden = true;
    button.ariaExpanded = 'false';
    loaded?.then((opened) => opened.close(), failed);
  });
  const wardrobe: WardrobeOfPage = {
    take(files) {
      const wasOpen = !strip.hidden;
      const { length } = modelsAmong(files).targets;
      if (length < (wasOpen ? 1 : kSeveral)) return false;
      open().then((opened) => opened.add(files, !wasOpen), failed);
      return true;
    },
    get kept() {
      return opened?.kept ?? kept;
    },
    restore(from) {
      kept = from;
      if (from.avatars.length > 0) open().then((opened) => opened.restore(from), failed);
      else opened?.restore(from);
    },
    onChange() {},
  };
  return wardrobe;
}
