import type { AnimationClip } from 'three';
import { element } from '../../platform/page';
import type { Stage } from '../../view/stage';

/** Plays a model's animations. The first starts by itself, unless the user prefers reduced motion. */
export class Animations {
  readonly #stage: Stage;
  readonly #select = element('animation', HTMLSelectElement);
  #clips: readonly AnimationClip[] = [];

  /** @param onPlay Called before the user starts one. */
  constructor(stage: Stage, onPlay: () => void) {
    this.#stage = stage;
    this.#select.addEventListener('change', () => {
      if (this.playing) onPlay();
      this.#play();
    });
  }

  get playing(): boolean {
    return Number(this.#select.value) >= 0;
  }

  /** Lists the animations of another model. */
  offer(clips: readonly AnimationClip[]): void {
    this.#clips = clips;
    element('animation-field', HTMLElement).hidden = clips.length === 0;
    const names = clips.map(({ name }, index) => new Option(name || `Animation ${index + 1}`, String(index)));
    this.#select.replaceChildren(new Option('None', '-1'), ...names);
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.#select.value = clips.length > 0 && !still ? '0' : '-1';
    this.#play();
  }

  /** Returns the model to its rest pose. */
  stop(): void {
    if (!this.playing) return;
    this.#select.value = '-1';
    this.#play();
  }

  #play(): void {
    this.#stage.play(this.#clips[Number(this.#select.value)]);
  }
}
