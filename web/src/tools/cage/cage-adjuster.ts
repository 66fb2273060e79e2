import {
  BufferGeometry,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Plane,
  Quaternion,
  type Ray,
  Sphere,
  Vector3,
} from 'three';
import type { Command, History } from '#three';
import { announce, element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import type { Model } from '../../state/model';
import { haveSameUvs } from '../../state/same-uvs';
import type { Session } from '../../state/session';
import { diagonalOf, weldedVertices } from '../../state/surface';
import type { RailTool, Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { arrowStep } from './arrow-keys';
import { changeHole } from './holes';
import { LandmarkDots } from './landmark-dots';

type Mode = 'move' | 'turn' | 'scale' | 'corner' | 'hole';

interface Change {
  positions: Float32Array;
  indices: Uint32Array;
}

const kReach = 24; // pixels around a handle in which it is meant
const kChangeDelay = 600; // milliseconds after the last key before the cage is changed
const kArm = 0.18; // length of an axis, in diagonals of the cage
const kAxes = { x: new Vector3(1, 0, 0), y: new Vector3(0, 1, 0), z: new Vector3(0, 0, 1) };
const kColors: Record<string, string> = { x: '#d55e00', y: '#009e73', z: '#0072b2' };
// Per arrow key.
const kStep = 0.004; // diagonals
const kTurn = Math.PI / 90;
const kGrow = 1.01;
const kPixels = 4;

const kHelp: Record<Mode, string> = {
  move: 'Drag the middle, or a dot along its line. Arrow keys move the dot that has the focus.',
  turn: 'Drag a dot: the cage turns with it. Arrow keys turn it about its line.',
  scale: 'Drag a dot outwards or inwards, or use the arrow keys.',
  corner:
    'Drag a corner of the cage. By keyboard: turn the model until the cross is at the corner, press Enter, then use the arrow keys.',
  hole: 'Click a triangle of the cage to open it, or a hole to close it; Enter does so at the cross.',
};

/** The tool that moves, turns and scales the cage, moves its corners, and opens and closes its holes. */
export class CageAdjuster {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #tools: Tools;
  readonly #maker: CageMaker;
  readonly #history: History;
  readonly #layer = element('cage-handles', HTMLElement);
  readonly #offer: RailTool;
  readonly #lines = new LineSegments(
    new BufferGeometry(),
    new LineBasicMaterial({ color: '#14181d', depthTest: false, transparent: true, toneMapped: false }),
  );
  readonly #buttons = new Map<string, HTMLButtonElement>();
  #dots: LandmarkDots | undefined;
  #mode: Mode = 'move';
  /** What was done to the cage since it was last changed. */
  #matrix = new Matrix4();
  #corner: { vertices: number[]; at: Vector3 } | undefined;
  #drag: { handle: string; from: Vector3; center: Vector3 } | undefined;
  #center = new Vector3();
  #size = 1;
  #waiting: ReturnType<typeof setTimeout> | undefined;
  /** What keys have done since the cage was last changed. */
  #pending: CageStep | undefined;
  /** Whether a change is not shown yet. */
  #isChanging = false;
  /** Fulfilled when the last change is made, or has failed. */
  #changed: Promise<unknown> = Promise.resolve();
  /** The cages that steps lead to, forwards or backwards. */
  readonly #stepped = new WeakSet<Model>();

  constructor(session: Session, viewer: Viewer, tools: Tools, maker: CageMaker, history: History) {
    this.#session = session;
    this.#viewer = viewer;
    this.#tools = tools;
    this.#maker = maker;
    this.#history = history;
    this.#lines.renderOrder = 6;
    this.#lines.frustumCulled = false;
    this.#offer = {
      title: 'Cage',
      key: '',
      icon: '',
      tool: {
        down: (_, { clientX, clientY }) => this.#down(clientX, clientY),
        move: (_, { clientX, clientY }) => this.#move(clientX, clientY),
        up: () => this.#commit(),
        cancel: () => this.#reset(),
        tap: (_, { clientX, clientY }) => this.#mode === 'hole' && this.#changeHole(clientX, clientY),
      },
      onChoose: (on) => this.#show(on),
    };
    viewer.beforeDraw(() => this.#follow());
    for (const input of element('adjust', HTMLElement).querySelectorAll('input'))
      input.addEventListener('change', () => this.#setMode(input.value as Mode));
    element('adjust-done', HTMLButtonElement).addEventListener('click', () => {
      tools.choose(undefined);
      element('adjust-cage', HTMLButtonElement).focus(); // this button is hidden now
    });
    element('view', HTMLCanvasElement).addEventListener('keydown', ({ key }) => {
      if (key !== 'Enter' || tools.chosen !== this.#offer) return;
      const { x, y } = viewer.screen.center;
      if (this.#mode === 'hole') this.#changeHole(x, y);
      if (this.#mode !== 'corner') return;
      this.#corner = this.#cornerAt(x, y, Infinity);
      this.#place();
      this.#buttons.get('corner')?.focus();
    });
    let { target, cage } = session.shown ?? {};
    session.on('transfer', (shown) => {
      this.#isChanging = false;
      if (target && target !== shown.target) {
        this.#drop(); // or it would be done to the cage of this model
        tools.choose(undefined);
      } else if (cage && !haveSameUvs(cage, shown.cage)) this.#drop(); // its corners are others
      // Steps lead neither to another model's cage nor from a cage that came otherwise.
      if (target !== shown.target || !this.#stepped.has(shown.cage))
        history.forget((command) => command instanceof CageStep);
      ({ target, cage } = shown);
      this.#reset();
    });
    session.on('progress', ({ state }) => {
      if (state !== 'working') this.#isChanging = false;
    });
  }

  /** Begins; the cage is shown. */
  start(): void {
    if (this.#session.moved) {
      this.#session.fail(new Error('The cage can be adjusted while the model is undeformed: undo what Move did.'));
      return;
    }
    this.#session.setView({ cage: true });
    this.#tools.choose(this.#offer);
  }

  get #cage() {
    const { positions, rest = positions, indices, uvs = new Float32Array() } = this.#session.shown!.cage.mesh;
    return { positions: rest, indices, uvs };
  }

  #show(on: boolean): void {
    element('adjust', HTMLElement).hidden = this.#layer.hidden = !on;
    element('stage', HTMLElement).classList.toggle('explaining', on);
    this.#dots?.dispose();
    this.#lines.removeFromParent();
    this.#dots = on ? new LandmarkDots(this.#viewer.renderer.getPixelRatio(), true) : undefined;
    if (this.#dots) this.#viewer.stage.marks.add(this.#dots.object, this.#lines);
    if (on) this.#setMode(this.#mode);
    else if (this.#session.shown) this.#commit();
    this.#viewer.redraw();
  }

  #setMode(mode: Mode): void {
    this.#commit();
    this.#mode = mode;
    this.#corner = undefined;
    element('adjust-help', HTMLElement).textContent = kHelp[mode];
    this.#reset();
  }

  /** Drops what is not done to the cage yet. */
  #drop(): void {
    clearTimeout(this.#waiting);
    const pending = this.#pending;
    this.#pending = this.#corner = undefined;
    if (pending) this.#history.forget((command) => command === pending);
    this.#letGo();
    this.#matrix.identity();
  }

  #letGo(): void {
    if (this.#drag) this.#history.held = false;
    this.#drag = undefined;
  }

  /** Whether the last change is shown, so that the next one can build on it; says if not. */
  #isReady(): boolean {
    if (this.#isChanging) announce('The cage is still being changed.');
    return !this.#isChanging;
  }

  /** Shows the cage as it is, with handles where it is. */
  #reset(): void {
    const corner = this.#corner;
    this.#drop();
    this.#corner = corner;
    this.#viewer.stage.moveCage(this.#matrix);
    const { positions } = this.#cage;
    this.#size = diagonalOf({ positions });
    this.#center.set(0, 0, 0);
    for (let i = 0; i < positions.length; i++)
      this.#center.setComponent(i % 3, this.#center.getComponent(i % 3) + positions[i]! / (positions.length / 3));
    if (this.#corner) this.#corner.at.fromArray(positions, 3 * this.#corner.vertices[0]!);
    this.#place();
  }

  /** The handles of the mode, and where they are. */
  get #handles(): Map<string, Vector3> {
    if (this.#mode === 'hole') return new Map();
    if (this.#mode === 'corner') return new Map(this.#corner ? [['corner', this.#corner.at]] : []);
    const center = this.#center.clone().applyMatrix4(this.#matrix);
    const axes = Object.entries(kAxes).map(([name, axis]): [string, Vector3] => {
      const arm = axis.clone().multiplyScalar(kArm * this.#size);
      return [name, this.#mode === 'move' ? arm.add(center) : arm.add(this.#center).applyMatrix4(this.#matrix)];
    });
    return new Map([...(this.#mode === 'move' ? [['middle', center] as [string, Vector3]] : []), ...axes]);
  }

  /** Makes buttons for the handles. */
  #place(): void {
    const handles = this.#handles;
    for (const [name, button] of this.#buttons)
      if (!handles.has(name)) {
        button.remove();
        this.#buttons.delete(name);
      }
    const verb = { move: 'Move', turn: 'Turn', scale: 'Scale', corner: 'Move', hole: '' }[this.#mode];
    for (const name of handles.keys()) {
      let button = this.#buttons.get(name);
      if (!button) {
        button = document.createElement('button');
        button.type = 'button';
        button.dataset.handle = name;
        button.setAttribute('aria-describedby', 'adjust-help');
        button.addEventListener('keydown', (event) => this.#onKey(name, event));
        this.#buttons.set(name, button);
        this.#layer.append(button);
      }
      const what = name === 'corner' ? 'the corner' : `the cage${name === 'middle' ? '' : `, ${name}`}`;
      button.setAttribute('aria-label', `${verb} ${what}`);
    }
    this.#viewer.redraw();
  }

  #follow(): void {
    if (!this.#dots) return;
    const handles = [...this.#handles];
    this.#dots.show(
      handles.map(([name, at]) => ({ at, color: kColors[name] ?? '#d81b60' })),
      new Vector3(),
    );
    const center = this.#center.clone().applyMatrix4(this.#matrix);
    const ends = handles.flatMap(([name, at]) => (kColors[name] ? [center, at] : []));
    this.#lines.geometry.setFromPoints(ends);
    this.#lines.geometry.setDrawRange(0, ends.length);
    const stage = this.#layer.parentElement!.getBoundingClientRect();
    const places = handles.map(([, at]) => this.#viewer.screen.project(at));
    handles.forEach(([name], i) => {
      const button = this.#buttons.get(name);
      const { x, y } = places[i]!;
      if (button) button.style.translate = `${Math.round(x - stage.left)}px ${Math.round(y - stage.top)}px`;
    });
  }

  #down(x: number, y: number): boolean {
    if (this.#mode === 'hole' || !this.#isReady()) return false;
    if (this.#mode === 'corner') this.#corner = this.#cornerAt(x, y, kReach);
    const near = [...this.#handles]
      .map(([handle, at]) => {
        const place = this.#viewer.screen.project(at);
        return { handle, at, distance: Math.hypot(place.x - x, place.y - y) };
      })
      .sort((a, b) => a.distance - b.distance)[0];
    this.#place();
    if (!near || near.distance > kReach) return false;
    clearTimeout(this.#waiting);
    this.#history.held = true;
    this.#drag = {
      handle: near.handle,
      from: near.at.clone(),
      center: this.#center.clone().applyMatrix4(this.#matrix),
    };
    return true;
  }

  #move(x: number, y: number): void {
    if (!this.#drag) return;
    const { handle, from, center } = this.#drag;
    const to = this.#pointed(handle, from, center, this.#viewer.screen.rayAt(x, y));
    if (!to) return;
    this.#drag.from = to.clone();
    if (this.#corner) this.#corner.at.copy(to);
    else if (this.#mode === 'move') {
      this.#apply(new Matrix4().makeTranslation(to.clone().sub(from)));
      this.#drag.center.add(to.sub(from));
    } else this.#transform(from.sub(center), to.sub(center));
    this.#viewer.redraw();
  }

  /** Where a handle is moved to by a pointer: in the plane of the view, along its axis or about the middle. */
  #pointed(handle: string, from: Vector3, center: Vector3, ray: Ray): Vector3 | undefined {
    const axis = kAxes[handle as keyof typeof kAxes];
    if (this.#mode === 'turn') {
      const sphere = new Sphere(center, from.distanceTo(center));
      const front = ray.intersectSphere(sphere, new Vector3()) ?? ray.closestPointToPoint(center, new Vector3());
      // The half that the handle is on.
      if (from.clone().sub(center).dot(ray.direction) <= 0) return front;
      const depth = center.clone().sub(front).dot(ray.direction);
      return front.addScaledVector(ray.direction, 2 * depth);
    }
    if (this.#mode === 'move' && axis) {
      const far = 10 * this.#size;
      const on = new Vector3();
      const [a, b] = [-far, far].map((length) => from.clone().addScaledVector(axis, length)) as [Vector3, Vector3];
      ray.distanceSqToSegment(a, b, undefined, on);
      return on;
    }
    return (
      ray.intersectPlane(new Plane().setFromNormalAndCoplanarPoint(ray.direction, from), new Vector3()) ?? undefined
    );
  }

  /** Turns or scales about the middle, so that one arm becomes the other. */
  #transform(before: Vector3, after: Vector3): void {
    const grown = after.dot(before) / before.lengthSq();
    const turn = new Quaternion().setFromUnitVectors(before.normalize(), after.normalize());
    const change = new Matrix4();
    this.#about(
      this.#mode === 'scale' ? change.makeScale(grown, grown, grown) : change.makeRotationFromQuaternion(turn),
    );
  }

  #about(change: Matrix4): void {
    const { x, y, z } = this.#center.clone().applyMatrix4(this.#matrix);
    this.#apply(
      new Matrix4()
        .makeTranslation(x, y, z)
        .multiply(change)
        .multiply(new Matrix4().makeTranslation(-x, -y, -z)),
    );
  }

  #apply(change: Matrix4): void {
    if (!(Math.abs(change.determinant()) > 1e-6)) return;
    this.#matrix.premultiply(change);
    this.#viewer.stage.moveCage(this.#matrix);
  }

  #onKey(handle: string, event: KeyboardEvent): void {
    const step = arrowStep(event);
    if (!step || !this.#isReady()) return;
    const axis = kAxes[handle as keyof typeof kAxes];
    const sign = step[0] - step[1];
    if (!axis) {
      const at = this.#handles.get(handle)!;
      const { x, y } = this.#viewer.screen.project(at);
      this.#drag = { handle, from: at.clone(), center: this.#center.clone().applyMatrix4(this.#matrix) };
      this.#move(x + kPixels * step[0], y + kPixels * step[1]);
      this.#drag = undefined;
    } else if (this.#mode === 'move')
      this.#apply(new Matrix4().makeTranslation(axis.clone().multiplyScalar(sign * kStep * this.#size)));
    else if (this.#mode === 'turn') this.#about(new Matrix4().makeRotationAxis(axis, sign * kTurn));
    else this.#about(new Matrix4().makeScale(kGrow ** sign, kGrow ** sign, kGrow ** sign));
    this.#viewer.redraw();
    this.#record();
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => this.#commit(), kChangeDelay);
  }

  /** The corner of the cage nearest to a position on the screen, in front of others. */
  #cornerAt(x: number, y: number, reach: number): CageAdjuster['corner'] {
    const { positions } = this.#cage;
    const ray = this.#viewer.screen.rayAt(x, y);
    const at = new Vector3();
    let best = { cost: Infinity, vertex: -1 };
    for (let vertex = 0; 3 * vertex < positions.length; vertex++) {
      at.fromArray(positions, 3 * vertex);
      const place = this.#viewer.screen.project(at);
      const distance = Math.hypot(place.x - x, place.y - y);
      const cost = distance + (200 * at.sub(ray.origin).dot(ray.direction)) / this.#size;
      if (distance < reach && cost < best.cost) best = { cost, vertex };
    }
    if (best.vertex < 0) return undefined;
    const welded = weldedVertices(positions);
    const vertices = [...welded.keys()].filter((vertex) => welded[vertex] === welded[best.vertex]);
    return { vertices, at: new Vector3().fromArray(positions, 3 * best.vertex) };
  }

  get corner(): { vertices: number[]; at: Vector3 } | undefined {
    return this.#corner;
  }

  #changeHole(x: number, y: number): void {
    if (!this.#isReady()) return;
    const change = changeHole(this.#cage, this.#viewer.screen.rayAt(x, y));
    if (!change) announce('The cage is not here.');
    else if ('seam' in change) announce('This hole cannot be closed: a seam of the UVs runs into it.');
    else this.#make(this.#add(change.opened ? 'opening a hole' : 'closing a hole', { indices: change.indices }));
  }

  /** Makes what was done to the cage a step that can be undone. */
  #record(): void {
    const { positions: old } = this.#cage;
    const positions = old.slice();
    const point = new Vector3();
    if (this.#corner) for (const vertex of this.#corner.vertices) this.#corner.at.toArray(positions, 3 * vertex);
    else
      for (let i = 0; i < positions.length; i += 3)
        point.fromArray(positions, i).applyMatrix4(this.#matrix).toArray(positions, i);
    if (this.#pending) this.#pending.change.positions = positions;
    else if (positions.some((value, i) => value !== old[i]))
      this.#pending = this.#add(this.#corner ? 'moving a corner' : 'moving the cage', { positions });
  }

  #add(name: string, change: Partial<Change>): CageStep {
    const { cage } = this.#session.shown!;
    const { positions, indices } = this.#cage;
    const step = new CageStep(name, cage, { positions, indices, ...change }, () => this.#put(step));
    this.#stepped.add(cage);
    this.#history.add(step);
    return step;
  }

  /** Changes the cage to what is shown. */
  #commit(): void {
    clearTimeout(this.#waiting);
    this.#letGo();
    if (this.#isChanging) return; // it is done already
    this.#record();
    const step = this.#pending;
    this.#pending = undefined;
    if (step) this.#make(step);
  }

  #make(step: CageStep): void {
    this.#isChanging = true;
    step.after = this.#maker.change(step.change);
    this.#changed = step.after.then(
      (after) => this.#stepped.add(after),
      (error) => {
        this.#history.forget((command) => command === step);
        this.#session.fail(error);
      },
    );
  }

  /** Shows the cage before or after a step. */
  #put(step: CageStep): void {
    const { before, after, isUndone } = step;
    if (after) {
      // Only then can no change that is being made come after it.
      void this.#changed.then(() => {
        this.#reset();
        this.#maker.show(isUndone ? Promise.resolve(before) : after);
      });
    } else if (isUndone) {
      this.#pending = undefined;
      this.#reset();
    } else this.#make(step);
  }
}

/** A change of the cage. */
class CageStep implements Command {
  readonly bytes: number;
  /** The changed cage; undefined while it waits for more keys. */
  after: Promise<Model> | undefined;
  isUndone = false;

  constructor(
    readonly name: string,
    readonly before: Model,
    readonly change: Change,
    private readonly put: () => void,
  ) {
    this.bytes = 2 * (change.positions.byteLength + change.indices.byteLength);
  }

  undo(): void {
    this.isUndone = true;
    this.put();
  }

  redo(): void {
    this.isUndone = false;
    this.put();
  }
}
