import { element } from '../platform/page';

const kStep = 0.05;

/**
 * The divider of the view “Compare”: dragged, or moved with the arrow keys.
 * @param onMove Receives its position, 0 at the left edge and 1 at the right.
 */
export function setUpDivider(onMove: (split: number) => void): { show(visible: boolean, split: number): void } {
  const divider = element('divider', HTMLElement);
  const stage = divider.parentElement!;
  const [left, right] = ['.side-left', '.side-right'].map((side) => [...stage.querySelectorAll<HTMLElement>(side)]);
  let split = 0.5;

  function moveTo(place: number): void {
    put(Math.min(1, Math.max(0, place)));
    onMove(split);
  }

  function put(place: number): void {
    split = place;
    divider.style.left = `${100 * split}%`;
    const percent = Math.round(100 * split);
    divider.ariaValueNow = String(percent);
    divider.ariaValueText = `${percent} % left, ${100 - percent} % right`;
    for (const label of left!) label.classList.toggle('gone', split < 0.12);
    for (const label of right!) label.classList.toggle('gone', split > 0.88);
  }

  divider.addEventListener('pointerdown', (event) => {
    event.preventDefault();
    divider.focus({ preventScroll: true });
    divider.setPointerCapture(event.pointerId);
  });
  divider.addEventListener('pointermove', (event) => {
    if (!divider.hasPointerCapture(event.pointerId)) return;
    const { left, width } = stage.getBoundingClientRect();
    moveTo((event.clientX - left) / width);
  });
  divider.addEventListener('keydown', (event) => {
    const places: Record<string, number> = {
      ArrowLeft: split - kStep,
      ArrowDown: split - kStep,
      ArrowRight: split + kStep,
      ArrowUp: split + kStep,
      PageDown: split - 4 * kStep,
      PageUp: split + 4 * kStep,
      Home: 0,
      End: 1,
    };
    const place = places[event.key];
    if (place === undefined) return;
    event.preventDefault();
    moveTo(place);
  });
  moveTo(split);

  return {
    show(visible, split) {
      put(split);
      for (const part of [divider, ...left!, ...right!]) part.hidden = !visible;
    },
  };
}
