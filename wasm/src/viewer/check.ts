import type { GLTF } from 'three/addons/loaders/GLTFLoader.js';
import type { Inspection } from '../inspect/index.js';
import { type Applied, type ApplyOptions, cageTemplate, extract } from '../three/index.js';
import { type CallOptions, inspect } from '../worker/index.js';

/** The `detail` of the event `verdict`. */
export type Check = Pick<Inspection, 'verdict' | 'findings'>;

/** Reads the arrays before vertices are split. @returns what judges the cage by them. */
export function inspectorOf(gltf: GLTF, around: GLTF, parts: ApplyOptions['parts']) {
  const { mesh, kept: keep, excluded: exclude } = extract(gltf.scene, 'target', parts);
  const [{ mesh: cage }, { landmarks }] = [extract(around.scene, 'cage'), cageTemplate(around)];
  return async (
    { result }: Applied,
    { feather, opacity, borders, ...options }: ApplyOptions & CallOptions,
  ): Promise<Check> => {
    const named = { parts: { keep, exclude }, result, landmarks };
    const { verdict, findings } = await inspect(cage, mesh, { ...options, ...named });
    return { verdict, findings };
  };
}
