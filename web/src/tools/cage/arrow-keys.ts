const kSteps: Record<string, readonly [number, number]> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** The step of an arrow key on the screen, which then does nothing else; undefined for other keys. */
export function arrowStep(event: KeyboardEvent): readonly [number, number] | undefined {
  const step = kSteps[event.key];
  if (!step || event.ctrlKey || event.metaKey || event.altKey) return undefined;
  event.preventDefault();
  return step;
}
