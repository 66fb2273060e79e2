// Scenes of what others have to do with a painted model too: its materials, their hooks, earlier transfers. Runs in the browser.
import { applyTransfer } from 'cagecast/three';
import { createLayers } from 'cagecast/three/paint';
import { createPainter } from 'cagecast/three/paint';
import {
  Bone,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  type Object3D,
  Raycaster,
  ShaderMaterial,
  Skeleton,
  SkinnedMesh,
  SRGBColorSpace,
  Vector3,
  VideoTexture,
} from 'three';
import { ball, cage, camera, countOf, draw, flat, kSize, modelOf, renderer } from './scenes';

const white = (): MeshStandardMaterial => new MeshStandardMaterial({ color: 0xbbbbbb });
const [red, green, blue] = [() => flat(0xff0000), () => flat(0x00ff00), () => flat(0x0000ff)];

/** How many pixels of a model are red, green and blue. */
const seen = (model: Object3D, from = camera): number[] => {
  const { pixels } = draw(model, 0, from);
  return ([0, 1, 2] as const).map((channel) => countOf(pixels, channel));
};
/** The colour in the middle of the picture. */
const middle = (model: Object3D): number[] => {
  const at = 4 * (kSize * (kSize / 2) + kSize / 2);
  return draw(model).pixels.slice(at, at + 3);
};
const ray = (x: number): Raycaster => new Raycaster(new Vector3(x, 0.05, 4), new Vector3(0, 0, -1));

function skinned(): { model: Group; mesh: SkinnedMesh; bone: Bone } {
  const geometry = ball();
  const { count } = geometry.getAttribute('position');
  geometry.setAttribute('skinIndex', new BufferAttribute(new Uint16Array(4 * count), 4));
  const weights = Float32Array.from({ length: 4 * count }, (_, i) => Number(i % 4 === 0));
  geometry.setAttribute('skinWeight', new BufferAttribute(weights, 4));
  const [mesh, bone] = [new SkinnedMesh(geometry, white()), new Bone()];
  mesh.frustumCulled = false;
  mesh.bind(new Skeleton([bone]));
  return { model: new Group().add(bone, mesh), mesh, bone };
}

