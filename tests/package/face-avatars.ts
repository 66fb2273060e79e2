import { GlbMaker } from '../support/gltf.js';

/** Where the face of `faceAvatar` is, as seen from the front: x to its left, y up. */
export const kFace = { eye: [0.3, -0.02], eyeSize: [0.19, 0.21], mouth: [0, -0.52], mouthSize: 0.28 } as const;

/** Which of its parts a motion moves. */
type Motion = 'left eye' | 'right eye' | 'both eyes' | 'jaw' | 'lips';

/**
 * A stylised head of one piece: large painted-on eyes, hardly a nose, a wide slit of a mouth.
 * @param targets     What its morph targets do, by their names.
 * @param extensions  Of the file.
 */
export function faceAvatar(targets: Readonly<Record<string, Motion>>, extensions: object = {}): Uint8Array {
  const [rows, columns] = [72, 96];
  const heights = Array.from({ length: rows + 1 }, (_, r) => Math.cos((Math.PI * r) / rows));
  const slit = heights.findIndex((y) => y < kFace.mouth[1]);
  heights.splice(slit, 0, kFace.mouth[1] + 1e-3, kFace.mouth[1] - 1e-3);
  const points = heights.flatMap((y) =>
    Array.from({ length: columns + 1 }, (_, c) => {
      const angle = (2 * Math.PI * (c % columns)) / columns;
      const around = Math.sqrt(Math.max(0, 1 - y * y));
      const [x, z] = [0.75 * around * Math.sin(angle), 0.85 * around * Math.cos(angle)];
      const nose = z > 0 ? 0.05 * Math.exp(-((x / 0.05) ** 2) - ((y + 0.3) / 0.06) ** 2) : 0;
      return [x, y, z + nose] as const;
    }),
  );
  const indices: number[] = [];
  for (let r = 0; r + 1 < heights.length; ++r)
    for (let c = 0; c < columns; ++c) {
      const a = r * (columns + 1) + c;
      const b = a + columns + 1;
      if (r > 0) indices.push(a, b, a + 1);
      if (r + 2 < heights.length) indices.push(a + 1, b, b + 1);
    }
  const maker = new GlbMaker();
  const mesh = maker.mesh({ positions: Float32Array.from(points.flat()), indices: Uint32Array.from(indices) });
  maker.json.meshes[mesh]!.extras = { targetNames: Object.keys(targets) };
  maker.json.meshes[mesh]!.primitives[0]!.targets = Object.values(targets).map((motion) => ({
    POSITION: maker.accessor(Float32Array.from(points.flatMap((point) => moved(motion, point))), 'VEC3'),
  }));
  maker.node({ name: 'Face', mesh });
  Object.assign(maker.json, { extensions, extensionsUsed: Object.keys(extensions) });
  return maker.finish();
}

function moved(motion: Motion, [x, y, z]: readonly [x: number, y: number, z: number]): [number, number, number] {
  if (z < 0) return [0, 0, 0];
  const side = Math.sign(x);
  if (motion === 'jaw') {
    const open = Math.max(0, 1 - (x / kFace.mouthSize) ** 2) * Math.min(1, 2 * z);
    return [0, y < kFace.mouth[1] ? -0.2 * open : 0, 0];
  }
  if (motion === 'lips') {
    const near = Math.exp(-((x / 0.15) ** 2) - ((y - kFace.mouth[1]) / 0.08) ** 2);
    return [-0.3 * x * near, 0, 0.05 * near];
  }
  if (motion === (side > 0 ? 'right eye' : 'left eye')) return [0, 0, 0];
  // The lid along the upper edge goes down to the lower one.
  const across = (side * x - kFace.eye[0]) / kFace.eyeSize[0];
  const up = (y - kFace.eye[1]) / kFace.eyeSize[1];
  const isLid = Math.abs(across) < 1 && up > 0 && Math.abs(Math.hypot(across, up) - 1.05) < 0.2;
  return [0, isLid ? -2 * kFace.eyeSize[1] * Math.sqrt(1 - across ** 2) : 0, 0];
}
