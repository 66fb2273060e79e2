import { presetOptions } from 'cagecast';
import { BufferGeometry, Color, Float32BufferAttribute, LineBasicMaterial, LineSegments } from 'three';
import { make } from '../platform/make';
import { element } from '../platform/page';
import { withoutParts } from '../state/left-out';
import type { Session } from '../state/session';
import { diagonalOf } from '../state/surface';
import type { Viewer } from '../view/viewer';
import { BoundaryLoops } from './boundary-loops';
import { kAway, kRayColors } from './marks';
import { type Path, pathOf } from './path';

/** The frames, one for each step of the method; what they show is in `kSteps` of the view. */
const kSteps: readonly { title: string; text: string }[] = [
  {
    title: 'Cage',
    text: 'A simple mesh around the model. Paint is drawn once, for the cage. It has holes where nothing may be painted.',
  },
  {
    title: 'Closest point',
    text: 'Each point of the model takes the paint of the closest point of the cage. This alone paints eyes and teeth, too.',
  },
  {
    title: 'Rays',
    text: 'A ray leaves each point for the cage. Points that the model itself hides stay bare, and so do those under a hole.',
  },
  {
    title: 'Parts',
    text: 'Connected parts that are hardly covered, such as an eyeball behind a hole, stay bare as a whole.',
  },
  {
    title: 'Result',
    text: 'The rest is painted. Before that, the default rules look again at hidden points and at the borders of holes.',
  },
];
const [kClosest, kRays, kLast] = [1, 2, kSteps.length - 1];
const kSeconds = 0.7; // from one frame to another one
const kMaxLines = 400;
const kMaxVisits = 1e7; // of triangles, for all lines together
const kInk = '#14181d';

/** The method as a film strip of the model on the stage: five frames, and a slider that moves the stage from one to the next. */
export class FilmStrip {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #card = element('method', HTMLDetailsElement);
  readonly #slider = element('step', HTMLInputElement);
  readonly #text = element('step-text', HTMLElement);
  readonly #frames = kSteps.map(({ title }, at) => {
    const picture = make('canvas', { width: 120, height: 120 });
    picture.ariaHidden = 'true';
    const button = make('button', { type: 'button' }, picture, title);
    button.addEventListener('click', () => this.#goTo(at));
    return { button, picture };
  });
  #paths: readonly Path[] | undefined;
  #lines: { of: number; object: LineSegments<BufferGeometry, LineBasicMaterial> } | undefined;
  #going = 0;

  constructor(session: Session, viewer: Viewer) {
    this.#session = session;
    this.#viewer = viewer;
    element('steps', HTMLElement).append(...this.#frames.map(({ button }) => button));
    this.#slider.addEventListener('input', () => this.#show(Number(this.#slider.value)));
    this.#card.addEventListener('toggle', () => {
      if (this.#card.open) void this.#takePictures();
      else if (session.view.mode === 'steps') session.setView({ mode: 'result' });
    });
    session.on('transfer', () => this.#forget());
    session.on('frame', () => this.#forget());
    session.on('zones', () => this.#card.open && void this.#takePictures());
    session.on('view', ({ mode, step }) => this.#follow(mode === 'steps' ? step : undefined));
    const { mode, step } = session.view;
    this.#follow(mode === 'steps' ? step : undefined);
    if (this.#card.open) void this.#takePictures();
  }

  #forget(): void {
    this.#paths = undefined;
    this.#draw(undefined);
    const { mode, step } = this.#session.view;
    if (mode === 'steps') this.#draw(Math.round(step));
  }

  #show(step: number): void {
    cancelAnimationFrame(this.#going);
    this.#session.setView({ mode: 'steps', step });
  }

  /** Moves to a frame. */
  #goTo(at: number): void {
    const from = this.#session.view.mode === 'steps' ? this.#session.view.step : Math.max(0, at - 1);
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
      this.#show(at);
      return;
    }
    const begun = performance.now();
    const move = (now: number): void => {
      const share = Math.min(1, Math.max(0, now - begun) / (1000 * kSeconds));
      this.#show(from + (at - from) * share * share * (3 - 2 * share));
      if (share < 1) this.#going = requestAnimationFrame(move);
    };
    move(begun);
  }

  /** @param step Undefined while the stage shows something else. */
  #follow(step: number | undefined): void {
    const at = step === undefined ? undefined : Math.round(step);
    if (step !== undefined) {
      this.#card.open = true;
      this.#slider.value = String(step);
    }
    for (const [i, { button }] of this.#frames.entries()) button.ariaCurrent = i === at ? 'step' : null;
    const { title, text } = kSteps[at ?? kLast]!;
    this.#text.textContent = at === undefined ? '' : text;
    this.#slider.ariaValueText = title;
    this.#draw(at);
  }

  /** Draws lines on the model: to the closest points, or the rays. */
  #draw(at: number | undefined): void {
    if (at === this.#lines?.of) return;
    this.#lines?.object.removeFromParent();
    this.#lines?.object.geometry.dispose();
    this.#lines?.object.material.dispose();
    this.#lines = undefined;
    if ((at === kClosest || at === kRays) && this.#session.shown) {
      const object = linesOf(
        (this.#paths ??= this.#findPaths()),
        at === kRays,
        diagonalOf(this.#session.shown.target.mesh),
      );
      this.#lines = { of: at, object };
      this.#viewer.stage.marks.add(object);
    }
    this.#viewer.redraw();
  }

  /** The paths of some vertices, evenly chosen. */
  #findPaths(): Path[] {
    const { target, cage, projection, preset } = { ...this.#session.shown!, ...this.#session.rules };
    const { mesh } = withoutParts(target, projection);
    const loops = new BoundaryLoops(cage.mesh);
    const diagonal = diagonalOf(mesh);
    const count = mesh.positions.length / 3;
    const triangles = (mesh.indices.length + cage.mesh.indices.length) / 3;
    const step = Math.max(1, count / Math.min(kMaxLines, kMaxVisits / triangles));
    const vertices = Array.from({ length: Math.floor(count / step) }, (_, i) => Math.floor(i * step));
    const scene = { target: mesh, cage: cage.mesh, loops };
    return vertices.map((vertex) =>
      pathOf(scene, { vertex, triangle: projection.triangles[vertex]!, diagonal }, presetOptions(preset)),
    );
  }

  /** Draws each frame small, once the stage is at rest. */
  async #takePictures(): Promise<void> {
    await this.#viewer.drawn();
    const { view } = this.#session;
    this.#frames.forEach(({ picture }, step) => this.#viewer.picture({ ...view, mode: 'steps', step }, picture));
  }
}

function linesOf(
  paths: readonly Path[],
  areRays: boolean,
  diagonal: number,
): LineSegments<BufferGeometry, LineBasicMaterial> {
  const [points, colors]: number[][] = [[], []];
  for (const { start, closest, normal, outcome, model, cage } of paths) {
    const length = { hidden: model, covered: cage, pokesOut: undefined, lost: undefined }[outcome]?.length;
    const end = areRays ? start.clone().addScaledVector(normal, Math.max(0, length ?? kAway * diagonal)) : closest;
    const { r, g, b } = new Color(areRays ? kRayColors[outcome] : kInk);
    points!.push(...start.toArray(), ...end.toArray());
    colors!.push(r, g, b, r, g, b);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(points!, 3));
  geometry.setAttribute('color', new Float32BufferAttribute(colors!, 3));
  const object = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, toneMapped: false }));
  object.renderOrder = 5;
  return object;
}