export const sharingScenes: Record<string, () => unknown> = {
  /** A head is painted whose material the body has, too; and of two models with one material, one is made bare again. */
  sharedMaterial() {
    const material = white();
    const [head, body] = [new Mesh(ball(0.5), material), new Mesh(ball(0.5), material)];
    head.position.y = 0.6;
    body.position.y = -0.6;
    const around = new Mesh(ball(0.55));
    around.position.y = 0.6;
    const model = new Group().add(head, body);
    const lower = () => countOf(draw(model).pixels.slice(0, (4 * kSize * kSize) / 2), 0);
    const before = lower();
    applyTransfer(head, around, { texture: red() });
    const shared = white();
    const [a, b] = [modelOf(shared), modelOf(shared)];
    applyTransfer(a, cage(), { texture: red() });
    const applied = applyTransfer(b, cage(), { texture: green() });
    const both = [seen(a), seen(b)];
    applied.dispose();
    return { body: lower() - before, both, left: [seen(a), seen(b)] };
  },

  /** Two materials with one object of uniforms, one of which is made bare again; a uniform of theirs changes. */
  sharedUniforms() {
    const uniforms = { light: { value: 1 } };
    const [a, b] = [red(), green()].map((texture) => {
      const material = new ShaderMaterial({
        uniforms,
        vertexShader: 'void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }',
        fragmentShader: `uniform float light;
          void main() {
            vec3 color = vec3(0.0, 0.0, 1.0);
            #ifdef CAGECAST_PAINT
              color = cagecastPaint(color);
            #endif
            gl_FragColor = vec4(light * color, 1.0);
          }`,
      });
      const model = modelOf(material);
      return { model, applied: applyTransfer(model, cage(), { texture }) };
    }) as [{ model: Group; applied: ReturnType<typeof applyTransfer> }, { model: Group }];
    const look = () => [middle(a.model), middle(b.model)];
    const frames = [look(), look()];
    a.applied.dispose();
    frames.push(look());
    uniforms.light.value = 0;
    frames.push(look());
    return { frames, names: Object.keys(uniforms) };
  },

  /** Hooks of others: a class that reads what is private, one that wraps ours, one that takes the place of ours. */
  hooks() {
    class Own extends MeshStandardMaterial {
      readonly #mode = 1;
      override customProgramCacheKey(): string {
        return `own ${this.#mode}`;
      }
    }
    const own = modelOf(new Own({ color: 0xbbbbbb }));
    draw(own);
    applyTransfer(own, cage(), { texture: red() });

    const wrapped = white();
    const model = modelOf(wrapped);
    const first = applyTransfer(model, cage(), { texture: red() });
    draw(model);
    const { onBeforeCompile, customProgramCacheKey } = wrapped;
    wrapped.onBeforeCompile = (shader, one) => {
      onBeforeCompile.call(wrapped, shader, one);
      shader.fragmentShader = shader.fragmentShader.replace(
        '#include <opaque_fragment>',
        '#include <opaque_fragment>\ngl_FragColor.b = 1.0;',
      );
    };
    wrapped.customProgramCacheKey = () => `${customProgramCacheKey.call(wrapped)} blue`;
    wrapped.needsUpdate = true;
    const isBlue = () => middle(model)[2] === 255;
    const isRed = () => middle(model)[0]! > 2 * middle(model)[1]!;
    const wrapping = [[isRed(), isBlue()]];
    first.dispose();
    wrapping.push([isRed(), isBlue()]);
    applyTransfer(model, cage(), { texture: red() });
    wrapping.push([isRed(), isBlue()]);

    const replaced = white();
    const other = modelOf(replaced);
    applyTransfer(other, cage(), { texture: red() });
    replaced.onBeforeRender = () => {};
    // A hook that is replaced takes the paint away, until the next texture.
    const third = applyTransfer(model, cage(), { texture: red() });
    const renewedWrapping = [isRed(), isBlue()];
    wrapped.onBeforeCompile = () => {};
    wrapped.needsUpdate = true;
    const renewed = [isRed()];
    third.setTexture(red());
    renewed.push(isRed());
    return { own: seen(own)[0]! > 100, wrapping, replaced: seen(other)[0]! > 100, renewed, renewedWrapping };
  },

  /** A transfer that was replaced, whose texture comes late. */
  replaced() {
    const model = modelOf(white());
    const first = applyTransfer(model, cage(), { texture: red() });
    const second = applyTransfer(model, cage(), { texture: green() });
    const colors = () => seen(model).map((count) => count > 100);
    const looks = [colors()];
    first.setTexture(blue());
    looks.push(colors());
    first.update(first.result);
    second.setOpacity(0);
    looks.push(colors());
    second.setOpacity(1);
    first.dispose();
    looks.push(colors());
    return looks;
  },

  /** A preview over a look ends, and the look gets another colour. */
  preview() {
    const model = modelOf(white());
    const look = applyTransfer(model, cage(), { texture: red() });
    applyTransfer(model, cage(), { texture: green() }).dispose();
    look.setTexture(blue());
    return seen(model).map((count) => count > 100);
  },

  /** Of two models with one material, one gets another paint; then its first transfer is disposed of, then its second. */
  replacedOnShared() {
    const shared = white();
    const [a, b] = [modelOf(shared), modelOf(shared)];
    applyTransfer(a, cage(), { texture: red() });
    const first = applyTransfer(b, cage(), { texture: green() });
    const second = applyTransfer(b, cage(), { texture: blue() });
    const look = () => [a, b].map((model) => seen(model).findIndex((count) => count > 100));
    const looks = [look()];
    first.dispose();
    looks.push(look());
    second.dispose();
    looks.push(look());
    return { looks, isOriginal: (b.children[0] as Mesh).material === shared };
  },

  /**
   * A mesh elsewhere that has the attributes of a model, as GLTFLoader makes such: its red pixels after each thing that is done to
   * the model, and whether the model's overlay stays.
   */
  sharedVertices() {
    return [0, 1].map((turn) => {
      const geometry = ball();
      const shared = new BufferGeometry().setIndex(new BufferAttribute(geometry.index!.array.slice(), 1));
      for (const [name, attribute] of Object.entries(geometry.attributes)) shared.setAttribute(name, attribute);
      const other = new Group().add(new Mesh(shared, new MeshBasicMaterial({ color: 0xff0000 })));
      const model = modelOf(white(), geometry);
      const around = cage().rotateY(turn);
      const counts: number[] = [];
      const look = (): void => {
        draw(model);
        counts.push(seen(other)[0]!);
      };
      look();
      const first = applyTransfer(model, around, { texture: blue() });
      look();
      applyTransfer(model, around, { material: new MeshBasicMaterial({ color: 0x00ff00 }) });
      look();
      const overlaid = seen(model)[1]!;
      const third = applyTransfer(model, around, { channel: 2 });
      look();
      third.dispose();
      look();
      first.dispose();
      look();
      // Of what the model has now.
      shared.setIndex(new BufferAttribute(geometry.index!.array.slice(), 1));
      for (const [name, attribute] of Object.entries(geometry.attributes)) shared.setAttribute(name, attribute);
      look();
      const fourth = applyTransfer(model, around, { channel: 2 });
      look();
      fourth.dispose();
      look();
      return { counts, splits: first.splitVertices, overlaid: overlaid > 0 && overlaid === seen(model)[1] };
    });
  },

  /** Programs, buffers and textures on the GPU, while paint comes and goes. */
  leaks() {
    const model = modelOf(white());
    const texture = red();
    draw(model);
    const counts: Record<string, number[]> = { textures: [], transfers: [], buffers: [], painters: [] };
    let buffers = 0;
    const gl = renderer.getContext();
    const { createBuffer, deleteBuffer } = gl;
    gl.createBuffer = () => {
      ++buffers;
      return createBuffer.call(gl);
    };
    gl.deleteBuffer = (buffer) => {
      --buffers;
      deleteBuffer.call(gl, buffer);
    };
    const applied = applyTransfer(model, cage(), { texture });
    for (let i = 0; i < 4; ++i) {
      draw(model);
      applied.setTexture(undefined);
      draw(model);
      applied.setTexture(texture);
      counts['textures']!.push(renderer.info.programs!.length);
    }
    applied.dispose();
    for (let i = 0; i < 4; ++i) {
      const one = applyTransfer(model, cage(), { texture });
      draw(model);
      one.dispose();
      draw(model);
      counts['transfers']!.push(renderer.info.programs!.length);
      counts['buffers']!.push(buffers);
    }
    Object.assign(gl, { createBuffer, deleteBuffer });
    const around = cage();
    for (let i = 0; i < 3; ++i) {
      const one = applyTransfer(model, around, { texture });
      const painter = createPainter({ renderer, texture, applied: one, cage: around });
      painter.stroke([{ x: 0.3, y: 0.5 }]);
      painter.update();
      draw(model);
      painter.dispose();
      painter.layers.dispose();
      one.dispose();
      counts['painters']!.push(renderer.info.memory.textures);
    }
    return counts;
  },

  /** A skinned mesh as the target, whose bones were moved with the model; and picks where the bones have moved it since. */
  bones() {
    const around = cage();
    around.position.x = 5;
    const counts = (['model', 'mesh'] as const).map((of) => {
      const one = skinned();
      one.model.position.x = 5;
      return applyTransfer(one[of], around, {}).result.cosmeticTriangles.reduce(
        (sum, isCosmetic) => sum + isCosmetic,
        0,
      );
    });
    const { model, bone } = skinned();
    const applied = applyTransfer(model, cage(), { texture: red() });
    const painter = createPainter({ renderer, texture: red(), applied, cage: cage() });
    new Box3().setFromObject(model); // Three.js keeps this, too.
    const before = painter.pick(ray(0)) !== undefined;
    bone.position.x = 3;
    model.updateMatrixWorld(true);
    return { counts, picks: [before, painter.pick(ray(0)) !== undefined, painter.pick(ray(3))?.uv !== undefined] };
  },

  /** Instances with an attribute of their own. */
  instanceAttributes() {
    return [2, 500].map((count) => {
      const mesh = new InstancedMesh(ball(), white(), count);
      for (let i = 0; i < count; ++i) mesh.setMatrixAt(i, new Matrix4());
      mesh.geometry.setAttribute(
        '_id',
        new InstancedBufferAttribute(
          Float32Array.from({ length: count }, (_, i) => i),
          1,
        ),
      );
      const { splitVertices } = applyTransfer(new Group().add(mesh), cage(), { texture: red() });
      const ids = mesh.geometry.getAttribute('_id');
      return { split: splitVertices > 0, ids: ids.count, last: ids.getX(count - 1) };
    });
  },

  /** What rays miss, and lists of materials with a gap. */
  nothing() {
    const model = modelOf(white());
    const applied = applyTransfer(model, cage(), { texture: red() });
    const painter = createPainter({ renderer, texture: red(), applied, cage: cage() });
    painter.stroke([{ x: 0.3, y: 0.5 }, painter.pick(ray(9)), { x: 0.6, y: 0.5 }]);
    const { canUndo } = painter;
    painter.sticker({ text: '07', color: '#ffffff' }, { at: painter.pick(ray(9)) });
    painter.erase([painter.pick(ray(9))]);
    const geometry = ball();
    const corners = geometry.index!.count;
    geometry.clearGroups();
    geometry.addGroup(0, 600, 0);
    geometry.addGroup(600, corners - 600, 2);
    const list = [white(), undefined, white()] as MeshStandardMaterial[];
    const gap = new Group().add(new Mesh(geometry, list));
    applyTransfer(gap, cage(), { texture: red() });
    return { canUndo, red: seen(gap)[0]! > 100 };
  },
};

export const videoScenes: Record<string, () => Promise<unknown>> = {
  /** A grey video, as paint and as a layer. */
  async video() {
    const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 64 });
    const context = canvas.getContext('2d')!;
    const fill = () => {
      context.fillStyle = 'rgb(128, 128, 128)';
      context.fillRect(0, 0, 64, 64);
    };
    const filling = setInterval(fill, 30);
    const video = Object.assign(document.createElement('video'), { muted: true, srcObject: canvas.captureStream(30) });
    await video.play();
    await new Promise<void>((done) => video.requestVideoFrameCallback(() => done()));
    const texture = new VideoTexture(video);
    texture.colorSpace = SRGBColorSpace;
    const model = modelOf(new MeshBasicMaterial());
    const applied = applyTransfer(model, cage(), { texture });
    texture.needsUpdate = true;
    const alone = middle(model);
    const layers = createLayers({ renderer });
    layers.add(texture);
    layers.update();
    applied.setTexture(layers.texture);
    const layered = middle(model);
    clearInterval(filling);
    return { alone, layered };
  },
};
