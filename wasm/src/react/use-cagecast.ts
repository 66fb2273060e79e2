import { use, useEffect, useLayoutEffect, useState } from 'react';
import { type Applied, type ApplyOptions, applyTransfer, type Loaded } from '../three/index.js';
import type { Layers } from '../three/internals.js';
import { type Fitted, type FittingOptions, Holder, taskOf } from './tasks.js';
import { type LayerItem, useOwnLayers } from './use-layers.js';

/** Options of `useCagecast`: those of `applyTransfer`, a template to be fitted, and layers. */
export interface CagecastOptions
  extends FittingOptions,
    Pick<ApplyOptions, 'texture' | 'material' | 'opacity' | 'feather'> {
  /** What to show instead of one `texture`: what `useLayers` returned, or the layers of a stack of its own. */
  layers?: Layers | readonly LayerItem[] | undefined;
}

/** What a model is painted by. */
export interface Painted extends Pick<Fitted, 'cage' | 'fit' | 'choice'> {
  /** Undefined until the model is in the scene. */
  applied: Applied | undefined;
  /** The stack that is shown; undefined without layers, and until it is made. */
  layers: Layers | undefined;
}

/**
 * Paints a loaded model for as long as the component is mounted: fits a template to it, or takes its cage, transfers, and shows a texture
 * or layers. It suspends until fit and transfer, which run in workers, are ready; the model is changed when it is put into the scene, and
 * is what it was when the component leaves or gets another model. So a swap within a transition shows the old one until the new one is
 * painted. Fits and transfers are kept as long as their model: a second time they take no time. What no component waits for any more is
 * ended, unless it was begun by one that was never shown.
 *
 * Of components that paint the same model the last one counts: give others a copy, as `SkeletonUtils.clone` makes it.
 * @param model    What GLTFLoader loaded, a scene or a mesh.
 * @param options  Of `template` and `cage` one; without both the model has to have its cages with it. Options that are plain data may be made
 * anew each time; models, typed arrays and textures must be the same objects, so make them outside of the component. Functions are
 * the same if their code is.
 * @throws {CagecastError} to the nearest error boundary, as `fitCage` and `applyTransfer`.
 *
 * @example
 * function Avatar({ url, paint }) {
 *   const gltf = useLoader(GLTFLoader, url);
 *   useCagecast(gltf, { template: 'human-head', texture: paint });
 *   return <primitive object={gltf.scene} />;
 * }
 */
export function useCagecast(model: Loaded, options: CagecastOptions = {}): Painted {
  const { texture, material, opacity, feather, layers: given, ...preparing } = options;
  const task = taskOf(model, preparing);
  const [holder] = useState(() => new Holder());
  holder.want(task);
  const { cage, fit, choice, saved } = use(task.promise);
  useEffect(() => holder.mount(), [holder]);

  const own = useOwnLayers(isList(given) ? given : undefined, cage, undefined);
  const layers = isList(given) ? own : given;
  const shown = layers?.texture ?? texture;
  const [state, setState] = useState<{ of: Fitted['saved']; applied: Applied }>();
  useLayoutEffect(() => {
    const { channel, parts } = preparing;
    const applied = applyTransfer(model, { saved, channel, parts, texture: shown, material, opacity, feather });
    setState({ of: saved, applied });
    return () => applied.dispose();
    // What else is given is either a part of what was prepared, or changed below.
  }, [model, saved, material, feather]);
  const applied = state?.of === saved ? state.applied : undefined;
  useLayoutEffect(() => applied?.setTexture(shown), [applied, shown]);
  useLayoutEffect(() => applied?.setOpacity(opacity ?? 1), [applied, opacity]);
  return { cage, fit, choice, applied, layers };
}

const isList = (layers: CagecastOptions['layers']): layers is readonly LayerItem[] => Array.isArray(layers);
