import { ShapeUtils } from 'three';
import { USDComposer } from 'three/addons/loaders/usd/USDComposer.js';
import { InputError } from '../../../scene/input-error.js';
import { exceeds } from '../../checks/read-limits.js';
import type { FormatLimits } from '../limits.js';

/** What its declarations leave out of the composer of USD. */
interface Composer {
  compose(data: object, ...rest: unknown[]): object;
  _triangulateIndicesWithPattern(
    indices: ArrayLike<number> | undefined,
    counts: ArrayLike<number>,
    ...rest: unknown[]
  ): object;
}

/** Makes the loaders of this thread, for one file, ask first whether their next step is within the limits. */
export function guardLoaders(limits: FormatLimits): void {
  const { triangulateShape } = ShapeUtils;
  ShapeUtils.triangulateShape = (contour, holes) => {
    const corners = [contour, ...holes].reduce((sum, { length }) => sum + length, 0);
    if (corners > limits.corners)
      throw exceeds(`has a polygon of ${corners.toLocaleString('en')} corners`, 'corners', limits);
    return triangulateShape(contour, holes);
  };
  const prototype = USDComposer.prototype as unknown as Composer;
  const { compose, _triangulateIndicesWithPattern: triangulate } = prototype;
  const shown = new Map<object, number>();
  const open = new Set<object>();
  let composed = 0;
  // A layer is composed anew wherever another one refers to it.
  prototype.compose = function (data, ...rest) {
    const times = (shown.get(data) ?? 0) + 1;
    shown.set(data, times);
    if (open.has(data)) throw new InputError('one of its layers refers to itself');
    if (times > limits.instances) throw exceeds(`its layers refer ${times} times to one of them`, 'instances', limits);
    if (++composed > limits.parts) throw exceeds(`its layers refer to ${composed} others`, 'parts', limits);
    open.add(data);
    const group = compose.call(this, data, ...rest);
    open.delete(data);
    return group;
  };
  prototype._triangulateIndicesWithPattern = function (indices, counts, ...rest) {
    const given = indices?.length ?? 0;
    let corners = 0;
    for (let face = 0; face < counts.length; ++face) {
      const count = counts[face]!;
      if (!(count >= 0)) throw new InputError(`faceVertexCounts[${face}] is ${count}`);
      corners += count;
    }
    if (corners > given)
      throw new InputError(`faceVertexCounts are ${corners} together, but there are ${given} faceVertexIndices`);
    return triangulate.call(this, indices, counts, ...rest);
  };
}
