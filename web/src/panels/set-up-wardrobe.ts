import { element, showError } from '../platform/page';
import { modelsAmong } from '../state/intake';
import { kAlone, type WardrobeOfPage } from '../state/wardrobe/kept';
import type { WardrobePage, WardrobeRow } from './wardrobe-row';

const kSeveral = 3; // models that cannot be a target and its cage

/** The wardrobe, which loads when it is opened. */
export function setUpWardrobe(page: Omit<WardrobePage, 'onChange'>): WardrobeOfPage {
  const button = element('open-wardrobe', HTMLButtonElement);
  const strip = element('wardrobe', HTMLElement);
  let loaded: Promise<WardrobeRow> | undefined;
  let opened: WardrobeRow | undefined;
  /** What is to be brought back, until it is loaded. */
  let kept = kAlone;
  const open = async (): Promise<WardrobeRow> => {
    strip.hidden = false;
    button.ariaExpanded = 'true';
    const onChange = (): void => wardrobe.onChange();
    loaded ??= import('./wardrobe-row').then(({ WardrobeRow }) => (opened = new WardrobeRow({ ...page, onChange })));
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
    take(files, isAsked = false) {
      const wasOpen = !strip.hidden;
      const { length } = modelsAmong(files).targets;
      if (length < (wasOpen || isAsked ? 1 : kSeveral)) return false;
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
