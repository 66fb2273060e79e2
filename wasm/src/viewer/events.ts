import type { Check } from './check.js';

/** The events of `<cagecast-viewer>`. */
export interface ViewerEvents {
  /** How far the loading is: a share from 0 to 1, and what it does. */
  progress: CustomEvent<{ share: number; stage: string }>;
  /** The model is shown. */
  load: CustomEvent<undefined>;
  /** Whether the cage fits, with the attribute `check`. */
  verdict: CustomEvent<Check>;
  /** What cannot be loaded or shown; the element shows it, too. */
  error: CustomEvent<Error>;
}

/** `addEventListener`, or `removeEventListener`, with the types of these events before those of other elements. */
export interface Listening<Options> {
  <Type extends keyof ViewerEvents>(
    type: Type,
    listener: (this: ViewerElement, event: ViewerEvents[Type]) => unknown,
    options?: boolean | Options,
  ): void;
  <Type extends keyof HTMLElementEventMap>(
    type: Type,
    listener: (this: HTMLElement, event: HTMLElementEventMap[Type]) => unknown,
    options?: boolean | Options,
  ): void;
  (type: string, listener: EventListenerOrEventListenerObject, options?: boolean | Options): void;
}

/** An element of the page that has these events. */
export interface ViewerElement extends Omit<HTMLElement, 'addEventListener' | 'removeEventListener'> {
  addEventListener: Listening<AddEventListenerOptions>;
  removeEventListener: Listening<EventListenerOptions>;
}
