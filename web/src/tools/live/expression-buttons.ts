import { make } from '../../platform/make';
import { element } from '../../platform/page';
import { type Expression, shownBy } from './expressions';
import type { Weights } from './morph-names';

const kEase = 200; // milliseconds

/** A button for each expression. Those that stay exclude each other; a blink or speech comes on top of them. */
export class ExpressionButtons {
  readonly #box = element('expressions', HTMLElement);
  readonly #show: (weights: Weights) => void;
  /** The weights without any expression, of the morphs that some expression moves. */
  #rest: Weights = new Map();
  /** Where the current move started. */
  #from: Weights = new Map();
  #shown: Weights = new Map();
  #expressions: readonly Expression[] = [];
  #held: Expression | undefined;
  #playing: Expression | undefined;
  #since = 0;
  #frame = 0;

  /** @param show  Called for each step. */
  constructor(show: (weights: Weights) => void) {
    this.#show = show;
  }

  /** Offers those of another model. @param stored  The weights in its file. */
  offer(expressions: readonly Expression[], stored: Weights): void {
    this.release();
    this.#expressions = expressions;
    const shapes = expressions.flatMap(({ weights, sequence = [] }) => [
      weights,
      ...sequence.map(([, shape]) => shape),
    ]);
    const names = new Set(shapes.flatMap((weights) => [...weights.keys()]));
    this.#rest = new Map([...names].map((name) => [name, stored.get(name) ?? 0]));
    this.#shown = this.#rest;
    this.#box.hidden = expressions.length === 0;
    this.#box.replaceChildren(
      ...expressions.map((expression) => {
        const button = make(
          'button',
          { type: 'button', ariaPressed: 'false', value: expression.title },
          expression.title,
        );
        button.addEventListener('click', () => this.#press(expression));
        return button;
      }),
    );
  }

  /** Ends all expressions: the morphs are moved otherwise. @param weights If they show one, that is held. */
  release(weights?: Weights): void {
    cancelAnimationFrame(this.#frame);
    this.#playing = undefined;
    this.#held = weights && shownBy(this.#expressions, weights);
    this.#shown = new Map([...this.#rest, ...(this.#held?.weights ?? [])]);
    this.#mark();
  }

  #press(expression: Expression): void {
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    if (expression.sequence && !still) this.#playing = this.#playing === expression ? undefined : expression;
    else this.#held = this.#held === expression ? undefined : expression;
    this.#mark();
    this.#from = this.#shown;
    this.#since = performance.now() - (still ? kEase : 0);
    cancelAnimationFrame(this.#frame);
    this.#step(performance.now());
  }

  #mark(): void {
    const titles = [this.#held?.title, this.#playing?.title];
    for (const button of this.#box.querySelectorAll('button'))
      button.ariaPressed = String(titles.includes(button.value));
  }

  #step(now: number): void {
    const past = Math.max(0, now - this.#since);
    const share = Math.min(1, past / kEase);
    const eased = share * share * (3 - 2 * share);
    const shape = this.#playing && shapeAt(this.#playing.sequence!, past / 1000);
    if (this.#playing && !shape) {
      this.#playing = undefined;
      this.#mark();
    }
    this.#shown = new Map(
      [...this.#rest].map(([name, rest]) => {
        const [from, to] = [this.#from.get(name)!, this.#held?.weights.get(name) ?? rest];
        return [name, Math.max(from + eased * (to - from), shape?.get(name) ?? -Infinity)];
      }),
    );
    this.#show(this.#shown);
    if (share < 1 || this.#playing) this.#frame = requestAnimationFrame((next) => this.#step(next));
  }
}

/** The shape between the two of a sequence that are around a time; undefined once it has ended. */
function shapeAt(sequence: NonNullable<Expression['sequence']>, seconds: number): Weights | undefined {
  const i = sequence.findIndex(([at]) => at > seconds);
  if (i < 0) return undefined;
  const [[start, from], [end, to]] = [sequence[i - 1] ?? ([0, new Map() as Weights] as const), sequence[i]!];
  const share = (seconds - start) / (end - start);
  const names = new Set([...from.keys(), ...to.keys()]);
  return new Map(
    [...names].map((name) => [name, (1 - share) * (from.get(name) ?? 0) + share * (to.get(name) ?? 0)] as const),
  );
}
