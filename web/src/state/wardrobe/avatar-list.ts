import { Emitter } from '#three';
import type { Avatar } from './avatar';

/** The avatars of the wardrobe, and what is to be done with them, one after the other. */
export class AvatarList extends Emitter<{ change: undefined }> {
  readonly #addError: (message: string) => void;
  #ids = 0;
  #work: Promise<void> = Promise.resolve();
  /** The one on the stage. */
  active = this.make('');
  /** All in their order. Call `change` after changing it. */
  readonly all = [this.active];

  /** @param addError Called with what went wrong. */
  constructor(addError: (message: string) => void) {
    super();
    this.#addError = addError;
  }

  /** A new avatar, which is not in the list. @param doing What is being done to it, for people. */
  make(doing: string): Avatar {
    return {
      id: ++this.#ids,
      name: '',
      sample: undefined,
      files: [],
      cage: undefined,
      follows: false,
      locks: {},
      verdict: '',
      takesPaint: false,
      own: undefined,
      doing,
      kept: undefined,
      standing: undefined,
    };
  }

  has(avatar: Avatar): boolean {
    return this.all.includes(avatar);
  }

  /** Resolves when all is done that was asked for so far. */
  get done(): Promise<void> {
    return this.#work;
  }

  /** Does something once all that was asked for before is done, if the avatar is still here then. */
  queue(avatar: Avatar, work: () => Promise<void>): void {
    this.#work = this.#work.then(async () => {
      if (!this.has(avatar)) return;
      try {
        await work();
      } catch (error) {
        if (this.has(avatar)) this.#addError((error as Error).message);
      } finally {
        this.update(avatar, { doing: '' });
      }
    });
  }

  /** Changes what is known of an avatar. */
  update(avatar: Avatar, change: Partial<Avatar>): void {
    Object.assign(avatar, change);
    this.change();
  }

  change(): void {
    this.emit('change', undefined);
  }
}
