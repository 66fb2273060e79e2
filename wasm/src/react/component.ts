import { createElement, type ReactElement, type Ref, useImperativeHandle } from 'react';
import type { Loaded } from '../three/index.js';
import { type CagecastOptions, type Painted, useCagecast } from './use-cagecast.js';

/** Properties of `Cagecast`: the options of `useCagecast`. */
export interface CagecastProps extends CagecastOptions {
  /** What GLTFLoader loaded, or a scene or mesh. */
  model: Loaded;
  /** Is given what the model is painted by, while it is shown. */
  ref?: Ref<Painted> | undefined;
}

/**
 * A painted model, as `useCagecast` paints it. It stands where its parent is: a `<group>` moves it.
 *
 * @example
 * <Suspense fallback={<Spinner />}>
 *   <group position={[0, -1, 0]}>
 *     <Cagecast model={gltf} template="human-head" texture={paint} />
 *   </group>
 * </Suspense>
 */
export function Cagecast({ model, ref, ...options }: CagecastProps): ReactElement {
  const { applied, cage, fit, choice, layers } = useCagecast(model, options);
  useImperativeHandle(ref, () => ({ applied, cage, fit, choice, layers }), [applied, cage, fit, choice, layers]);
  return createElement('primitive', { object: (model as { scene?: object }).scene ?? model });
}
