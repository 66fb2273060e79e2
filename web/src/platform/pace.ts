const kLongest = 20; // milliseconds: more, and whoever drags something feels it

/** The pace of work on the main thread: what takes long rests now and then, so that the page answers and draws. */
export class Pace {
  #since = performance.now();

  /** Lets the page go on if it has waited long enough for this; call it often. Cost: nothing worth counting, if it has not. */
  async rest(): Promise<void> {
    if (performance.now() - this.#since < kLongest) return;
    await new Promise((done) => setTimeout(done));
    this.#since = performance.now();
  }
}
