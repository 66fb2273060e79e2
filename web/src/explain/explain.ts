import { announce, element } from '../platform/page';
import type { Session } from '../scene/session';
import type { Spot } from '../view/pick';
import type { Offer, Tools } from '../view/tool-rail';
import type { Viewer } from '../view/viewer';
import { Rims } from './boundary-loops';
import { StoryMarks } from './marks';
import { type PartFacts, percent, type Story, tell } from './story';

const kZoneNames = ['cosmetic', 'occluded', 'uncovered', 'culled'];

/**
 * The tool that tells why a spot is painted or not: under the mouse, where one taps or clicks to keep it, and in the middle of
 * the picture by the Enter key. A story that is kept follows the threshold and all other rules.
 */
export class Why {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #tools: Tools;
  readonly #offer: Offer;
  readonly #panel = element('why-story', HTMLElement);
  readonly #bubble = element('why-bubble', HTMLElement);
  #rims: Rims | undefined;
  #marks: StoryMarks | undefined;
  /** The spot whose story is told, and whether it stays when the mouse moves on. */
  #spot: Pick<Spot, 'triangle' | 'weights'> | undefined;
  #kept = false;

  constructor(session: Session, viewer: Viewer, tools: Tools) {
    this.#session = session;
    this.#viewer = viewer;
    this.#tools = tools;
    this.#offer = {
      title: 'Why?',
      key: 'w',
      icon: 'M9 9a3 3 0 1 1 4.6 2.5c-1 .7-1.600 1.300-1.600 2.500M12 17.500v.1M21 12a9 9 0 1 1-18 0 9 9 0 0 1 18 0z',
      tool: {
        tap: (spot) => this.ask(spot),
        hover: (spot) => this.#kept || this.#tell(spot),
      },
      onChoose: (chosen) => this.#onChoose(chosen),
    };
    tools.add(this.#offer);
    session.on('transfer', () => {
      this.#rims = undefined;
      this.#forget();
    });
    session.on('frame', () => (this.#rims = undefined)); // the cage may have moved along
    session.on('zones', () => this.#kept && this.#tell(this.#spot));
    element('why-ask', HTMLButtonElement).addEventListener('click', () => this.#askMiddle());
    element('view', HTMLCanvasElement).addEventListener('keydown', (event) => {
      if (event.key === 'Enter' && tools.chosen === this.#offer) this.#askMiddle();
    });
  }

  /** Tells the story of a spot and keeps it; of none, lets go of the one that is kept. */
  ask(spot: Spot | undefined): void {
    this.#kept = spot !== undefined;
    const story = this.#tell(spot);
    announce(
      story
        ? `${story.verdict}: ${story.because}. ${story.steps.map(({ sentence }) => sentence).join(' ')}`
        : 'There is nothing of the model here.',
    );
  }

  #askMiddle(): void {
    this.#tools.choose(this.#offer);
    const { x, y } = this.#viewer.middle;
    this.ask(this.#viewer.pick(x, y));
  }

  #onChoose(chosen: boolean): void {
    element('stage', HTMLElement).classList.toggle('asking', chosen);
    if (!chosen) this.#forget();
  }

  #forget(): void {
    this.#kept = false;
    this.#tell(undefined);
  }

  #tell(spot: Pick<Spot, 'triangle' | 'weights'> | undefined): Story | undefined {
    const { shown, classification, rules, locks } = this.#session;
    const hadMarks = this.#marks !== undefined;
    this.#marks?.dispose();
    this.#marks = undefined;
    this.#spot = spot;
    const story =
      spot && shown && classification
        ? tell(
            { shown, classification, rules, locks, rims: (this.#rims ??= new Rims(shown.cage.mesh)) },
            spot.triangle,
            spot.weights,
          )
        : undefined;
    if (story) {
      this.#marks = new StoryMarks(story, shown!.target.mesh, shown!.cage.mesh, this.#rims!);
      this.#viewer.marks.add(this.#marks.object);
    }
    if (story || hadMarks) this.#viewer.redraw();
    this.#write(story);
    return story;
  }

  #write(story: Story | undefined): void {
    this.#bubble.hidden = this.#panel.hidden = story === undefined;
    element('why-hint', HTMLElement).hidden = story !== undefined;
    if (!story) return;
    const { zone, verdict, because, steps, part } = story;
    this.#bubble.replaceChildren(swatch(zone), text('b', verdict), text('span', because));
    const list = document.createElement('ol');
    for (const { title, sentence } of steps) {
      const item = document.createElement('li');
      item.append(text('b', title), text('p', sentence));
      list.append(item);
    }
    const head = text('p', `${because}.`);
    const title = document.createElement('h3');
    title.append(swatch(zone), verdict);
    this.#panel.replaceChildren(title, head, list, areasOf(part));
  }
}

/** The areas of a part as a bar: what is exposed of it, what of that is covered, and where the threshold lies. */
function areasOf({ exposed, covered, coverage, threshold, margin, passes }: PartFacts): HTMLElement {
  const figure = document.createElement('figure');
  figure.className = 'areas';
  const bar = document.createElement('div');
  bar.className = 'area-bar';
  for (const [name, value] of Object.entries({ exposed, covered, threshold: threshold * exposed }))
    bar.style.setProperty(`--${name}`, String(value));
  bar.append(text('i', ''), text('i', ''), text('i', ''));
  const facts = document.createElement('dl');
  const fact = (name: string, value: string): void => facts.append(text('dt', name), text('dd', value));
  fact('E exposed', percent(exposed));
  fact('C covered', percent(covered));
  fact('F = C / E', `${percent(coverage)}, ${passes ? 'passes' : 'culled'}`);
  fact('Threshold', percent(threshold));
  if (Number.isFinite(margin)) fact('Reached of what is asked', percent(margin));
  figure.append(bar, facts);
  return figure;
}

function swatch(zone: number): HTMLElement {
  const made = text('i', '');
  made.className = 'swatch';
  made.dataset.zone = kZoneNames[zone]!;
  return made;
}

function text(tag: string, content: string): HTMLElement {
  const made = document.createElement(tag);
  made.textContent = content;
  return made;
}
