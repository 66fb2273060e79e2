const kLongest = 20; // milliseconds: longer tasks make dragging feel slow

/** Divides long work on the main thread into short tasks, so that the page stays responsive. */
export class Pace {
  #since = performance.now();

  /** Yields to the page if the current task has run long enough. Cheap: call it often. */
  async rest(): Promise<void> {
    if (performance.now() - this.#since < kLongest) return;
    await new Promise((done) => setTimeout(done));
    this.#since = performance.now();
  }
}
