import { make, swatch } from '../platform/make';
import { announce, element } from '../platform/page';
import type { Session } from '../state/session';
import { beside } from '../state/study/beside';
import { kZones } from '../state/zones';
import type { Spot } from '../view/pick';
import type { RailTool, Tools } from '../view/tool-rail';
import type { Viewer } from '../view/viewer';
import { BoundaryLoops } from './boundary-loops';
import { type Explanation, explain, percent, type SegmentFacts } from './explanation';
import { ExplanationMarks } from './marks';

/**
 * The tool that explains why a spot is painted or not, beside it: under the mouse, in full where one clicks or taps, or at the centre of
 * the view with the Enter key. A pinned explanation follows the spot, and changes of the rules.
 */
export class Explain {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #offer: RailTool;
  readonly #bubble = element('explain-bubble', HTMLElement);
  #loops: BoundaryLoops | undefined;
  #marks: ExplanationMarks | undefined;
  /** The explained spot, and whether it is pinned. */
  #spot: Spot | undefined;
  #pinned = false;

  constructor(session: Session, viewer: Viewer, tools: Tools) {
    this.#session = session;
    this.#viewer = viewer;
    this.#offer = {
      title: 'Explain',
      key: 'x',
      face: 'inspect',
      icon: 'M9 9a3 3 0 1 1 4.6 2.5c-1 .7-1.6 1.3-1.6 2.5M12 17.5v.1M21 12a9 9 0 1 1-18 0 9 9 0 0 1 18 0z',
      tool: {
        tap: (spot) => this.pin(spot),
        hover: (spot) => this.#pinned || this.#explain(spot),
      },
      onChoose: (chosen) => this.#onChoose(chosen),
    };
    tools.add(this.#offer);
    session.on('transfer', () => {
      this.#loops = undefined;
      this.#clear();
    });
    session.on('frame', () => (this.#loops = undefined)); // the cage may have moved too
    session.on('zones', () => this.#pinned && this.#explain(this.#spot));
    viewer.beforeDraw(() => this.#place());
    element('explain-close', HTMLButtonElement).addEventListener('click', () => {
      this.#clear();
      element('view', HTMLCanvasElement).focus();
    });
    element('view', HTMLCanvasElement).addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && tools.chosen === this.#offer) this.#explainCenter();
    });
  }

  /** Explains a spot and pins the explanation; without a spot, removes the pinned one. */
  pin(spot: Spot | undefined): void {
    this.#pinned = spot !== undefined;
    const explanation = this.#explain(spot);
    announce(
      explanation
        ? `${explanation.verdict}: ${explanation.because}. ${explanation.steps.map(({ sentence }) => sentence).join(' ')}`
        : 'The model is not here.',
    );
  }

  #explainCenter(): void {
    const { x, y } = this.#viewer.screen.center;
    this.pin(this.#viewer.screen.pick(x, y));
  }

  #onChoose(chosen: boolean): void {
    element('stage', HTMLElement).classList.toggle('explaining', chosen);
    if (!chosen) this.#clear();
  }

  #clear(): void {
    this.#pinned = false;
    this.#explain(undefined);
  }

  #explain(spot: Spot | undefined): Explanation | undefined {
    const { shown, classification, rules, locks, bare } = this.#session;
    const hadMarks = this.#marks !== undefined;
    this.#marks?.dispose();
    this.#marks = undefined;
    this.#spot = spot;
    const explanation =
      spot && shown && classification
        ? explain(
            { shown, classification, rules, locks, bare, loops: (this.#loops ??= new BoundaryLoops(shown.cage.mesh)) },
            spot.triangle,
            spot.weights,
          )
        : undefined;
    if (explanation) {
      this.#marks = new ExplanationMarks(explanation, shown!.target.mesh, shown!.cage.mesh, this.#loops!);
      this.#viewer.stage.marks.add(this.#marks.object);
    }
    if (explanation || hadMarks) this.#viewer.redraw();
    this.#write(explanation);
    return explanation;
  }

  #write(explanation: Explanation | undefined): void {
    this.#bubble.hidden = explanation === undefined;
    if (!explanation) return;
    const { zone, verdict, because, steps, part } = explanation;
    element('explain-brief', HTMLElement).replaceChildren(
      swatch(kZones[zone]!.color),
      make('b', {}, verdict),
      ': ',
      make('span', {}, because),
    );
    // Under the mouse there is little room, and it goes on.
    this.#bubble.classList.toggle('pinned', this.#pinned);
    const items = steps.map(({ title, sentence }) => make('li', {}, make('b', {}, title), make('p', {}, sentence)));
    element('explain-text', HTMLElement).replaceChildren(make('ol', {}, ...items), areasOf(part));
    this.#place();
  }

  /** Puts the explanation beside the spot, wherever that is now. */
  #place(): void {
    if (!this.#spot || this.#bubble.hidden) return;
    const { screen, controls } = this.#viewer;
    const { left, top, width, height } = element('view', HTMLCanvasElement).getBoundingClientRect();
    const seen = screen.project(this.#spot.point);
    const { offsetWidth, offsetHeight } = this.#bubble;
    const { x, y } = beside(
      { x: seen.x - left, y: seen.y - top },
      { width: offsetWidth, height: offsetHeight },
      { width, height, top: controls.free.top, bottom: controls.free.bottom },
    );
    this.#bubble.style.translate = `${Math.round(x)}px ${Math.round(y)}px`;
  }
}

/** The areas of a part as a bar: exposed, covered, and the threshold. */
function areasOf({ exposed, covered, coverage, threshold, score, passes }: SegmentFacts): HTMLElement {
  const bar = make('div', { className: 'area-bar' });
  for (const [name, value] of Object.entries({ exposed, covered, threshold: threshold * exposed }))
    bar.style.setProperty(`--${name}`, String(value));
  const facts = make('table');
  const fact = (name: string, value: string): void =>
    facts.append(make('tr', {}, make('th', { scope: 'row' }, name), make('td', {}, value)));
  fact('E exposed', percent(exposed));
  fact('C covered', percent(covered));
  fact('F = C / E', `${percent(coverage)}, ${passes ? 'passes' : 'culled'}`);
  fact('Threshold', percent(threshold));
  if (Number.isFinite(score)) fact('Score (kept from 1)', score.toFixed(2));
  return make('figure', {}, bar, facts);
}
