import type { Vector3 } from 'three';
import type { Command, History } from '#three';
import { announce, element } from '../../platform/page';
import type { Model } from '../../state/model';
import type { Session } from '../../state/session';
import { closestPointOnTriangle, type Surface } from '../../state/surface';
import type { Spot } from '../../view/pick';
import type { RailTool, Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { brushPixels, Ring } from '../paint/ring';

const kMaxBetween = 8; // spots that are filled in between two positions of the pointer

type Position = Pick<PointerEvent, 'clientX' | 'clientY'>;

/** The tool to mark bare spots on the model: no paint gets there, and made cages have holes there. */
export class BareBrush {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #tools: Tools;
  readonly #history: History;
  readonly #size = element('bare-size', HTMLInputElement);
  readonly #erases = element('bare-erase', HTMLInputElement);
  readonly #ring = new Ring();
  readonly #offer: RailTool;
  #target: Model | undefined;
  #isChosen = false;
  /** The marks while the brush is down, and where it was last. */
  #stroke: { marks: Uint8Array; last: Position } | undefined;

  constructor(session: Session, viewer: Viewer, tools: Tools, history: History) {
    this.#session = session;
    this.#viewer = viewer;
    this.#tools = tools;
    this.#history = history;
    this.#offer = {
      title: 'Bare',
      key: 'n',
      icon: 'M21 12a9 9 0 1 1-18 0 9 9 0 0 1 18 0zM5.7 5.7l12.6 12.6',
      tool: {
        down: (spot, event) => this.#down(spot, event),
        move: (spot, event) => this.#move(spot, event),
        up: () => this.#up(),
        cancel: () => this.#cancel(),
        hover: (spot, event) => this.#follow(spot, event),
      },
      onChoose: (on) => this.#choose(on),
    };
    element('bare-brush', HTMLButtonElement).addEventListener('click', () => {
      tools.offer(this.#offer, true);
      tools.choose(tools.chosen === this.#offer ? undefined : this.#offer);
    });
    element('bare-center', HTMLButtonElement).addEventListener('click', () => this.#markCenter());
    element('bare-clear', HTMLButtonElement).addEventListener('click', () => {
      this.#set(undefined, 'clearing the marks');
      element('bare-center', HTMLButtonElement).focus(); // this button is disabled now
    });
    element('view', HTMLCanvasElement).addEventListener('keydown', ({ key }) => {
      if (key === 'Enter' && tools.chosen === this.#offer) this.#markCenter();
    });
    this.#size.addEventListener('input', () => this.#write());
    session.on('transfer', ({ target }) => this.#onTransfer(target));
    session.on('zones', () => this.#write());
    if (session.shown) this.#onTransfer(session.shown.target);
    this.#write();
    element('bare', HTMLElement).hidden = false;
  }

  /** The diameter of the brush in pixels of the screen. */
  get #pixels(): number {
    return brushPixels(this.#size.valueAsNumber);
  }

  #onTransfer(target: Model): void {
    if (target === this.#target) return;
    this.#stroke = undefined;
    this.#target = target;
    this.#history.forget((command) => command instanceof BareStep);
    // Samples have cages of their own, and no options for others.
    if (target.sample) this.#tools.offer(this.#offer, false);
    else if (this.#tools.chosen === this.#offer) this.#tools.choose(undefined);
  }

  #choose(on: boolean): void {
    this.#ring.hide();
    element('stage', HTMLElement).classList.toggle('explaining', on);
    element('bare-options', HTMLElement).hidden = !on;
    element('bare-brush', HTMLButtonElement).setAttribute('aria-pressed', String(on));
    this.#isChosen = on;
    this.#write();
  }

  /** Shows the marks, how many there are, and how large the brush is. */
  #write(): void {
    const marks = this.#stroke?.marks ?? this.#session.bare;
    if (marks) this.#tools.offer(this.#offer, true);
    this.#viewer.stage.highlight('bare', this.#isChosen ? marks : undefined);
    const count = countOf(marks);
    element('bare-count', HTMLElement).textContent = count;
    element('bare-clear', HTMLButtonElement).disabled = count === '';
    const size = `${Math.round(this.#pixels)} px`;
    element('bare-size-value', HTMLOutputElement).value = size;
    this.#size.setAttribute('aria-valuetext', size);
  }

  #down(spot: Spot | undefined, { clientX, clientY }: Position): boolean {
    if (!spot) return false;
    const { indices } = this.#target!.mesh;
    const marks = this.#session.bare?.slice() ?? new Uint8Array(indices.length / 3);
    this.#stroke = { marks, last: { clientX, clientY } };
    this.#history.held = true;
    this.#mark(spot);
    this.#write();
    return true;
  }

  #move(spot: Spot | undefined, event: PointerEvent): void {
    if (!this.#stroke) return;
    const { clientX, clientY } = this.#stroke.last;
    const [dx, dy] = [event.clientX - clientX, event.clientY - clientY];
    this.#stroke.last = { clientX: event.clientX, clientY: event.clientY };
    if (spot) {
      const apart = (2 * Math.hypot(dx, dy)) / this.#pixels;
      const between = Math.min(kMaxBetween, Math.floor(apart));
      for (let i = 1; i <= between; i++) {
        const share = i / (between + 1);
        const other = this.#viewer.screen.pick(clientX + share * dx, clientY + share * dy);
        if (other) this.#mark(other);
      }
      this.#mark(spot);
    }
    this.#write();
    this.#follow(spot, event);
  }

  #up(): void {
    const { marks } = this.#stroke ?? {};
    this.#cancel();
    if (marks) this.#set(marks, this.#erases.checked ? 'erasing marks' : 'marking what stays bare');
  }

  #cancel(): void {
    this.#stroke = undefined;
    this.#history.held = false;
    this.#write();
  }

  #follow(spot: Spot | undefined, { clientX, clientY, pointerType }: PointerEvent): void {
    // A finger covers the ring.
    if (!spot || pointerType === 'touch') this.#ring.hide();
    else this.#ring.show(clientX, clientY, this.#pixels);
  }

  #markCenter(): void {
    const { x, y } = this.#viewer.screen.center;
    if (this.#down(this.#viewer.screen.pick(x, y), { clientX: x, clientY: y })) this.#up();
    else announce('The model is not here.');
  }

  /** Marks what faces the viewer as the spot does, and reaches into the brush; or erases its marks. */
  #mark({ triangle, point, seen }: Spot): void {
    const radius = this.#pixels / 2 / this.#viewer.screen.pixelsAt(seen);
    const { marks } = this.#stroke!;
    const { mesh } = this.#target!;
    const mark = this.#erases.checked ? 0 : 1;
    const faces = (of: number): boolean => {
      const { closest, normal } = closestPointOnTriangle(mesh, of, point);
      return this.#viewer.screen.faces(closest, normal);
    };
    const side = faces(triangle);
    for (const near of trianglesNear(mesh, point, radius)) if (faces(near) === side) marks[near] = mark;
    marks[triangle] = mark;
  }

  /** Changes the marks as a step that can be undone. */
  #set(marks: Uint8Array | undefined, name: string): void {
    const before = this.#session.bare;
    if (marks ? marks.every((mark, t) => mark === (before?.[t] ?? 0)) : !before) return;
    const put = (to: Uint8Array | undefined): void => this.#session.setBare(to);
    put(marks);
    this.#history.add(new BareStep(name, before, marks, put));
    announce(countOf(marks) || 'Nothing is marked.');
  }
}

