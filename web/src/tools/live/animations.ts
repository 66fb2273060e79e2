import type { AnimationClip } from 'three';
import { element } from '../../platform/page';
import type { Stage } from '../../view/stage';

const movesMorphs = ({ tracks }: AnimationClip): boolean =>
  tracks.some(({ name }) => name.endsWith('.morphTargetInfluences'));

function optionOf(name: string, index: number): HTMLOptionElement {
  const option = new Option(name || `Animation ${index + 1}`, String(index));
  option.translate = name === '';
  return option;
}

/** A bar on the stage that plays a model's animations. The first starts by itself, unless the user prefers reduced motion. */
export class Animations {
  readonly #stage: Stage;
  readonly #select = element('animation', HTMLSelectElement);
  readonly #button = element('clip-play', HTMLButtonElement);
  readonly #onMorph: () => void;
  #clips: readonly AnimationClip[] = [];
  #paused = false;

  /** @param onMorph Called before the user starts one that moves morphs. */
  constructor(stage: Stage, onMorph: () => void) {
    this.#stage = stage;
    this.#onMorph = onMorph;
    this.#select.addEventListener('change', () => this.#start());
    this.#button.addEventListener('click', () => {
      if (!this.#clip) {
        this.#select.value = '0';
        this.#start();
      } else this.#pause(!this.#paused);
    });
  }

  get #clip(): AnimationClip | undefined {
    return this.#clips[Number(this.#select.value)];
  }

  /** Lists the animations of another model. */
  offer(clips: readonly AnimationClip[]): void {
    this.#clips = clips;
    element('clips', HTMLElement).hidden = clips.length === 0;
    const names = clips.map(({ name }, index) => optionOf(name, index));
    this.#select.replaceChildren(new Option('At rest', '-1'), ...names);
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.#select.value = clips.length > 0 && !still ? '0' : '-1';
    this.#play();
  }

  /** Returns the model to its rest pose if what is played moves morphs: others move them now. */
  leaveMorphs(): void {
    if (!this.#clip || !movesMorphs(this.#clip)) return;
    this.#select.value = '-1';
    this.#play();
  }

  #start(): void {
    if (this.#clip && movesMorphs(this.#clip)) this.#onMorph();
    this.#play();
  }

  #play(): void {
    this.#stage.play(this.#clip);
    this.#pause(!this.#clip);
  }

  #pause(paused: boolean): void {
    this.#paused = paused;
    this.#button.ariaLabel = paused ? 'Play' : 'Pause';
    this.#button.classList.toggle('playing', !paused);
    if (this.#clip) this.#stage.pause(paused);
  }
}
