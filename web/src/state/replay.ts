import { Emitter } from '#three';

/** A listener, and what it listens to. */
interface Heard<Events> {
  name: keyof Events;
  listener: (event: never) => void;
}

/** Events that features hear of which come after them, too. */
export class Replay<Events> extends Emitter<Events> {
  /** The last event of each name since the last one that begins anew, in order. */
  readonly #last = new Map<keyof Events, unknown>();
  #late: Heard<Events>[] | undefined;
  readonly #first: keyof Events;

  /** @param first The event that makes all before it outdated. */
  constructor(first: keyof Events) {
    super();
    this.#first = first;
  }

  override on<Name extends keyof Events>(name: Name, listener: (event: Events[Name]) => void): () => void {
    this.#late?.push({ name, listener });
    return super.on(name, listener);
  }

  /** Lets features begin that come late: whoever listens from `begin` on hears at once what there is. */
  joinLate<Result>(begin: () => Result): Result {
    const late: Heard<Events>[] = [];
    this.#late = late;
    const result = begin();
    this.#late = undefined;
    for (const [name, event] of [...this.#last])
      for (const heard of late) if (heard.name === name) heard.listener(event as never);
    return result;
  }

  protected override emit<Name extends keyof Events>(name: Name, event: Events[Name]): boolean {
    if (name === this.#first) this.#last.clear();
    this.#last.delete(name);
    this.#last.set(name, event);
    return super.emit(name, event);
  }
}
