// Scenes in which react-three-fiber shows painted models. Runs in the browser.
import { createRoot, extend, type ReconcilerRoot } from '@react-three/fiber';
import { type Cage, loadTemplate } from 'cagecast/cages';
import { Cagecast, type CagecastOptions, type Painted, useCagecast, useLayers, usePainter } from 'cagecast/react';
import type { Layers, Painter } from 'cagecast/three';
import { Component, type ReactNode, StrictMode, Suspense, startTransition, useState } from 'react';
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';
import { ball, cage, countOf, equal, flat, kSize, modelOf, offer, ok, type Scenes, white } from '../three/scenes';

extend(THREE as never);

/** What a test shows in a canvas of its own. */
class Stage {
  readonly canvas = document.createElement('canvas');
  readonly #root: ReconcilerRoot<HTMLCanvasElement> = createRoot(this.canvas);
  renderer!: THREE.WebGLRenderer;
  #onError: ((error: unknown) => void) | undefined;
  error: unknown;

  async show(element: ReactNode): Promise<void> {
    document.body.append(this.canvas);
    if (!this.renderer)
      await this.#root.configure({
        size: { width: kSize, height: kSize, top: 0, left: 0 },
        dpr: 1,
        flat: true,
        camera: { position: [0, 0, 4], fov: 40 },
        gl: (defaults) => {
          this.renderer = new THREE.WebGLRenderer({ ...(defaults as object), preserveDrawingBuffer: true });
          return this.renderer;
        },
      });
    const fail = (error: unknown): void => {
      this.error = error;
      this.#onError?.(error);
    };
    this.#root.render(
      <StrictMode>
        <ambientLight intensity={2} />
        <Boundary fail={fail}>{element}</Boundary>
      </StrictMode>,
    );
  }

  /** How many pixels are red, green and blue. */
  get colors(): number[] {
    const gl = this.renderer.getContext();
    const bytes = new Uint8Array(4 * kSize * kSize);
    gl.readPixels(0, 0, kSize, kSize, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    return ([0, 1, 2] as const).map((channel) => countOf([...bytes], channel));
  }

  /** Waits until a colour, or none, is seen. */
  async seen(color: 'red' | 'green' | 'blue' | 'none'): Promise<void> {
    await until(
      () => color === (['red', 'green', 'blue'].filter((_, i) => this.colors[i]! > 100).join() || 'none'),
      () => `${this.colors} and ${this.error}, not ${color}`,
    );
  }

  async end(): Promise<void> {
    this.#root.unmount();
    await new Promise((done) => setTimeout(done, 600)); // when the renderer is freed
    this.canvas.remove();
  }
}

class Boundary extends Component<{ fail(error: unknown): void; children: ReactNode }> {
  override state = { failed: false };
  static getDerivedStateFromError = () => ({ failed: true });
  override componentDidCatch(error: unknown): void {
    this.props.fail(error);
  }
  override render(): ReactNode {
    return this.state.failed ? null : this.props.children;
  }
}

async function until(holds: () => unknown, found: () => unknown = () => 'it never held', seconds = 30): Promise<void> {
  for (const end = performance.now() + 1000 * seconds; !holds(); ) {
    ok(performance.now() < end, found());
    await new Promise((done) => setTimeout(done, 20));
  }
}

async function frames(count: number): Promise<void> {
  for (; count > 0; --count) await new Promise(requestAnimationFrame);
}

/** What a model is painted by, for scenes to see. */
let painted: Painted | undefined;

function Model({ model, ...options }: CagecastOptions & { model: THREE.Object3D }) {
  painted = useCagecast(model, options);
  return <primitive object={model} />;
}

let setState: (change: object) => void;

/** Draws what is made of a state that scenes change. */
function Changing<State extends object>({ from, children }: { from: State; children(state: State): ReactNode }) {
  const [state, set] = useState(from);
  setState = (change) => set((before) => ({ ...before, ...change }));
  return children(state);
}

const meshOf = (model: THREE.Object3D): THREE.Mesh => model.children[0] as THREE.Mesh;
const vertices = (model: THREE.Object3D): string[] => Object.keys(meshOf(model).geometry.attributes);

const loadHuman = async (): Promise<THREE.Group> => (await new GLTFLoader().loadAsync('human/target.glb')).scene;

