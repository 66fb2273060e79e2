// Paint on materials: how it looks, its cost, and its copies with a model. Runs in the browser.
import {
  MToonMaterial,
  VRMExpression,
  VRMExpressionManager,
  VRMExpressionMorphTargetBind,
  VRMFirstPerson,
  type VRMHumanoid,
  VRMUtils,
} from '@pixiv/three-vrm';
import { applyTransfer } from 'cagecast/three';
import {
  BufferAttribute,
  Color,
  DataTexture,
  Group,
  InstancedBufferAttribute,
  InstancedMesh,
  type Material,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  MeshMatcapMaterial,
  MeshPhongMaterial,
  MeshPhysicalMaterial,
  MeshStandardMaterial,
  MeshToonMaterial,
  NearestFilter,
  type Object3D,
  RawShaderMaterial,
  Raycaster,
  RedFormat,
  RepeatWrapping,
  ShaderMaterial,
  type SkinnedMesh,
  SRGBColorSpace,
  Texture,
  Vector3,
} from 'three';
import { clone } from 'three/addons/utils/SkeletonUtils.js';
import {
  ball,
  cage,
  colorsOf,
  commandsOf,
  countOf,
  difference,
  draw,
  equal,
  flat,
  halves,
  kSize,
  lookOf,
  modelOf,
  ok,
  pixelAt,
  renderer,
  type Scenes,
  skinned,
  white,
} from './scenes';

const kPaint = 0xcc3311;
const steps = new DataTexture(Uint8Array.from([90, 160, 255]), 3, 1, RedFormat);
steps.minFilter = steps.magFilter = NearestFilter;
steps.needsUpdate = true;

/** Each kind of material in a colour, opaque or not. */
const kinds: Record<string, (color: Color, opacity: number) => Material> = {
  basic: (color, opacity) => new MeshBasicMaterial({ color, opacity }),
  lambert: (color, opacity) => new MeshLambertMaterial({ color, opacity }),
  phong: (color, opacity) => new MeshPhongMaterial({ color, opacity, shininess: 60 }),
  standard: (color, opacity) => new MeshStandardMaterial({ color, opacity, roughness: 0.4 }),
  physical: (color, opacity) => new MeshPhysicalMaterial({ color, opacity, clearcoat: 1, roughness: 0.6 }),
  matcap: (color, opacity) => new MeshMatcapMaterial({ color, opacity, matcap: halves(0xffffff, 0x666666) }),
  toon: (color, opacity) => new MeshToonMaterial({ color, opacity, gradientMap: steps }),
  mtoon: (color, opacity) => {
    const material = new MToonMaterial({ shadeColorFactor: color.clone().multiply(new Color(0.5, 0.4, 0.6)) });
    material.uniforms['litFactor']!.value.copy(color);
    material.uniforms['opacity']!.value = opacity;
    return material;
  },
};

function made(kind: string, color: number, opacity: number): Material {
  const material = kinds[kind]!(new Color(color), opacity);
  material.transparent = opacity < 1;
  return material;
}

const red = (model: Object3D, layer = 0): number => colorsOf(model, layer)[0]!;
const paint = (model: Object3D) => applyTransfer(model, { cage: cage(), texture: flat(kPaint) });

