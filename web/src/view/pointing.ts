import type { Spot } from './pick';

/** A tool for the pointer on the model. `spot` is the spot of the target under the pointer. */
export interface Tool {
  /** A pointer is pressed. Return true to capture it until `up`; otherwise it turns the model, and may become a `tap`. */
  down?(spot: Spot | undefined, event: PointerEvent): boolean;
  /** The captured pointer moved. */
  move?(spot: Spot | undefined, event: PointerEvent): void;
  /** The captured pointer was released or lost. */
  up?(event: PointerEvent): void;
  /** Discard what was begun: a second finger came down, to turn the model. */
  cancel?(): void;
  /** A pointer that was not captured came down and up at the same position. */
  tap?(spot: Spot | undefined, event: PointerEvent): void;
  /** A mouse or pen moves with nothing pressed, or leaves the view; at most once per frame. */
  hover?(spot: Spot | undefined, event: PointerEvent): void;
}

const kTapMove = 6; // pixels that a finger may move during a tap

/** Passes pointers on the canvas to the tool. Pointers it does not capture, and two fingers, turn the model. */
export class Pointing {
  tool: Tool | undefined;
  /** What taps are for while no tool is chosen. */
  idle: Pick<Tool, 'tap'> | undefined;
  readonly #pick: (x: number, y: number) => Spot | undefined;
  readonly #setTurning: (turns: boolean) => void;
  #captured: { id: number; tool: Tool } | undefined;
  #pressed: { id: number; x: number; y: number } | undefined;
  /** The fingers on the canvas. */
  readonly #fingers = new Set<number>();
  #hovering = 0;

  /**
   * @param pick       Finds the spot at `clientX`, `clientY`.
   * @param setTurning Receives whether the pressed pointer turns the model.
   */
  constructor(
    canvas: HTMLCanvasElement,
    pick: (x: number, y: number) => Spot | undefined,
    setTurning: (turns: boolean) => void,
  ) {
    this.#pick = pick;
    this.#setTurning = setTurning;
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
        // Discard what the first finger began.
        this.#captured?.tool.cancel?.();
        this.#captured = this.#pressed = undefined;
        return;
      }
    }
    if (this.#captured) return;
    this.#setTurning(true);
    if (!(this.tool ?? this.idle) || event.button !== 0) return;
    if (this.tool?.down?.(this.#spot(event), event)) {
      this.#captured = { id: event.pointerId, tool: this.tool };
      canvas.setPointerCapture(event.pointerId);
      // The controls still see this pointer, as a second finger may join to turn the model.
      this.#setTurning(false);
    } else {
      this.#pressed = { id: event.pointerId, x: event.clientX, y: event.clientY };
    }
  }

  #move(event: PointerEvent): void {
    if (this.#captured?.id === event.pointerId) this.#captured.tool.move?.(this.#spot(event), event);
    else if (event.buttons === 0 && event.pointerType !== 'touch') this.#hover(event, true);
  }

  #up(event: PointerEvent): void {
    this.#fingers.delete(event.pointerId);
    if (this.#captured?.id === event.pointerId) {
      this.#captured.tool.up?.(event);
      this.#captured = undefined;
    } else if (this.#pressed?.id === event.pointerId) {
      const { x, y } = this.#pressed;
      this.#pressed = undefined;
      const tapped = Math.hypot(event.clientX - x, event.clientY - y) <= kTapMove;
      if (tapped && event.type === 'pointerup') (this.tool ?? this.idle)?.tap?.(this.#spot(event), event);
    }
  }

  #hover(event: PointerEvent, over: boolean): void {
    if (!this.tool?.hover) return;
    cancelAnimationFrame(this.#hovering);
    this.#hovering = requestAnimationFrame(() => this.tool?.hover?.(over ? this.#spot(event) : undefined, event));
  }
}
