import type { Mesh } from 'cagecast';
import { Vector3 } from 'three';
import { random } from '../../package/scenes.js';
import { GlbMaker } from '../glb.js';

/**
 * A target with attributes of all kinds, each its own at every vertex, and morph targets; skinned, or mirrored by its node.
 * @param target  Where it is seen.
 */
export function richFile({ positions, indices, uvs }: Mesh, kind: 'skinned' | 'mirrored'): Uint8Array {
  const next = random(7);
  const maker = new GlbMaker();
  const vertices = positions.length / 3;
  const sign = kind === 'mirrored' ? -1 : 1;
  const local = { positions: positions.map((x, i) => (i % 3 === 0 ? sign * x : x)), indices, ...(uvs && { uvs }) };
  const mesh = maker.mesh(local);
  const primitive = maker.json.meshes[mesh]!.primitives[0]!;
  const numbers = (size: number, value: (v: number, k: number) => number) =>
    Float32Array.from({ length: size * vertices }, (_, i) => value(Math.floor(i / size), i % size));
  const normals = Array.from({ length: vertices }, () => new Vector3(next() + 0.1, next(), next()).normalize());
  // At right angles to the normal, with a sign.
  const tangents = normals.map(({ x, y, z }) => [y, z, x, -1]);
  const weights = Array.from({ length: vertices }, () => {
    const pulls = Array.from({ length: 4 }, next);
    return pulls.map((pull) => pull / pulls.reduce((a, b) => a + b));
  });
  const colors = Uint8Array.from({ length: 4 * vertices }, () => 256 * next());
  Object.assign(primitive.attributes, {
    NORMAL: maker.accessor(
      numbers(3, (v, k) => normals[v]!.getComponent(k)),
      'VEC3',
    ),
    TANGENT: maker.accessor(
      numbers(4, (v, k) => tangents[v]![k]!),
      'VEC4',
    ),
    COLOR_0: maker.accessor(colors, 'VEC4', { normalized: true }),
    _HEAT: maker.accessor(numbers(1, next), 'SCALAR'),
  });
  const deltas = () =>
    maker.accessor(
      numbers(3, () => next() - 0.5),
      'VEC3',
    );
  primitive.targets = [{ POSITION: deltas(), NORMAL: deltas() }, { NORMAL: deltas() }];
  const node = { mesh, name: 'head', scale: [sign, 1, 1] };
  if (kind === 'mirrored') maker.node(node);
  else {
    const slots = Uint8Array.from({ length: 4 * vertices }, (_, i) => 4 * (Math.floor(i / 4) % 3) + (i % 4));
    primitive.attributes['JOINTS_0'] = maker.accessor(slots, 'VEC4');
    primitive.attributes['WEIGHTS_0'] = maker.accessor(
      numbers(4, (v, k) => weights[v]![k]!),
      'VEC4',
    );
    const joints = Array.from({ length: 12 }, (_, j) => maker.node({ name: `joint ${j}` }, false));
    maker.node({ name: 'joints', children: joints });
    maker.json.skins = [{ joints }];
    maker.node({ ...node, skin: 0 });
  }
  return maker.finish();
}
