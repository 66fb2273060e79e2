import type { StickerFrame as Frame } from '#three';
import { element } from '../../platform/page';
import type { Viewer } from '../../view/viewer';

interface Actions {
  begin(): void;
  /** @param angle Radians, clockwise. @param scale Of the size; both since the last call. */
  turn(angle: number, scale: number): void;
  end(): void;
  mirror(): void;
  duplicate(): void;
  /** Copies it to the other side of the cage. */
  across(): void;
  remove(): void;
  done(): void;
}

const kGap = 12; // pixels between the sticker and its bar
const kBar = `<button type="button" name="mirror">Mirror</button>
<button type="button" name="duplicate">Duplicate</button>
<button type="button" name="across">Other side</button>
<button type="button" name="remove">Remove</button>
<button type="button" name="done">Done</button>`;

/** The outline of the chosen sticker on the stage, a handle that turns and scales it, and buttons for the rest. */
export class StickerFrame {
  readonly #viewer: Viewer;
  readonly #actions: Actions;
  readonly #outline = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  readonly #handle = document.createElement('div');
  readonly #bar = document.createElement('div');
  #frame: (() => Frame | undefined) | undefined;
  #center = { x: 0, y: 0 };

  constructor(viewer: Viewer, actions: Actions) {
    this.#viewer = viewer;
    this.#actions = actions;
    this.#outline.setAttribute('class', 'sticker-outline');
    this.#outline.setAttribute('aria-hidden', 'true');
    this.#outline.innerHTML = '<polygon/>';
    this.#handle.className = 'sticker-handle';
    this.#handle.title = 'Turn and scale';
    this.#bar.className = 'sticker-bar';
    this.#bar.setAttribute('role', 'group');
    this.#bar.ariaLabel = 'Chosen sticker';
    this.#bar.innerHTML = kBar;
    for (const button of this.#bar.querySelectorAll('button'))
      button.addEventListener('click', actions[button.name as 'mirror' | 'duplicate' | 'across' | 'remove' | 'done']);
    element('stage', HTMLElement).append(this.#outline, this.#handle, this.#bar);
    this.#listen();
    this.show(undefined);
    viewer.beforeDraw(() => this.#follow());
  }

  /** @param frame Where the sticker is; undefined hides all. */
  show(frame: (() => Frame | undefined) | undefined): void {
    this.#frame = frame;
    this.#bar.hidden = frame === undefined;
    this.#follow();
    this.#viewer.redraw();
  }

  /** Puts it where the sticker is seen now. */
  #follow(): void {
    const frame = this.#frame?.();
    const isSeen = frame !== undefined && this.#viewer.screen.faces(frame.center.point, frame.center.normal);
    this.#outline.style.display = this.#handle.style.display = isSeen ? '' : 'none';
    if (!isSeen) return;
    const { left, top } = this.#handle.parentElement!.getBoundingClientRect();
    const [center, ...corners] = cornersOf(frame).map((point) => {
      const { x, y } = this.#viewer.screen.project(point);
      return { x: x - left, y: y - top };
    });
    this.#outline.firstElementChild!.setAttribute('points', corners.map(({ x, y }) => `${x},${y}`).join(' '));
    this.#center = center!;
    const corner = corners[2]!;
    this.#handle.style.translate = `${corner.x}px ${corner.y}px`;
    this.#placeBar(Math.max(...corners.map(({ y }) => y)));
  }

  /** Puts the bar below the sticker, between the controls of the stage. */
  #placeBar(below: number): void {
    const { width, height, top, bottom, side } = this.#viewer.controls.free;
    const { offsetWidth, offsetHeight, style } = this.#bar;
    const within = (place: number, least: number, most: number): string =>
      `${Math.max(least, Math.min(place, most))}px`;
    style.left = within(this.#center.x - offsetWidth / 2, side, width - side - offsetWidth);
    style.top = within(below + kGap, top + kGap, height - bottom - offsetHeight - kGap);
  }

  #listen(): void {
    let from: { x: number; y: number } | undefined;
    let center = { x: 0, y: 0 };
    const handle = this.#handle;
    const fromCenter = ({ clientX, clientY }: PointerEvent): { x: number; y: number } => {
      const { left, top } = handle.parentElement!.getBoundingClientRect();
      return { x: clientX - left - center.x, y: clientY - top - center.y };
    };
    handle.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      center = this.#center;
      from = fromCenter(event);
      handle.setPointerCapture(event.pointerId);
      this.#actions.begin();
    });
    handle.addEventListener('pointermove', (event) => {
      if (!from) return;
      const to = fromCenter(event);
      const angle = Math.atan2(to.y, to.x) - Math.atan2(from.y, from.x);
      this.#actions.turn(angle, Math.hypot(to.x, to.y) / Math.max(1, Math.hypot(from.x, from.y)));
      from = to;
    });
    for (const end of ['pointerup', 'pointercancel'] as const)
      handle.addEventListener(end, () => {
        if (!from) return;
        from = undefined;
        this.#actions.end();
      });
  }
}

/** The middle, and the corners around it from the upper left one. */
function cornersOf({ center: { point }, right, up }: Frame) {
  const corner = (x: number, y: number) => point.clone().addScaledVector(right, x).addScaledVector(up, y);
  return [point, corner(-1, 1), corner(1, 1), corner(1, -1), corner(-1, -1)];
}
