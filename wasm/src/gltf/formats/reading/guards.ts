import { type BufferGeometry, type Object3D, ShapeUtils } from 'three';
import { USDComposer } from 'three/addons/loaders/usd/USDComposer.js';
import { InputError } from '../../../scene/input-error.js';
import { exceeds } from '../../checks/read-limits.js';
import type { FormatLimits } from '../limits.js';

/** What USD says of a mesh, by name. */
type Fields = Record<string, unknown>;

/** What its declarations leave out of the composer of USD. */
interface Composer {
  compose(data: object, ...rest: unknown[]): object;
  _buildGeometry(path: string, fields: Fields, ...rest: unknown[]): BufferGeometry;
  _buildGeometryWithSubsets(fields: Fields, ...rest: unknown[]): BufferGeometry;
  _findUVPrimvar(fields: Fields): object;
  applyTransform(object: Object3D, fields: Fields, attributes?: Fields): void;
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

/** Mends what three's loader leaves out of USD: clockwise triangles, hidden prims, and the first of several sets of UVs. */
export function mendUsd(): void {
  const prototype = USDComposer.prototype as unknown as Composer;
  const { applyTransform } = prototype;
  prototype.applyTransform = function (object, fields, attributes = {}) {
    const { visibility, purpose } = attributes;
    if (visibility === 'invisible' || purpose === 'guide' || purpose === 'proxy') object.visible = false;
    applyTransform.call(this, object, fields, attributes);
  };
  const { _buildGeometry: build, _buildGeometryWithSubsets: buildSubsets, _findUVPrimvar: findUvs } = prototype;
  prototype._buildGeometry = function (path, fields, ...rest) {
    return turned(build.call(this, path, fields, ...rest), fields);
  };
  prototype._buildGeometryWithSubsets = function (fields, ...rest) {
    return turned(buildSubsets.call(this, fields, ...rest), fields);
  };
  prototype._findUVPrimvar = function (fields) {
    const name = ['primvars:st', 'primvars:UVMap', 'primvars:st0'].find((one) => fields[one] !== undefined);
    return name ? { uvs: fields[name], uvIndices: fields[`${name}:indices`] } : findUvs.call(this, fields);
  };
}

/** A geometry whose triangles are counter-clockwise; without an index, as the composer makes it. */
function turned(geometry: BufferGeometry, { orientation, normals, 'primvars:normals': named }: Fields): BufferGeometry {
  if (orientation !== 'leftHanded') return geometry;
  // Those that the file does not have were made of clockwise triangles.
  const made = normals || named ? undefined : geometry.getAttribute('normal');
  if (made) (made.array as Float32Array).forEach((x, i, all) => (all[i] = -x));
  for (const { array, itemSize } of Object.values(geometry.attributes) as { array: Float32Array; itemSize: number }[])
    for (let t = 0; t + 3 * itemSize <= array.length; t += 3 * itemSize) {
      const second = array.slice(t + itemSize, t + 2 * itemSize);
      array.copyWithin(t + itemSize, t + 2 * itemSize, t + 3 * itemSize);
      array.set(second, t + 2 * itemSize);
    }
  return geometry;
}