/** Says how many triangles are marked; empty if none is. */
function countOf(marks: Uint8Array | undefined): string {
  const count = marks?.reduce((sum, mark) => sum + mark, 0) ?? 0;
  return count === 0 ? '' : `${count.toLocaleString('en')} triangle${count === 1 ? ' stays' : 's stay'} bare.`;
}

/** The triangles that come as near to a point as `radius`. */
function trianglesNear(mesh: Surface, point: Vector3, radius: number): number[] {
  const { positions, indices } = mesh;
  const near: number[] = [];
  for (let t = 0; 3 * t < indices.length; t++) {
    let isApart = false;
    // By its box first: few triangles are near.
    for (let axis = 0; axis < 3 && !isApart; axis++) {
      const at = point.getComponent(axis);
      const a = positions[3 * indices[3 * t]! + axis]! - at;
      const b = positions[3 * indices[3 * t + 1]! + axis]! - at;
      const c = positions[3 * indices[3 * t + 2]! + axis]! - at;
      isApart = Math.min(a, b, c) > radius || Math.max(a, b, c) < -radius;
    }
    if (!isApart && closestPointOnTriangle(mesh, t, point).closest.distanceTo(point) <= radius) near.push(t);
  }
  return near;
}

class BareStep implements Command {
  readonly bytes: number;

  constructor(
    readonly name: string,
    private readonly before: Uint8Array | undefined,
    private readonly after: Uint8Array | undefined,
    private readonly put: (marks: Uint8Array | undefined) => void,
  ) {
    this.bytes = (before?.length ?? 0) + (after?.length ?? 0);
  }

  undo(): void {
    this.put(this.before);
  }

  redo(): void {
    this.put(this.after);
  }
}