const scenes: Scenes = {
  'a model is painted once it is seen, and is what it was when it leaves': async () => {
    const stage = new Stage();
    const [model, around] = [modelOf(white()), cage()];
    const before = vertices(model);
    await stage.show(
      <Changing from={{ isShown: true, texture: flat(0xff0000), opacity: 1 }}>
        {({ isShown, ...options }) => isShown && <Model model={model} cage={around} {...options} />}
      </Changing>,
    );
    await stage.seen('red');
    setState({ texture: flat(0x0000ff) });
    await stage.seen('blue');
    const { applied } = painted!;
    setState({ opacity: 0 });
    await stage.seen('none');
    equal(painted!.applied === applied, true, 'the transfer');
    setState({ isShown: false });
    await until(() => model.parent === null);
    equal(vertices(model), before, 'what it has');
    setState({ isShown: true, opacity: 1 });
    await stage.seen('blue');
    await stage.end();
    equal(vertices(model), before, 'what it has');
  },

  'the model is seen with its paint from the first frame on': async () => {
    const stage = new Stage();
    const model = modelOf(white());
    await stage.show(null);
    const { render } = stage.renderer;
    const seen: boolean[] = [];
    stage.renderer.render = (...args) => {
      if (model.parent) seen.push(vertices(model).includes('uv1'));
      return render.apply(stage.renderer, args);
    };
    const around = cage();
    const texture = flat(0xff0000);
    await stage.show(<Model model={model} cage={around} texture={texture} />);
    await stage.seen('red');
    equal(seen.includes(false), false, 'an unpainted frame');
    await stage.end();
  },

  'the cage of a model that came alone is chosen': async () => {
    const stage = new Stage();
    const model = await loadHuman();
    const setRef = (is: Painted | null) => void (painted = is ?? undefined);
    await stage.show(<Cagecast model={model} template="auto" texture={flat(0xff0000)} ref={setRef} />);
    await stage.seen('red');
    equal([painted?.choice?.template, painted?.choice?.verdict], ['human-head', 'good']);
    await stage.end();
  },

  'a template is fitted, and models are swapped in transitions': async () => {
    const stage = new Stage();
    const [one, other] = await Promise.all([loadHuman(), loadHuman()]);
    const texture = flat(0xff0000);
    await stage.show(
      <Changing from={{ model: one }}>
        {({ model }) => (
          <group scale={2}>
            <Cagecast
              model={model}
              template="human-head"
              texture={texture}
              ref={(is) => {
                painted = is ?? undefined;
              }}
            />
          </group>
        )}
      </Changing>,
    );
    await stage.seen('red');
    ok(painted?.fit, painted);
    startTransition(() => setState({ model: other }));
    await new Promise((done) => setTimeout(done, 30));
    ok(one.parent && !other.parent, 'the old model is not seen any more');
    await until(() => other.parent && !one.parent);
    await stage.seen('red');
    // Those that were fitted before come at once.
    const began = performance.now();
    setState({ model: one });
    await until(() => one.parent && !other.parent);
    ok(performance.now() - began < 1000, performance.now() - began);
    const swap = async (model: THREE.Object3D): Promise<object> => {
      setState({ model });
      await until(() => model.parent && vertices(model).includes('uv1'));
      await frames(3);
      await stage.seen('red');
      return { ...stage.renderer.info.memory };
    };
    await swap(other);
    await swap(one);
    const first = await swap(other);
    for (let n = 0; n < 10; ++n) await swap(n % 2 ? other : one);
    equal(stage.renderer.info.memory, first, 'what is on the GPU');
    await stage.end();
  },

  'what nobody waits for any more is ended': async () => {
    const stage = new Stage();
    const [one, other] = await Promise.all([loadHuman(), loadHuman()]);
    const texture = flat(0xff0000);
    let ended = 0;
    const { abort } = AbortController.prototype;
    AbortController.prototype.abort = function (...args) {
      ++ended;
      return abort.apply(this, args);
    };
    await stage.show(
      <Changing from={{ model: one, opacity: 1 }}>
        {(options) => <Model template="human-head" texture={texture} {...options} />}
      </Changing>,
    );
    await until(() => painted?.applied && one.parent);
    startTransition(() => setState({ model: other }));
    await new Promise((done) => setTimeout(done, 20));
    setState({ opacity: 0.5 }); // draws what is shown once more
    await new Promise((done) => setTimeout(done, 20));
    equal(ended, 0, 'what was ended');
    startTransition(() => setState({ model: one }));
    await until(() => ended === 1);
    setState({ model: other });
    await until(() => other.parent);
    AbortController.prototype.abort = abort;
    await stage.end();
  },

  'errors reach the error boundary, and can be tried again': async () => {
    const stage = new Stage();
    const flatCage = new THREE.Mesh(ball().deleteAttribute('uv'));
    const [model, texture] = [modelOf(white()), flat(0xff0000)];
    const element = <Model model={model} cage={flatCage} texture={texture} />;
    const silence = (event: Event): void => event.preventDefault();
    addEventListener('error', silence);
    await stage.show(<Suspense key={1}>{element}</Suspense>);
    await until(() => stage.error);
    ok(/missingUvs/.test((stage.error as { code: string }).code), stage.error);
    await new Promise((done) => setTimeout(done, 1100));
    flatCage.geometry = ball(1.1);
    await stage.end();
    const again = new Stage();
    await again.show(element);
    await again.seen('red');
    removeEventListener('error', silence);
    await again.end();
  },

  'layers are what a list says, and pointers paint on them': async () => {
    const stage = new Stage();
    const [one, other, around] = [modelOf(white()), modelOf(white()), cage()];
    const [red, blue] = [flat(0xff0000), flat(0x0000ff)];
    let layers: Layers | undefined;
    let painter: Painter | undefined;
    type Given = { model: THREE.Group; items: Parameters<typeof useLayers>[0]; baseTint?: string };
    const Layered = ({ model, items, baseTint }: Given) => {
      layers = useLayers(items, { baseTint });
      const state = useCagecast(model, { cage: around, layers });
      painter = usePainter(state, { brush: { color: '#00ff00', size: 2, hardness: 1 } });
      return <primitive object={model} />;
    };
    const bottom = { texture: red, name: 'bottom' };
    await stage.show(
      <Changing from={{ model: one, items: [bottom] } as Given}>
        {(state) => <Layered {...state} />}
      </Changing>,
    );
    await stage.seen('red');
    setState({ items: [bottom, { texture: blue, opacity: 1 }] });
    await stage.seen('blue');
    setState({ items: [{ texture: blue, opacity: 1 }, bottom] });
    await stage.seen('red');
    setState({ items: [bottom, { texture: blue, opacity: 0 }] });
    await stage.seen('red');
    setState({ items: [], baseTint: '#0000ff' });
    await stage.seen('blue');
    setState({ items: [{ texture: blue, opacity: 1, roughness: 0.2 }], baseTint: '#ffffff' });
    await until(() => layers!.list[0]?.roughness === 0.2);
    setState({ items: [bottom, { texture: blue, opacity: 0 }] });
    await stage.seen('red');
    equal(layers!.list.length, 2, 'layers');
    equal(layers!.canUndo, false, 'undo');
    painter!.stroke([{ x: 0.5, y: 0.5 }]);
    await until(() => stage.colors[1]! > 100);
    equal(layers!.list.length, 3, 'layers');
    setState({ model: other });
    await until(() => other.parent && stage.colors[1]! > 100);
    setState({ items: [] });
    await until(() => layers!.list.length === 1 && stage.colors[1]! > 100);
    await stage.end();
  },

  'a list of its own gives a model layers within regions of the template': async () => {
    const stage = new Stage();
    const model = await loadHuman();
    const cheeks = { texture: flat(0xff0000), region: 'lips' };
    await stage.show(
      <Changing from={{ layers: [cheeks] }}>
        {({ layers }) => <Model model={model} template="human-head" layers={layers} />}
      </Changing>,
    );
    await until(() => painted?.layers?.list.length === 1 && painted.applied);
    equal(painted!.layers!.list[0]!.region, 'lips');
    const regions = Object.keys(((await loadTemplate('human-head')) as Cage).regions ?? {});
    ok(regions.includes('lips'), regions);
    await stage.end();
  },
};

offer(scenes);
