import type { Spot } from './pick';

/** What takes the pointer on the model in place of turning it. `spot` is what of the target is under it. */
export interface Tool {
  /** A pointer is pressed. True takes it until `up`; otherwise it turns the model, and may still be a `tap`. */
  down?(spot: Spot | undefined, event: PointerEvent): boolean;
  /** The pointer that was taken has moved. */
  move?(spot: Spot | undefined, event: PointerEvent): void;
  /** The pointer that was taken is released, or lost. */
  up?(event: PointerEvent): void;
  /** What was begun is not meant: a second finger came, which turns the model. */
  cancel?(): void;
  /** A pointer that was not taken came down and up at the same place. */
  tap?(spot: Spot | undefined, event: PointerEvent): void;
  /** A mouse or pen moves over the picture with nothing pressed, or leaves it; at most once a frame. */
  hover?(spot: Spot | undefined, event: PointerEvent): void;
}

const kStill = 6; // pixels that a finger may move and still have tapped

/** Gives a tool the pointers on a canvas. What the tool does not take, and two fingers, turn the model. */
export class Pointing {
  tool: Tool | undefined;
  readonly #pick: (x: number, y: number) => Spot | undefined;
  readonly #leave: (turns: boolean) => void;
  #taken: { id: number; tool: Tool } | undefined;
  #pressed: { id: number; x: number; y: number } | undefined;
  /** The fingers on the canvas. */
  readonly #fingers = new Set<number>();
  #hovering = 0;

  /**
   * @param pick  Finds what of the target is at `clientX`, `clientY`.
   * @param leave Called with whether the pointer that goes down is to turn the model.
   */
  constructor(
    canvas: HTMLCanvasElement,
    pick: (x: number, y: number) => Spot | undefined,
    leave: (turns: boolean) => void,
  ) {
    this.#pick = pick;
    this.#leave = leave;
    canvas.addEventListener('pointerdown', (event) => this.#down(canvas, event));
    canvas.addEventListener('pointermove', (event) => this.#move(event));
    canvas.addEventListener('pointerleave', (event) => this.#hover(event, false));
    for (const end of ['pointerup', 'pointercancel'] as const) canvas.addEventListener(end, (event) => this.#up(event));
  }

  #spot({ clientX, clientY }: PointerEvent): Spot | undefined {
    return this.#pick(clientX, clientY);
  }

  #down(canvas: HTMLCanvasElement, event: PointerEvent): void {
    if (event.pointerType === 'touch') {
      this.#fingers.add(event.pointerId);
      if (this.#fingers.size > 1) {
        // What the first has begun, or may have tapped, is not meant.
        this.#taken?.tool.cancel?.();
        this.#taken = this.#pressed = undefined;
        return;
      }
    }
    if (this.#taken) return;
    this.#leave(true);
    if (!this.tool || event.button !== 0) return;
    if (this.tool.down?.(this.#spot(event), event)) {
      this.#taken = { id: event.pointerId, tool: this.tool };
      canvas.setPointerCapture(event.pointerId);
      // Who turns the model still hears of it: with a second finger both are theirs.
      this.#leave(false);
    } else {
      this.#pressed = { id: event.pointerId, x: event.clientX, y: event.clientY };
    }
  }

  #move(event: PointerEvent): void {
    if (this.#taken?.id === event.pointerId) this.#taken.tool.move?.(this.#spot(event), event);
    else if (event.buttons === 0 && event.pointerType !== 'touch') this.#hover(event, true);
  }

  #up(event: PointerEvent): void {
    this.#fingers.delete(event.pointerId);
    if (this.#taken?.id === event.pointerId) {
      this.#taken.tool.up?.(event);
      this.#taken = undefined;
    } else if (this.#pressed?.id === event.pointerId) {
      const { x, y } = this.#pressed;
      this.#pressed = undefined;
      const still = Math.hypot(event.clientX - x, event.clientY - y) <= kStill;
      if (still && event.type === 'pointerup') this.tool?.tap?.(this.#spot(event), event);
    }
  }

  #hover(event: PointerEvent, over: boolean): void {
    if (!this.tool?.hover) return;
    cancelAnimationFrame(this.#hovering);
    this.#hovering = requestAnimationFrame(() => this.tool?.hover?.(over ? this.#spot(event) : undefined, event));
  }
}
