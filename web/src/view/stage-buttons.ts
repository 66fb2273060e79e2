import type { History } from '#three';
import { element } from '../platform/page';
import type { Side } from './camera-controls';
import type { Viewer } from './viewer';

/** Connects the buttons on the stage: the camera, and colour, size, undo and redo beside the rail while one paints. */
export function setUpStageButtons(viewer: Viewer | undefined, history: History): void {
  for (const button of element('angles', HTMLElement).querySelectorAll('button'))
    button.addEventListener('click', () => {
      const side = button.dataset.side as Side | 'face';
      if (side === 'face') void viewer?.showFace();
      else viewer?.controls.lookFromSide(side);
    });
  element('set-front', HTMLButtonElement).addEventListener('click', () => viewer?.controls.takeFront());

  // The panel has the same controls; these pass on what is done to them.
  for (const name of ['color', 'size']) {
    const [quick, field] = [element(`quick-${name}`, HTMLInputElement), element(`brush-${name}`, HTMLInputElement)];
    const copy = (from: HTMLInputElement, to: HTMLInputElement): void => {
      if (from.value === to.value) return;
      to.value = from.value;
      to.dispatchEvent(new Event('input', { bubbles: true }));
    };
    quick.addEventListener('input', () => copy(quick, field));
    field.addEventListener('input', () => copy(field, quick));
    copy(field, quick); // browsers keep the state of fields on reload
  }
  for (const name of ['undo', 'redo'] as const) {
    const [quick, button] = [element(`quick-${name}`, HTMLButtonElement), element(name, HTMLButtonElement)];
    quick.addEventListener('click', () => button.click());
    history.on('change', () => (quick.disabled = button.disabled));
  }
  const options = element('tool-options', HTMLElement);
  const follow = (): void => {
    element('quick-paint', HTMLElement).hidden = options.hidden;
    const { hidden } = element('brush-color', HTMLElement).closest<HTMLElement>('[data-for]')!;
    for (const id of ['quick-color', 'quick-pick']) element(id, HTMLElement).hidden = hidden;
    element('quick-size', HTMLElement).hidden = element('brush-size', HTMLElement).closest('label')!.hidden;
  };
  new MutationObserver(follow).observe(options, { attributeFilter: ['hidden'], subtree: true });
}
