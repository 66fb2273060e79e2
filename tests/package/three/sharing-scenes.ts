// What others have to do with a painted model, too: its materials, their hooks, earlier transfers. Runs in the browser.
import { applyTransfer, createLayers, createPainter } from 'cagecast/three';
import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  ShaderMaterial,
  SRGBColorSpace,
  VideoTexture,
} from 'three';
import {
  ball,
  cage,
  camera,
  colorsOf,
  countOf,
  draw,
  equal,
  flat,
  kSize,
  lookOf,
  middleOf,
  modelOf,
  near,
  ok,
  ray,
  renderer,
  type Scenes,
  skinned,
  white,
} from './scenes';

const [red, green, blue] = [() => flat(0xff0000), () => flat(0x00ff00), () => flat(0x0000ff)];

export const sharingScenes: Scenes = {
  'where its material is shared, a mesh that is not painted stays as it was'() {
    const material = white();
    const [head, body] = [new Mesh(ball(0.5), material), new Mesh(ball(0.5), material)];
    head.position.y = 0.6;
    body.position.y = -0.6;
    const around = new Mesh(ball(0.55));
    around.position.y = 0.6;
    const model = new Group().add(head, body);
    const lower = () => countOf(draw(model).pixels.slice(0, (4 * kSize * kSize) / 2), 0);
    const before = lower();
    applyTransfer(head, { cage: around, texture: red() });
    equal(lower(), before);
  },

  'materials that share their uniforms have paint of their own, and no other uniforms than before'() {
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
      return { model, applied: applyTransfer(model, { cage: cage(), texture }) };
    }) as [{ model: Group; applied: ReturnType<typeof applyTransfer> }, { model: Group }];
    const look = () => [lookOf(a.model), lookOf(b.model)];
    for (let frame = 0; frame < 2; ++frame) equal(look(), ['red', 'green']);
    a.applied.dispose();
    equal(look(), ['blue', 'green']);
    uniforms.light.value = 0;
    equal(look(), ['none', 'none'], 'the look without light');
    equal(Object.keys(uniforms), ['light']);
  },

  'hooks of others stay, wherever they are'() {
    class Own extends MeshStandardMaterial {
      readonly #mode = 1;
      override customProgramCacheKey(): string {
        return `own ${this.#mode}`;
      }
    }
    const own = modelOf(new Own({ color: 0xbbbbbb }));
    draw(own);
    applyTransfer(own, { cage: cage(), texture: red() });
    equal(lookOf(own), 'red', 'the look of a class that reads what is private');

    const wrapped = white();
    const model = modelOf(wrapped);
    const first = applyTransfer(model, { cage: cage(), texture: red() });
    draw(model);
    const { onBeforeCompile, customProgramCacheKey } = wrapped;
    wrapped.onBeforeCompile = (shader, one) => {
      onBeforeCompile.call(wrapped, shader, one);
      const last = '#include <opaque_fragment>';
      shader.fragmentShader = shader.fragmentShader.replace(last, `${last}\ngl_FragColor.b = 1.0;`);
    };
    wrapped.customProgramCacheKey = () => `${customProgramCacheKey.call(wrapped)} blue`;
    wrapped.needsUpdate = true;
    const isBlue = () => middleOf(model)[2] === 255;
    const isRed = () => middleOf(model)[0]! > 2 * middleOf(model)[1]!;
    equal([isRed(), isBlue()], [true, true], 'red and blue of a hook that wraps ours');
    first.dispose();
    equal([isRed(), isBlue()], [false, true]);
    applyTransfer(model, { cage: cage(), texture: red() });
    equal([isRed(), isBlue()], [true, true]);

    const replaced = white();
    const other = modelOf(replaced);
    applyTransfer(other, { cage: cage(), texture: red() });
    replaced.onBeforeRender = () => {};
    equal(lookOf(other), 'red', 'the look after onBeforeRender was replaced');

    // A hook that is replaced takes the paint away, until the next texture.
    const third = applyTransfer(model, { cage: cage(), texture: red() });
    equal([isRed(), isBlue()], [true, true]);
    wrapped.onBeforeCompile = () => {};
    wrapped.needsUpdate = true;
    equal(isRed(), false);
    third.setTexture(red());
    equal(isRed(), true);
  },

  'a transfer that was replaced changes nothing any more'() {
    const model = modelOf(white());
    const first = applyTransfer(model, { cage: cage(), texture: red() });
    const second = applyTransfer(model, { cage: cage(), texture: green() });
    equal(lookOf(model), 'green');
    first.setTexture(blue());
    equal(lookOf(model), 'green');
    first.setClassification(first.result);
    second.setOpacity(0);
    equal(lookOf(model), 'none');
    second.setOpacity(1);
    first.dispose();
    equal(lookOf(model), 'green');
  },

  'a transfer shows its paint again when one in another channel is disposed of, not if one has taken its place'() {
    const model = modelOf(white());
    const look = applyTransfer(model, { cage: cage(), texture: red() });
    const other = applyTransfer(model, { cage: cage(), texture: green(), channel: 2 });
    equal(lookOf(model), 'green');
    other.dispose();
    look.setTexture(blue());
    equal(lookOf(model), 'blue');
    applyTransfer(model, { cage: cage(), texture: green() }).dispose();
    look.setTexture(blue());
    equal(lookOf(model), 'none');
  },

  'the material of two models goes on showing the paint of each, whichever transfers end'() {
    const shared = white();
    const [a, b] = [modelOf(shared), modelOf(shared)];
    applyTransfer(a, { cage: cage(), texture: red() });
    const first = applyTransfer(b, { cage: cage(), texture: green() });
    const look = () => [lookOf(a), lookOf(b)];
    equal(look(), ['red', 'green']);
    const second = applyTransfer(b, { cage: cage(), texture: blue() });
    equal(look(), ['red', 'blue']);
    first.dispose();
    equal(look(), ['red', 'blue']);
    second.dispose();
    equal(look(), ['red', 'none']);
    ok((b.children[0] as Mesh).material === shared, 'another material than the original');
  },

  'meshes elsewhere with the same vertices, and overlays, are drawn whatever is done to the model'() {
    for (const turn of [0, 1]) {
      const geometry = ball();
      /** As GLTFLoader makes such: its own index, and the same attributes. */
      const share = (into: BufferGeometry) => {
        into.setIndex(new BufferAttribute(geometry.index!.array.slice(), 1));
        for (const [name, attribute] of Object.entries(geometry.attributes)) into.setAttribute(name, attribute);
        return into;
      };
      const shared = share(new BufferGeometry());
      const other = new Group().add(new Mesh(shared, new MeshBasicMaterial({ color: 0xff0000 })));
      const model = modelOf(white(), geometry);
      const around = cage().rotateY(turn);
      const [before] = colorsOf(other);
      ok(before! > 100, before);
      const isDrawn = (what: string) => {
        draw(model);
        equal(colorsOf(other)[0], before, `the other mesh after ${what}`);
      };
      isDrawn('it was drawn');
      const first = applyTransfer(model, { cage: around, texture: blue() });
      ok(first.splitVertices > 0 || turn === 0, 'no vertex was split');
      isDrawn('a texture');
      applyTransfer(model, { cage: around, material: new MeshBasicMaterial({ color: 0x00ff00 }) });
      isDrawn('an overlay');
      const overlaid = colorsOf(model)[1]!;
      const third = applyTransfer(model, { cage: around, channel: 2 });
      isDrawn('other UVs');
      third.dispose();
      isDrawn('the end of those');
      first.dispose();
      isDrawn('the end of the texture');
      share(shared); // what the model has now
      isDrawn('it shares again');
      const fourth = applyTransfer(model, { cage: around, channel: 2 });
      isDrawn('other UVs again');
      fourth.dispose();
      isDrawn('the end of all');
      ok(overlaid > 0 && overlaid === colorsOf(model)[1], 'the overlay is gone');
    }
  },

  'paint that comes and goes leaves nothing on the GPU'() {
    const model = modelOf(white());
    const texture = red();
    draw(model);
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
    /** Does something several times, after which there must be as much as after the first time. */
    const repeat = (what: string, run: () => void, count: () => unknown) => {
      const counts = [0, 1, 2, 3].map(() => {
        run();
        return JSON.stringify(count());
      });
      equal(new Set(counts).size, 1, `${what}: ${counts.join(' ')}; the number of different counts`);
    };
    const programs = () => renderer.info.programs!.length;
    const applied = applyTransfer(model, { cage: cage(), texture });
    const toggle = () => {
      draw(model);
      applied.setTexture(undefined);
      draw(model);
      applied.setTexture(texture);
    };
    repeat('textures', toggle, programs);
    applied.dispose();
    const apply = () => {
      const one = applyTransfer(model, { cage: cage(), texture });
      draw(model);
      one.dispose();
      draw(model);
    };
    repeat('transfers', apply, () => [programs(), buffers]);
    Object.assign(gl, { createBuffer, deleteBuffer });
    const around = cage();
    const paint = () => {
      const one = applyTransfer(model, { cage: around, texture });
      const painter = createPainter({ renderer, texture, applied: one, cage: around });
      painter.stroke([{ x: 0.3, y: 0.5 }]);
      painter.update();
      draw(model);
      painter.dispose();
      painter.layers.dispose();
      one.dispose();
    };
    repeat('painters', paint, () => renderer.info.memory.textures);
  },

  'skinned meshes are targets by themselves, and picked where their bones have moved them'() {
    const around = cage();
    around.position.x = 5;
    const [ofModel, ofMesh] = (['model', 'mesh'] as const).map((of) => {
      const one = skinned();
      one.model.position.x = 5;
      return applyTransfer(one[of], { cage: around }).result.cosmeticTriangles.filter((isCosmetic) => isCosmetic === 1)
        .length;
    });
    ok(ofModel! > 100 && ofMesh === ofModel, [ofModel, ofMesh]);
    const { model, bone } = skinned();
    const applied = applyTransfer(model, { cage: cage(), texture: red() });
    const painter = createPainter({ renderer, texture: red(), applied, cage: cage() });
    new Box3().setFromObject(model); // Three.js keeps this, too.
    ok(painter.pick(ray(kSize / 2, kSize / 2)), 'nothing is picked');
    bone.position.x = 3;
    camera.position.x = 3;
    model.updateMatrixWorld(true);
    ok(painter.pick(ray(kSize / 2, kSize / 2))?.uv, 'nothing is picked where it is now');
    camera.position.x = 0;
    equal(painter.pick(ray(kSize / 2, kSize / 2)), undefined, 'what is picked where it was');
  },

  'where a ray meets nothing, nothing is painted; a list of materials may have a gap'() {
    const model = modelOf(white());
    const applied = applyTransfer(model, { cage: cage(), texture: red() });
    const painter = createPainter({ renderer, texture: red(), applied, cage: cage() });
    const miss = painter.pick(ray(0, 0));
    equal(miss, undefined);
    painter.stroke([{ x: 0.3, y: 0.5 }, miss, { x: 0.6, y: 0.5 }]);
    equal(painter.undo(), 'stroke');
    painter.sticker({ text: '07', color: '#ffffff' }, { at: miss });
    painter.erase([miss]);
    equal(painter.canUndo, false);
    const geometry = ball();
    const corners = geometry.index!.count;
    geometry.clearGroups();
    geometry.addGroup(0, 600, 0);
    geometry.addGroup(600, corners - 600, 2);
    const list = [white(), undefined, white()] as MeshStandardMaterial[];
    const gap = new Group().add(new Mesh(geometry, list));
    applyTransfer(gap, { cage: cage(), texture: red() });
    equal(lookOf(gap), 'red');
  },

  async 'a video as a layer looks as it does as paint'() {
    const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 64 });
    const context = canvas.getContext('2d')!;
    const filling = setInterval(() => {
      context.fillStyle = 'rgb(128, 128, 128)';
      context.fillRect(0, 0, 64, 64);
    }, 30);
    const video = Object.assign(document.createElement('video'), { muted: true, srcObject: canvas.captureStream(30) });
    await video.play();
    await new Promise<void>((done) => video.requestVideoFrameCallback(() => done()));
    const texture = new VideoTexture(video);
    texture.colorSpace = SRGBColorSpace;
    const model = modelOf(new MeshBasicMaterial());
    const applied = applyTransfer(model, { cage: cage(), texture });
    texture.needsUpdate = true;
    const alone = middleOf(model);
    near(alone, [128, 128, 128]);
    const layers = createLayers({ renderer });
    layers.add(texture);
    layers.update();
    applied.setTexture(layers.texture);
    near(middleOf(model), alone, 2);
    clearInterval(filling);
  },
};
