// Applies a transfer to a loaded model.
import type { Mesh } from '../../api/index.js';
import { isCut } from '../../parts/cut-part.js';
import { type Apart, type Caged, moveApart as partsApart } from '../../parts/own-cages.js';
import { type Prepared, type PrepareOptions, prepareParts } from '../../parts/prepare.js';
import { prepareParts as prepareOffThread } from '../../worker/index.js';
import { wrong } from '../errors.js';
import { apply, rangesOf } from './apply.js';
import { type Applied, type ApplyOptions, checkOptions, type Saved, transferOptions } from './apply-options.js';
import { bareGroups, extractNear } from './extract-scene.js';
import type { Loaded } from './models.js';
import { ownCage } from './own-cage.js';
import { atOnce } from './remake.js';
import { checkSaved, keyOf, remember } from './saved-transfer.js';
import { type Calling, nextTask, runInTasks } from './tasks.js';

/**
 * Transfers a cage's UVs to the meshes of a scene. Each geometry gets the attributes `uv1` (2 per vertex; `uv2` or `uv3` if some
 * geometry uses `uv1` already) and `_ncz` (the `Zone`: 0 may be painted). With a texture, the materials of the meshes show it on the
 * cosmetic triangles, lit as they are, without a draw call: basic, lambert, phong, standard, physical, toon and matcap materials,
 * the MToon of three-vrm, and other `ShaderMaterial`s whose fragment shader includes `<alphatest_fragment>` as theirs do or asks for
 * paint (see below). Other materials get an overlay: a child of the mesh, drawn once more.
 *
 * The paint follows skins, morph targets, visibility, layers and copies of the model, because it is a part of its meshes. If several
 * meshes share a geometry, all but the first get a copy. If triangles at the same vertex need different UVs, copies of the vertex,
 * with all attributes and morph deltas, are added after the existing vertices. Cut borders add vertices that blend existing ones.
 * A material that already shows another paint on other meshes is copied. A later transfer of the same meshes replaces the paint and
 * the overlays; overlays of materials stay beside those of materials whose UVs have another channel.
 *
 * A `ShaderMaterial` asks for paint by `#ifdef CAGECAST_PAINT`, within which `vec3 cagecastPaint(vec3 color)` returns a colour, in
 * linear light, with the paint on it. With `WebGPURenderer` import `cagecast/three/webgpu` once: it has the same materials painted, and
 * node materials, but no `ShaderMaterial`s, which that renderer does not draw.
 *
 * Call `await init()` once before. `applyTransferAsync` keeps the main thread free.
 *
 * @param target  What GLTFLoader loaded, a scene, a mesh, or a geometry (which gets the attributes; `Applied.paint` paints its material).
 * @param options `cage`, and `texture` or `material` to show something; without these two, geometries only get the attributes.
 * @throws {CagecastError} as `transfer` does; `badOption` that names an option and its value; `badArgument` if a part cannot be read or
 * no channel of UVs is free. Then nothing is changed.
 *
 * @example
 * import { init } from 'cagecast';
 * import { applyTransfer } from 'cagecast/three';
 *
 * await init();
 * const [head, cage] = await Promise.all(['head.glb', 'cage.glb'].map((url) => loader.loadAsync(url)));
 * const paint = await new TextureLoader().loadAsync('paint.png');
 * paint.flipY = false; // as for all textures of glTF
 * paint.colorSpace = SRGBColorSpace;
 * applyTransfer(head, { cage, texture: paint });
 * scene.add(head.scene);
 */
export function applyTransfer(target: Loaded, options: ApplyOptions = {}): Applied {
  checkOptions('applyTransfer', options);
  const { saved, input, finish } = read('applyTransfer', target, options);
  return atOnce(finish(saved ?? prepareParts(...input)));
}

/**
 * As `applyTransfer`, with the transfer and all that follows from it in the worker of `cagecast/worker`; what is left for the main
 * thread, copying attributes and morph targets, is done in tasks of some milliseconds. Nothing of the model is changed before the
 * last of them. `init` is not needed. The first frame after it uploads what has changed, which three.js does in one task.
 * @param options  And `signal`, which cancels the call: the promise is rejected with its reason. And `onProgress(share, stage)`; stages are
 * `transfer`, `geometry` and `done`.
 * @throws {CagecastError} as `applyTransfer`; `superseded` if a later call for the same mesh has ended before; `badArgument` if a geometry
 * was changed by others meanwhile; and `unsupported` if the worker cannot start.
 */
