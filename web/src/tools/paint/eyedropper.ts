import { type Composite, readStraight } from '#three';
import { announce, element } from '../../platform/page';
import type { Spot } from '../../view/pick';
import type { Viewer } from '../../view/viewer';
import type { PaintTool } from './keys';
import type { PaintOptions } from './paint-options';
import type { Painter } from './painter';

/** Takes the colour of the paint on the model: by its button or key for one click, or while Alt is held. */
export class Eyedropper {
  readonly #buttons = [element('pick-color', HTMLButtonElement), element('quick-pick', HTMLButtonElement)];
  #on = false;

  constructor(
    private readonly painter: Painter,
    private readonly viewer: Viewer,
    private readonly composite: Composite,
    private readonly options: PaintOptions,
  ) {
    for (const button of this.#buttons) button.addEventListener('click', () => this.set(!this.#on));
    this.set(false);
  }

  get on(): boolean {
    return this.#on;
  }

  /** Whether the next click takes a colour. */
  set(on: boolean): void {
    this.#on = on;
    for (const button of this.#buttons) button.ariaPressed = String(on);
    element('stage', HTMLElement).classList.toggle('picking', on);
    if (on) announce('Click on the model to take its colour.');
  }

  /** A tool that leaves one click to the eyedropper when that is on. */
  before(tool: PaintTool): PaintTool {
    let taken = false;
    return {
      down: (spot, event) => {
        taken = this.#on || event.altKey === true;
        if (taken) this.#take(spot);
        // Without `down` a tool waits for the tap.
        return taken || (tool.down?.(spot, event) ?? false);
      },
      move: (spot, event) => {
        if (!taken) tool.move?.(spot, event);
      },
      go: (spot, at) => {
        if (!taken) tool.go?.(spot, at);
      },
      up: () => {
        if (!taken) tool.up?.();
        taken = false;
      },
      cancel: () => tool.cancel?.(),
      tap: (spot) => tool.tap?.(spot),
      hover: (spot, event) => tool.hover?.(this.#on ? undefined : spot, event),
    };
  }

  #take(spot: Spot | undefined): void {
    this.set(false);
    const uv = this.painter.aimOf(spot)?.surface?.uv;
    const color = uv && this.#colorAt(uv.x, uv.y);
    if (color) this.options.setColor(color);
    announce(color ? `The colour is ${color} now.` : 'No paint there.');
  }

  #colorAt(u: number, v: number): string | undefined {
    const { size, texture } = this.composite;
    this.composite.update(this.viewer.renderer);
    const { data } = readStraight(this.viewer.renderer, texture, size);
    const at = 4 * (Math.floor(v * size) * size + Math.floor(u * size));
    if (data[at + 3] === 0) return undefined;
    return `#${[...data.subarray(at, at + 3)].map((value) => value.toString(16).padStart(2, '0')).join('')}`;
  }
}
