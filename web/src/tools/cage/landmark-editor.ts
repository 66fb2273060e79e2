import { Box3, Plane, Vector3 } from 'three';
import type { Command, History } from '#three';
import { announce, element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import { type Fitting, kMaxAsked, madeOf, readable } from '../../state/made-cages';
import type { Model } from '../../state/model';
import type { Session } from '../../state/session';
import { firstHit } from '../../view/ray';
import type { RailTool, Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { arrowStep } from './arrow-keys';
import { LandmarkDots } from './landmark-dots';
import { Mirror, otherSide } from './mirror';

type Position = readonly [number, number, number];

/** All known landmarks, the user's among them, and the cage fitted to them, once there is one. */
interface Spots {
  spots: Readonly<Record<string, Position>>;
  readonly given: Readonly<Record<string, Position>>;
  cage?: Model | undefined;
}

const kReach = 24; // pixels around a dot in which it is meant: half a finger
const kStep = 5; // pixels per arrow key; with Shift 1
const kFitDelay = 700; // milliseconds after the last key before the template is fitted again
const kUncertain = 0.7;
const kColors = { found: '#0072b2', uncertain: '#e69f00', given: '#d81b60' };
/** The most telling landmarks of a model, for templates of which few are found. */
const kFirst =
  /^(eye_centre|nose_tip|lip_lower|chin|bumper|roof$|wheel_|joint_(hips|neck|head|shoulder|wrist|hip|ankle))/;

/** Landmarks that are not on the surface: they move parallel to the view. */
const isInside = (name: string): boolean => /^(joint|eye_centre|wrist)/.test(name);

/**
 * The tool that shows the landmarks of a fit, lets the user move them and place those that were not found, and fits the template
 * again to those.
 */
export class LandmarkEditor {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #tools: Tools;
  readonly #maker: CageMaker;
  readonly #history: History;
  readonly #layer = element('landmark-spots', HTMLElement);
  readonly #label = element('landmark-label', HTMLElement);
  readonly #ask = element('landmark-ask', HTMLElement);
  readonly #choice = element('landmark-choice', HTMLSelectElement);
  readonly #mirror = element('landmark-mirror', HTMLInputElement);
  readonly #buttons = new Map<string, HTMLButtonElement>();
  readonly #offer: RailTool;
  #dots: LandmarkDots | undefined;
  #fitting: Fitting | undefined;
  /** Whether the user has asked for it. */
  #wasAsked = false;
  #target: Model | undefined;
  #state: Spots = { spots: {}, given: {} };
  /** The one that the next click places. */
  #placing: string | undefined;
  #drag: { name: string; dx: number; dy: number; before: Spots } | undefined;
  #labelled: string | undefined;
  #waiting: ReturnType<typeof setTimeout> | undefined;
  #size = 1;
  #middle = new Vector3();

  constructor(session: Session, viewer: Viewer, tools: Tools, maker: CageMaker, history: History) {
    this.#session = session;
    this.#viewer = viewer;
    this.#tools = tools;
    this.#maker = maker;
    this.#history = history;
    this.#offer = {
      title: 'Marks',
      face: 'inspect',
      key: 'l',
      icon: 'M12 21c-4-5-6-8-6-11a6 6 0 0 1 12 0c0 3-2 6-6 11zM12 12.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5z',
      tool: {
        down: (_, event) => this.#down(event),
        move: (_, event) => this.#move(event),
        up: () => this.#up(),
        cancel: () => this.#cancel(),
        tap: (spot, event) => spot && this.#place(event.clientX, event.clientY),
        hover: (_, event) => this.#hover(event),
      },
      onChoose: (on) => this.#show(on),
    };
    viewer.beforeDraw(() => this.#follow());
    element('landmark-place', HTMLButtonElement).addEventListener('click', () => this.#askFor(this.#choice.value));
    element('landmark-show', HTMLButtonElement).addEventListener('click', () => tools.choose(this.#offer));
    element('landmark-reset', HTMLButtonElement).addEventListener('click', () => this.#reset());
    element('view', HTMLCanvasElement).addEventListener('keydown', ({ key }) => {
      if (key === 'Enter' && this.#placing) this.#place(viewer.screen.center.x, viewer.screen.center.y);
    });
  }

  get spots(): Readonly<Record<string, Position>> {
    return this.#state.spots;
  }

  get given(): Readonly<Record<string, Position>> {
    return this.#state.given;
  }

  /** Shows the landmarks of a fit; undefined ends. */
  edit(fitting: Fitting | undefined): void {
    const last = this.#fitting;
    const isAsked = fitting !== undefined && fitting === this.#maker.latest;
    const isNew = isAsked && !this.#wasAsked;
    this.#wasAsked = isAsked;
    const { target, cage } = this.#session.shown!;
    const isOther = target !== this.#target || fitting?.template !== last?.template;
    // Steps on another model or template do not apply any more.
    if (isOther) this.#history.forget((command) => command instanceof LandmarkStep);
    this.#target = target;
    this.#fitting = fitting;
    // Landmarks that were moved since this fit began are fitted next.
    if (fitting && !isOther && (this.#drag || this.#waiting)) return;
    this.#stopWaiting();
    element('landmarks', HTMLElement).hidden = !fitting;
    this.#tools.offer(this.#offer, fitting !== undefined);
    this.#letGo();
    const { used = {}, given = {} } = fitting ?? {};
    const fitted = fitting && madeOf(cage.files[0]!)?.fitting === fitting ? cage : undefined;
    // The steps before and after a state get the cage that was fitted to it.
    if (given === this.#state.given && !this.#state.cage) Object.assign(this.#state, { spots: used, cage: fitted });
    else {
      const before = this.#state;
      this.#state = { spots: used, given, cage: fitted };
      const isSame = Object.keys({ ...given, ...before.given }).length === 0; // it was only fitted again
      if (!isOther && fitting !== last && given !== before.given && !isSame)
        this.#record('fitting the template', before);
    }
    if (!fitting) return;
    const box = new Box3().setFromArray(target.mesh.positions);
    this.#size = box.getSize(new Vector3()).length();
    box.getCenter(this.#middle);
    this.#write();
    // What was brought back takes no other tool out of the hand; and beside other models, landmarks are too near each other.
    if (isNew && !this.#viewer.stage.crowd) this.#tools.choose(this.#offer);
    if (this.#tools.chosen === this.#offer) {
      if (isNew && fitting.guessed.length > 0) this.#lookAtSpots();
      this.#askForNext();
    }
    this.#viewer.redraw();
  }

  #show(on: boolean): void {
    this.#layer.hidden = !on;
    this.#label.hidden = true;
    this.#dots?.dispose();
    this.#dots = on ? new LandmarkDots(this.#viewer.renderer.getPixelRatio()) : undefined;
    if (this.#dots) this.#viewer.stage.marks.add(this.#dots.object);
    if (!on) {
      this.#cancel();
      this.#askFor(undefined);
    }
    this.#viewer.redraw();
  }

  /** Writes which landmarks there are, in the panel and as buttons on the stage. */
  #write(): void {
    const { missing = [], used = {} } = this.#fitting!;
    const unknown = [...Object.keys(used), ...missing].filter(
      (name) => !this.spots[name] || this.#fitting!.guessed.includes(name),
    );
    unknown.sort((a, b) => Number(kFirst.test(b)) - Number(kFirst.test(a)));
    const own = Object.keys(this.given).length;
    const known = Object.keys(this.spots);
    element('landmark-count', HTMLElement).textContent = `${known.length}, ${own} by you`;
    element('landmark-missing', HTMLElement).hidden = unknown.length === 0;
    element('landmark-reset', HTMLButtonElement).disabled = own === 0;
    const chosen = this.#choice.value;
    this.#choice.replaceChildren(...unknown.map((name) => new Option(readable(name), name)));
    if (unknown.includes(chosen)) this.#choice.value = chosen;
    for (const [name, button] of this.#buttons)
      if (!this.spots[name]) {
        button.remove();
        this.#buttons.delete(name);
      }
    for (const name of known) {
      let button = this.#buttons.get(name);
      if (!button) this.#buttons.set(name, (button = this.#button(name)));
      button.setAttribute('aria-label', `${readable(name)}, ${this.#stateOf(name)}`);
    }
  }

  #button(name: string): HTMLButtonElement {
    const button = document.createElement('button');
    button.type = 'button';
    button.dataset.landmark = name;
    button.setAttribute('aria-describedby', 'landmark-help');
    button.addEventListener('focus', () => this.#showName(name));
    button.addEventListener('blur', () => this.#showName(undefined));
    button.addEventListener('keydown', (event) => this.#onKey(name, event));
    this.#layer.append(button);
    return button;
  }

  #stateOf(name: string): string {
    if (this.given[name]) return 'placed by you';
    return (this.#fitting!.confidence[name] ?? 1) < kUncertain ? 'uncertain' : 'found';
  }

  #colorOf(name: string): string {
    if (this.given[name]) return kColors.given;
    return this.#stateOf(name) === 'found' ? kColors.found : kColors.uncertain;
  }

  /** Moves dots and buttons to where the camera sees them. */
  #follow(): void {
    if (!this.#dots || !this.#fitting) return;
    const { x, y } = this.#viewer.screen.center;
    const nearer = this.#viewer.screen.rayAt(x, y).direction.multiplyScalar(-0.015 * this.#size);
    const names = this.#session.isLeaving ? [] : Object.keys(this.spots);
    this.#dots.show(
      names.map((name) => ({ at: this.#at(name), color: this.#colorOf(name) })),
      nearer,
    );
    const stage = this.#layer.parentElement!.getBoundingClientRect();
    const places = names.map((name) => this.#viewer.screen.project(this.#at(name)));
    names.forEach((name, i) => {
      const within = (at: number, size: number): number => Math.round(Math.max(0, Math.min(at, size)));
      const place = `${within(places[i]!.x - stage.left, stage.width)}px ${within(places[i]!.y - stage.top, stage.height)}px`;
      const button = this.#buttons.get(name);
      if (button) button.style.translate = place;
      if (name === this.#labelled) this.#label.style.translate = place;
    });
  }

  #at(name: string): Vector3 {
    return new Vector3(...this.spots[name]!);
  }

  /** Shows the name of a landmark beside it. */
  #showName(name: string | undefined): void {
    if (this.#labelled === name) return;
    this.#labelled = name;
    this.#label.hidden = name === undefined;
    if (name) this.#label.textContent = `${readable(name)}, ${this.#stateOf(name)}`;
    this.#viewer.redraw();
  }

  /** The landmark that is meant by a position on the screen. */
  #nearest({ clientX, clientY }: PointerEvent): string | undefined {
    let [best, nearest] = [kReach, undefined as string | undefined];
    for (const name of Object.keys(this.spots)) {
      const { x, y } = this.#viewer.screen.project(this.#at(name));
      const distance = Math.hypot(x - clientX, y - clientY);
      if (distance < best) [best, nearest] = [distance, name];
    }
    return nearest;
  }

  #hover(event: PointerEvent): void {
    if (!this.#layer.contains(document.activeElement)) this.#showName(this.#nearest(event));
  }

  #down(event: PointerEvent): boolean {
    const name = this.#placing ? undefined : this.#nearest(event);
    if (!name) return false;
    const { x, y } = this.#viewer.screen.project(this.#at(name));
    const before = this.#state;
    this.#history.held = true;
    this.#drag = { name, dx: x - event.clientX, dy: y - event.clientY, before };
    this.#showName(name);
    return true;
  }

  #move({ clientX, clientY }: PointerEvent): void {
    if (!this.#drag) return;
    const { name, dx, dy } = this.#drag;
    this.#put(name, clientX + dx, clientY + dy);
  }

  #up(): void {
    const drag = this.#drag;
    this.#letGo();
    if (drag && drag.before !== this.#state) {
      this.#record(`moving the ${readable(drag.name)}`, drag.before);
      this.#fit();
    }
    this.#showName(undefined);
  }

  #cancel(): void {
    if (!this.#drag) return;
    this.#state = this.#drag.before;
    this.#letGo();
    this.#showName(undefined);
    if (!this.#fitting) return;
    // A fit to these landmarks may have come during the drag.
    if (this.#fitting.given === this.given) this.edit(this.#fitting);
    else this.#write();
    this.#viewer.redraw();
  }

  #onKey(name: string, event: KeyboardEvent): void {
    const step = arrowStep(event);
    if (!step) return;
    const length = event.shiftKey ? 1 : kStep;
    const { x, y } = this.#viewer.screen.project(this.#at(name));
    const before = this.#state;
    if (!this.#put(name, x + length * step[0], y + length * step[1])) {
      announce('The model ends there.');
      return;
    }
    this.#record(`moving the ${readable(name)}`, before, this.#waiting !== undefined);
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => this.#fit(), kFitDelay);
  }

  /** Moves a landmark, and its counterpart, to where the model is at a position on the screen. @returns Whether it is there. */
  #put(name: string, x: number, y: number): boolean {
    const point = this.#pointAt(name, x, y)?.toArray();
    if (!point) return false;
    const before = this.spots[name];
    const change: Record<string, Position> = { [name]: point };
    const other = otherSide(name);
    const { used, missing } = this.#fitting!;
    if (this.#mirror.checked && other && (used[other] || missing.includes(other))) {
      const mirror = new Mirror(this.spots, this.#middle, name);
      const there = this.spots[other];
      // What is not symmetric, such as a bent arm, moves alone.
      if (!there || !before || mirror.holds(before, there)) change[other] = mirror.image(point);
    }
    this.#state = { spots: { ...this.spots, ...change }, given: { ...this.given, ...change } };
    this.#write();
    this.#showName(undefined);
    this.#showName(name);
    return true;
  }

  #pointAt(name: string, x: number, y: number): Vector3 | undefined {
    if (!isInside(name)) return this.#viewer.screen.pick(x, y)?.point;
    const ray = this.#viewer.screen.rayAt(x, y);
    if (this.spots[name])
      return ray.intersectPlane(
        new Plane().setFromNormalAndCoplanarPoint(ray.direction, this.#at(name)),
        new Vector3(),
      ) as Vector3 | undefined;
    // Half way between where the ray enters the model and where it leaves it.
    const { mesh } = this.#session.shown!.target;
    const entry = firstHit(mesh, ray.origin, ray.direction, 0)?.length;
    if (entry === undefined) return undefined;
    const exit = firstHit(mesh, ray.origin, ray.direction, entry + 1e-5 * this.#size)?.length ?? entry;
    return ray.at((entry + exit) / 2, new Vector3());
  }

  /** Asks the user to place a landmark; undefined ends that. */
  #askFor(name: string | undefined): void {
    if (name) this.#tools.choose(this.#offer);
    this.#placing = name;
    element('stage', HTMLElement).classList.toggle('explaining', name !== undefined);
    this.#ask.hidden = !name;
    if (!name) return;
    const side = /_(left|right)$/.test(name) ? ' Left and right are the model’s own.' : '';
    this.#ask.textContent = `Click on the model: ${readable(name)}.${side}`;
    announce(`${this.#ask.textContent} Or turn it under the cross and press Enter.`);
    if (!matchMedia('(pointer: coarse)').matches) element('view', HTMLCanvasElement).focus({ preventScroll: true });
  }

  /** Looks at the landmarks from their front: on a figure they may be a small part of it. */
  #lookAtSpots(): void {
    const { marks } = this.#viewer.stage;
    const places = new Map(Object.keys(this.spots).map((name) => [name, marks.localToWorld(this.#at(name))]));
    const left = new Vector3();
    for (const [name, place] of places) {
      const other = places.get(name.replace(/_left$/, '_right'));
      if (other) left.add(place).sub(other);
    }
    this.#viewer.controls.lookAt([...places.values()], Math.atan2(-left.z, left.x));
  }

  /** Asks for the landmark that would help most, if a fit had to guess some, until the user has placed a few. */
  #askForNext(): void {
    const next = this.#fitting!.guessed.find((name) => !this.given[name]);
    this.#askFor(Object.keys(this.given).length < kMaxAsked ? next : undefined);
  }

  #place(x: number, y: number): void {
    const name = this.#placing;
    const before = this.#state;
    if (!name || !this.#put(name, x, y)) return;
    this.#record(`placing the ${readable(name)}`, before);
    this.#showName(undefined);
    this.#askFor(undefined);
    this.#fit();
  }

  #reset(): void {
    const before = this.#state;
    this.#state = { spots: before.spots, given: {} };
    this.#record('forgetting your landmarks', before);
    void this.#maker.fit(this.#fitting!.template, this.given);
  }

  #letGo(): void {
    if (this.#drag) this.#history.held = false;
    this.#drag = undefined;
  }

  /** Makes what was done since `before` a step that can be undone. @param goesOn Whether it may go on with the last step. */
  #record(name: string, before: Spots, goesOn = false): void {
    const { last } = this.#history;
    if (goesOn && last instanceof LandmarkStep && last.name === name) last.after = this.#state;
    else this.#history.add(new LandmarkStep(name, before, this.#state, (state) => this.#restore(state)));
  }

  #restore(state: Spots): void {
    this.#state = state;
    this.#write();
    this.#showName(undefined);
    this.#viewer.redraw();
    this.#stopWaiting();
    if (state.cage) this.#maker.show(Promise.resolve(state.cage));
    else this.#fit();
  }

  #stopWaiting(): void {
    clearTimeout(this.#waiting);
    this.#waiting = undefined;
  }

  #fit(): void {
    this.#stopWaiting();
    if (this.#fitting) void this.#maker.fit(this.#fitting.template, this.given);
  }
}

class LandmarkStep implements Command {
  constructor(
    readonly name: string,
    private readonly before: Spots,
    public after: Spots,
    private readonly put: (state: Spots) => void,
  ) {}

  get bytes(): number {
    return this.before.cage?.files[0]?.size ?? 0;
  }

  undo(): void {
    this.put(this.before);
  }

  redo(): void {
    this.put(this.after);
  }
}