export async function applyTransferAsync(target: Loaded, options: ApplyOptions & Calling = {}): Promise<Applied> {
  checkOptions('applyTransferAsync', options);
  const { signal, onProgress } = options;
  const { finish, prepared } = await prepareInWorker('applyTransferAsync', target, options);
  onProgress?.(0.7, 'geometry');
  const applied = await runInTasks(finish(prepared), signal);
  onProgress?.(1, 'done');
  return applied;
}

/**
 * What `applyTransferAsync` does in the worker, and no more: the model stays as it is, until `applyTransfer(target, { saved, texture })`
 * shows the result at once. So a model can be put into a scene when it is ready to be painted.
 * @param options  Those of `applyTransferAsync`; what is displayed does not count.
 * @returns what `deserialize` returns, which is valid for this model, wherever it is by then, and however it is posed.
 * @throws {CagecastError} as `applyTransferAsync`.
 */
export async function prepareTransfer(target: Loaded, options: ApplyOptions & Calling = {}): Promise<Saved> {
  checkOptions('prepareTransfer', options);
  const { prepared, save } = await prepareInWorker('prepareTransfer', target, options, true);
  options.onProgress?.(1, 'done');
  return save(prepared);
}

async function prepareInWorker(
  fn: string,
  target: Loaded,
  { signal, onProgress, ...options }: ApplyOptions & Calling,
  paints?: boolean,
): Promise<Call & { prepared: Prepared }> {
  signal?.throwIfAborted();
  const call = read(fn, target, options);
  const { saved, input } = call;
  await nextTask();
  signal?.throwIfAborted();
  onProgress?.(0.05, 'transfer');
  const [around, mesh, how] = input;
  const separatePaint = paints ?? how.separatePaint;
  return { ...call, prepared: saved ?? (await prepareOffThread(around, mesh, { ...how, separatePaint, signal })) };
}

/**
 * Moves the parts of a target apart, each with the cage of its name, as `applyTransfer` does: for those who call `transfer`. Limbs that
 * are near each other keep to their own cages. A result holds for the parts where they were.
 * @param cage    What `extract` returned for a cage; or its arrays, with parts that have its ranges.
 * @param target  The same of a target.
 * @returns both as `transfer` takes them, and `mend`, which makes the `triangles` of a result those of the cage; undefined if the cage is
 * one, or has other names.
 * @throws {CagecastError} `badArgument` that names a part without a cage.
 */
export const moveApart = <T extends Mesh, C extends Mesh>(cage: Caged<C>, target: Caged<T>): Apart<T, C> | undefined =>
  partsApart(cage, target, (text) => wrong(`target: ${text}`));

let calls = 0;

interface Call {
  /** What was prepared earlier. */
  saved: Prepared | undefined;
  input: [cage: Mesh | undefined, target: Mesh, options: PrepareOptions];
  /** What was prepared, for another call. */
  save(prepared: Prepared): Saved;
  /** Applies what was prepared, as `apply`. */
  finish(prepared: Prepared): Generator<void, Applied>;
}

function read(fn: string, target: Loaded, options: ApplyOptions): Call {
  const cuts = isCut(fn, options.borders);
  const { cage, cageUvs, saved, result, parts } = options;
  const call = ++calls;
  const extracted = extractNear(target, 'target', 'own', { parts, channel: options.channel });
  const own = transferOptions(options);
  const needsCage = !saved && (cuts || !result);
  const outer = needsCage ? extractNear(cage ?? ownCage(fn, target), 'cage', extracted.origin, { cageUvs }) : undefined;
  const bare = outer ? bareGroups(outer, extracted) : extracted.accessories;
  const rules = { ...own, parts: { keep: extracted.kept, exclude: [...bare, ...extracted.excluded] } };
  const apart = outer && moveApart(outer, extracted);
  const around = apart?.cage ?? outer?.mesh;
  const known = saved && checkSaved(saved, extracted);
  const save = (prepared: Prepared): Saved => ({ key: saved?.key ?? keyOf(extracted, around, rules, cuts), prepared });
  const mended = (prepared: Prepared): Prepared => {
    if (!saved) apart?.mend(prepared.result);
    return prepared;
  };
  return {
    saved: known,
    input: [
      around,
      apart?.target ?? extracted.mesh,
      {
        ...rules,
        ranges: rangesOf(extracted),
        borders: options.borders,
        separatePaint: !!options.texture && !options.material,
        result,
      },
    ],
    save: (prepared) => save(mended(prepared)),
    *finish(prepared) {
      const applied = yield* apply(extracted, mended(prepared), options, { call, cage: outer?.mesh });
      return remember(applied, () => save(prepared));
    },
  };
}