export const materialScenes: Scenes = {
  'paint takes on the shading of the material below, and its opacity, without a draw call'() {
    for (const kind of Object.keys(kinds))
      for (const opacity of [1, 0.5]) {
        const model = modelOf(made(kind, 0xffffff, opacity));
        paint(model);
        const [painted, plain] = [draw(model), draw(modelOf(made(kind, kPaint, opacity)))];
        const apart = difference(painted.pixels, plain.pixels);
        ok(apart <= 2, `${kind}, opacity ${opacity}: ${apart} of 255`);
        equal(painted.calls, plain.calls, kind);
      }
  },

  'one texture paints two models with different UV sets, and stays as it was'() {
    const texture = halves(0xff0000, 0x00ff00);
    const { version, channel } = texture;
    const models = [ball(), ball()].map((geometry) => modelOf(white(), geometry));
    const { geometry } = models[1]!.children[0] as Mesh;
    geometry.setAttribute('uv1', new BufferAttribute(new Float32Array(2 * geometry.getAttribute('position').count), 2));
    const look = () => models.map((model) => colorsOf(model).slice(0, 2));
    applyTransfer(models[0]!, { cage: cage(), texture });
    const alone = look()[0]!;
    ok(Math.min(...alone) > 100, alone);
    applyTransfer(models[1]!, { cage: cage(), texture });
    equal(look(), [alone, alone]);
    for (const model of models) ((model.children[0] as Mesh).material as Material).needsUpdate = true;
    equal(look(), [alone, alone], 'the picture by programs that were compiled again');
    equal([texture.version, texture.channel], [version, channel]);
  },

  'clones are painted and morph as their model, and rays hit them once'() {
    const { model } = skinned(2);
    paint(model);
    const copy = clone(model);
    const still = red(copy);
    equal(still, red(model));
    (copy.getObjectByProperty('isSkinnedMesh', true) as SkinnedMesh).morphTargetInfluences![0] = 1;
    copy.updateMatrixWorld(true);
    ok(red(copy) > 1.3 * still, `${red(copy)} of ${still}`);
    // Of a ball the far side is culled.
    equal(new Raycaster(new Vector3(0.1, 0.1, 4), new Vector3(0, 0, -1)).intersectObject(copy, true).length, 1);
  },

  'updateMorphTargets and VRMUtils.combineMorphs leave no base bare'() {
    const [plain, vrm] = [skinned(2), skinned(6)];
    for (const { model } of [plain, vrm]) paint(model);
    const still = [plain, vrm].map(({ model }) => red(model));
    plain.mesh.updateMorphTargets();
    plain.mesh.morphTargetInfluences![0] = 1;

    const manager = new VRMExpressionManager();
    const expression = new VRMExpression('wide');
    expression.addBind(new VRMExpressionMorphTargetBind({ primitives: [vrm.mesh], index: 3, weight: 1 }));
    manager.registerExpression(expression);
    type Vrm = Parameters<typeof VRMUtils.combineMorphs>[0];
    VRMUtils.combineMorphs({ scene: vrm.model, expressionManager: manager } as unknown as Vrm);
    manager.setValue('wide', 1);
    manager.update();
    for (const [m, { model }] of [plain, vrm].entries()) {
      const { pixels } = draw(model);
      ok(countOf(pixels, 0) > 1.3 * still[m]!, `${countOf(pixels, 0)} of ${still[m]}`);
      for (let at = 0; at < pixels.length; at += 4) {
        const [r, g, b] = pixels.slice(at, at + 3) as [number, number, number];
        ok(Math.abs(r - g) >= 12 || Math.abs(g - b) >= 12, `the base at ${at / 4}`);
      }
    }
  },

  'visibility, layers, first person and render order are those of the base'() {
    const { model, mesh, bone } = skinned();
    paint(model);
    ok(red(model) > 100, red(model));
    mesh.visible = false;
    equal(red(model), 0);
    mesh.visible = true;
    mesh.layers.set(5);
    equal([red(model), red(model, 5) > 100], [0, true]);
    mesh.layers.set(0);
    const seenIn = (one: Object3D) => [0, 9, 10].map((layer) => red(one, layer) > 100);
    const humanoid = (head: Object3D) => ({ getRawBoneNode: () => head }) as unknown as VRMHumanoid;
    new VRMFirstPerson(humanoid(bone), [{ meshes: [mesh], type: 'thirdPersonOnly' }]).setup();
    equal(seenIn(model), [false, false, true]);
    const other = skinned();
    paint(other.model);
    // The head's bone moves all of it, so nothing is left of it in the first person.
    new VRMFirstPerson(humanoid(other.bone), [{ meshes: [other.mesh], type: 'auto' }]).setup();
    equal(seenIn(other.model), [false, false, true]);

    // A curtain between the camera and the model, drawn after the model and before it, whatever the depth.
    const third = modelOf(white());
    const [base] = third.children as [Mesh<typeof mesh.geometry, Material>];
    paint(third);
    const curtain = new Mesh(ball(1.05), new MeshBasicMaterial({ color: 0x00ff00, depthTest: false }));
    curtain.material.transparent = true;
    curtain.renderOrder = 3;
    third.add(curtain);
    equal(red(third), 0);
    base.renderOrder = 5;
    Object.assign(base.material, { depthTest: false, transparent: true });
    ok(red(third) > 100, red(third));
  },

  'parts without paint cost nothing'() {
    const model = modelOf(white());
    for (let i = 0; i < 7; ++i) model.add(new Mesh(ball(0.3 - 0.02 * i), white()));
    const { calls } = draw(model);
    paint(model);
    equal(draw(model).calls, calls);
    ok(red(model) > 100, red(model));
  },

  'thirty painted parts need no draw call more, and no other calls of WebGL for each of them'() {
    const models = [0, 1].map(() => {
      const model = new Group();
      for (let i = 0; i < 30; ++i) {
        const material = white();
        Object.assign(material, { map: flat(0xcccccc), normalMap: flat(0x8080ff), roughnessMap: flat(0x008000) });
        const part = new Mesh(ball(0.15), material);
        const angle = (2 * Math.PI * i) / 30;
        part.position.set(0.85 * Math.cos(angle), 0.85 * Math.sin(angle), 0.3 * Math.sin(5 * angle));
        model.add(part);
      }
      return model;
    });
    applyTransfer(models[1]!, { cage: cage(), texture: flat(kPaint), threshold: 0 });
    equal(
      models.map((model) => draw(model).calls),
      [30, 30],
    );
    const [plain, painted] = models.map(commandsOf) as [number, number];
    // The paint is bound once.
    ok(plain > 90 && painted - plain <= 5, [plain, painted]);
    ok(red(models[1]!) > 100, red(models[1]!));
  },

  'a shader that asks for paint gets it; one that does not is overlaid'() {
    const vertexShader = `void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
    const fragmentShader = `void main() {
      vec3 color = vec3(0.0, 0.0, 1.0);
      #ifdef CAGECAST_PAINT
        color = cagecastPaint(color);
      #endif
      gl_FragColor = vec4(color, 1.0);
    }`;
    const raw = {
      vertexShader: `precision highp float; attribute vec3 position; uniform mat4 projectionMatrix, modelViewMatrix; ${vertexShader}`,
      fragmentShader: 'precision highp float; void main() { gl_FragColor = vec4(0.0, 0.0, 1.0, 1.0); }',
    };
    for (const [material, overlays] of [
      [new ShaderMaterial({ vertexShader, fragmentShader }), 0],
      [new RawShaderMaterial(raw), 1],
    ] as const) {
      const model = modelOf(material);
      const { calls } = draw(model);
      paint(model);
      equal(draw(model).calls - calls, overlays, 'the number of draw calls that were added');
      const [reds, , blues] = colorsOf(model);
      ok(reds! > 100 && blues! < 10, [reds, blues]);
      ok(red(clone(model)) > 100, red(clone(model)));
    }
  },

  'changes show in the next frame; what is taken away leaves no trace'() {
    const model = modelOf(white());
    const [mesh] = model.children as [Mesh<never, MeshStandardMaterial>];
    const bare = draw(model).pixels;
    const look = () => (difference(draw(model).pixels, bare) === 0 ? 'bare' : colorsSeen());
    const colorsSeen = () => lookOf(model);
    const texture = halves(0xff0000, 0x00ff00);
    const applied = applyTransfer(model, { cage: cage(), texture });
    equal(look(), 'red,green');
    const { pixels } = draw(model);
    texture.offset.x = 0.25;
    ok(difference(draw(model).pixels, pixels) > 0, 'the texture was not moved');
    const changes: [() => unknown, string][] = [
      [() => applied.setOpacity(0), 'bare'],
      [() => applied.setOpacity(1), 'red,green'],
      [() => applied.setTexture(flat(0x00ff00)), 'green'],
      [() => applied.setTexture(undefined), 'bare'],
      [() => applied.setTexture(flat(0xff0000)), 'red'],
      [() => (mesh.material = mesh.material.clone()), 'bare'],
      [() => applied.paint(mesh.material), 'red'],
      [() => applied.dispose(), 'bare'],
      [() => applyTransfer(model, { cage: cage(), texture: flat(0x00ff00) }), 'green'],
    ];
    for (const [change, seen] of changes) {
      change();
      equal(look(), seen, `the look after ${change}`);
    }
  },

  'updates of an overlay leave nothing on the GPU'() {
    const model = modelOf(white());
    const { result, setClassification, dispose } = applyTransfer(model, {
      cage: cage(),
      material: new MeshBasicMaterial(),
    });
    const geometries = () => {
      draw(model);
      return renderer.info.memory.geometries;
    };
    const first = geometries();
    for (let i = 0; i < 6; ++i) {
      setClassification(result);
      equal(geometries(), first);
    }
    dispose();
    equal(geometries(), first - 1);
  },

  'an opaque overlay is seen whenever its material was made, also on a copy'() {
    const [first, base, last] = [new MeshBasicMaterial(), white(), new MeshBasicMaterial()];
    const counts = [first, last].flatMap((material) => {
      material.color.set(0xff0000);
      const model = modelOf(base);
      applyTransfer(model, { cage: cage(), material });
      return [red(model), red(clone(model))];
    });
    ok(counts[0]! > 100 && new Set(counts).size === 1, counts);
  },

  async 'images that are black where they are transparent have no dark fringes, near or far, nor once they change'() {
    const striped = async (color: string, side = 128) => {
      const canvas = new OffscreenCanvas(side, side);
      const context = canvas.getContext('2d')!;
      context.fillStyle = color;
      for (let x = 0; x < side; x += 16) context.fillRect(x + 3, 0, 7, side);
      const options = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' } as const;
      return createImageBitmap(await canvas.convertToBlob(), options);
    };
    for (const far of [1, 6]) {
      const texture = new Texture(await striped('#ff0000'));
      Object.assign(texture, { flipY: false, colorSpace: SRGBColorSpace, needsUpdate: true });
      texture.repeat.setScalar(far);
      texture.wrapS = texture.wrapT = RepeatWrapping;
      const material = new MeshBasicMaterial({ color: 0xff0000 });
      const model = modelOf(material);
      const applied = applyTransfer(model, { cage: cage(), texture });
      const { textures } = renderer.info.memory;
      const darkest = (channel: number) => {
        const { pixels } = draw(model);
        const own = pixels.filter((_, at) => at % 4 === channel && pixels[at - channel + ((channel + 1) % 3)]! < 30);
        ok(own.length > 800, own.length);
        return Math.min(...own);
      };
      ok(darkest(0) > 250, `red ${darkest(0)}, ${far} times`);
      material.color.set(0x00ff00);
      texture.image = await striped('#00ff00', 64);
      texture.needsUpdate = true;
      ok(darkest(1) > 250, `green ${darkest(1)}, ${far} times`);
      equal(texture.image.width, 64, 'the texture');
      texture.dispose();
      applied.dispose();
      equal(renderer.info.memory.textures <= textures, true, 'textures');
    }
  },

  'a soft border fades inside the painted zone'() {
    const around = ball(1.1);
    // Without its upper half.
    const { array } = around.getAttribute('position');
    around.setIndex([...around.index!.array].filter((_, i, all) => array[3 * all[i - (i % 3)]! + 1]! < 0.3));
    const [hard, soft] = [0, 0.25].map((feather) => {
      const model = modelOf(new MeshBasicMaterial({ color: 0x0000ff }));
      applyTransfer(model, { cage: new Mesh(around), texture: flat(0xff0000), feather });
      const { pixels } = draw(model);
      // From below upwards, through the middle.
      return Array.from({ length: kSize }, (_, y) => pixelAt(pixels, kSize / 2, y)[0]!);
    }) as [number[], number[]];
    const [first, last] = [hard.indexOf(255), hard.lastIndexOf(255)];
    equal(soft[first + 2], 255);
    // From the lower end of the model to the border.
    const rest = soft.slice(first + 2, last + 1);
    rest.slice(1).forEach((value, i) => ok(value <= rest[i]! + 1, rest));
    ok(rest.filter((value) => value > 0 && value < 255).length >= 4 && rest.at(-1)! < 60, rest);
    soft.forEach((value, y) => ok(value <= hard[y]!, `${y}: ${value} of ${hard[y]}`));
  },

  'instances share their paint, and attributes of instances stay as they are'() {
    const mesh = new InstancedMesh(ball(0.4), white(), 2);
    mesh.setMatrixAt(0, new Matrix4().makeTranslation(-0.6, 0, 0));
    mesh.setMatrixAt(1, new Matrix4().makeTranslation(0.6, 0, 0));
    const model = new Group().add(mesh);
    const around = new Mesh(ball(0.5));
    around.position.x = -0.6;
    paintWith(model, around);
    const { pixels, calls } = draw(model);
    equal(calls, 1);
    for (const isLeft of [true, false]) {
      const half = pixels.filter((_, i) => Math.floor(i / 4) % kSize < kSize / 2 === isLeft);
      ok(countOf(half, 0) > 100, countOf(half, 0));
    }
    for (const count of [2, 500]) {
      const many = new InstancedMesh(ball(), white(), count);
      for (let i = 0; i < count; ++i) many.setMatrixAt(i, new Matrix4());
      const ids = Float32Array.from({ length: count }, (_, i) => i);
      many.geometry.setAttribute('_id', new InstancedBufferAttribute(ids, 1));
      const { splitVertices } = paintWith(new Group().add(many), cage());
      const after = many.geometry.getAttribute('_id');
      equal([splitVertices > 0, after.count, after.getX(count - 1)], [true, count, count - 1]);
    }
  },
};

const paintWith = (model: Object3D, around: Mesh) => applyTransfer(model, { cage: around, texture: flat(kPaint) });
