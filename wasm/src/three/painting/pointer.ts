/** What is done with a pointer from when it goes down until it goes up. */
export interface Drag {
  move(event: PointerEvent): void;
  end(): void;
  cancel(): void;
}

/** For each element how many listen to it, and its `touch-action` before the first of them. */
const listening = new WeakMap<HTMLElement, { count: number; touchAction: string }>();

/** That the pointer of an event comes down where that was. */
function downAt(event: PointerEvent): PointerEvent {
  const { pointerId, pointerType, isPrimary, clientX, clientY, view } = event;
  const which = { pointerId, pointerType, isPrimary, buttons: 1 };
  return new PointerEvent('pointerdown', { ...which, clientX, clientY, view, bubbles: true, cancelable: true });
}

/**
 * Passes the pointers on an element to what `begin` makes of them.
 * @param begin  Undefined leaves the pointer to others.
 * @returns a function that ends it; the element has its `touch-action` again once none listens.
 */
export function listenTo(element: HTMLElement, begin: (event: PointerEvent) => Drag | undefined): () => void {
  let drag: Drag | undefined;
  /** What the pointer that paints last was. */
  let last: PointerEvent | undefined;
  let passesOn = false;

  const finish = (how: 'end' | 'cancel'): void => {
    const done = drag;
    drag = undefined;
    done?.[how]();
  };
  const down = (event: PointerEvent): void => {
    if (passesOn) return;
    if (drag && event.pointerType === 'touch') {
      if (last!.pointerType === 'touch') {
        // Another finger: most likely the two shall turn or zoom the model. Those who turn it have not seen the first one: it comes
        // down for them where it is now.
        finish('cancel');
        passesOn = true;
        element.dispatchEvent(downAt(last!));
        passesOn = false;
      } else event.stopImmediatePropagation(); // A hand on the screen does not disturb a pen or a mouse.
      return;
    }
    // The second of two fingers does what the first one does.
    if (event.button !== 0 || !event.isPrimary) return;
    finish('cancel');
    drag = begin(event);
    if (!drag) return;
    last = event;
    event.stopImmediatePropagation();
    element.setPointerCapture(event.pointerId);
  };
  const move = (event: PointerEvent): void => {
    if (!drag || event.pointerId !== last!.pointerId) return;
    last = event;
    drag.move(event);
  };
  const up = (event: PointerEvent): void => {
    if (event.pointerId === last?.pointerId) finish(event.type === 'pointerup' ? 'end' : 'cancel');
  };

  const listeners = { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up };
  const entries = Object.entries(listeners) as [keyof typeof listeners, (event: PointerEvent) => void][];
  // First of all, so that others do not see what paints.
  const ended = new AbortController();
  const { signal } = ended;
  for (const [type, listener] of entries) element.addEventListener(type, listener, { capture: true, signal });
  const { style } = element;
  const shared = listening.get(element) ?? { count: 0, touchAction: style.touchAction };
  listening.set(element, shared);
  ++shared.count;
  style.touchAction = 'none';
  return () => {
    if (signal.aborted) return;
    ended.abort();
    finish('cancel');
    if (--shared.count > 0) return;
    listening.delete(element);
    style.touchAction = shared.touchAction;
  };
}
