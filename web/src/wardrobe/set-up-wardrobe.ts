import type { LayerStack } from 'cagecast/three/layers';
import type { Texture } from 'three';
import { element, showError } from '../platform/page';
import { modelsAmong } from '../scene/files';
import type { Sample } from '../scene/samples';
import type { Session } from '../scene/session';
import type { Viewer } from '../view/viewer';
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
}

/** The wardrobe, which loads when it is opened. @returns What adds dropped files to it, and false if they are not for it. */
export function setUpWardrobe(surroundings: Surroundings): (files: readonly File[]) => boolean {
  const button = element('open-wardrobe', HTMLButtonElement);
  const strip = element('wardrobe', HTMLElement);
  let loaded: Promise<WardrobeStrip> | undefined;
  const open = async (): Promise<WardrobeStrip> => {
    strip.hidden = false;
    button.ariaExpanded = 'true';
    loaded ??= import('./wardrobe-strip').then(({ WardrobeStrip }) => new WardrobeStrip(surroundings));
    return loaded;
  };
  const failed = (error: Error): void => showError(error.message);
  button.addEventListener('click', () => {
    if (strip.hidden) return void open().then((opened) => opened.focus(), failed);
    strip.hidden = true;
    button.ariaExpanded = 'false';
    loaded?.then((opened) => opened.close(), failed);
  });
  return (files) => {
    const wasOpen = !strip.hidden;
    const { length } = modelsAmong(files).targets;
    if (length < (wasOpen ? 1 : kSeveral)) return false;
    open().then((opened) => opened.add(files, !wasOpen), failed);
    return true;
  };
}
