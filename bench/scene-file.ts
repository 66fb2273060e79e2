import type { Mesh } from 'cagecast';

/** A mesh whose arrays have the types of a scene file. */
export interface SceneMesh extends Mesh {
  positions: Float32Array;
  indices: Uint32Array;
  uvs?: Float32Array;
  groups?: Uint32Array;
}

/** A target and its cage, as a benchmark takes them. */
export interface Scene {
  cage: SceneMesh;
  target: SceneMesh;
}

const kMagic = 'CAGESCN1';

/**
 * A scene as bytes, little-endian: "CAGESCN1", then the cage, then the target, each as u32 vertexCount, u32 indexCount,
 * u8 hasUvs, u8 hasGroups, two bytes 0, f32 positions, u32 indices, f32 uvs (if any), u32 groups (if any).
 */
export function writeScene({ cage, target }: Scene): Uint8Array {
  const parts: Uint8Array[] = [new TextEncoder().encode(kMagic)];
  for (const { positions, indices, uvs, groups } of [cage, target]) {
    parts.push(bytesOf(Uint32Array.of(positions.length / 3, indices.length)));
    parts.push(Uint8Array.of(Number(uvs !== undefined), Number(groups !== undefined), 0, 0));
    for (const array of [positions, indices, uvs, groups]) if (array) parts.push(bytesOf(array));
  }
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

/** Reads what `writeScene` wrote. */
export function readScene(bytes: ArrayBuffer | Uint8Array): Scene {
  const all = new Uint8Array(bytes);
  if (new TextDecoder().decode(all.subarray(0, kMagic.length)) !== kMagic) throw new Error('not a scene file');
  let at = kMagic.length;
  const take = <A>(type: new (buffer: ArrayBuffer) => A, size: number): A =>
    new type(all.slice(at, (at += size)).buffer);
  const takeMesh = (): SceneMesh => {
    const [vertices, indices] = take(Uint32Array, 8) as unknown as [number, number];
    const [hasUvs, hasGroups] = take(Uint8Array, 4);
    return {
      positions: take(Float32Array, 12 * vertices),
      indices: take(Uint32Array, 4 * indices),
      ...(hasUvs && { uvs: take(Float32Array, 8 * vertices) }),
      ...(hasGroups && { groups: take(Uint32Array, 4 * vertices) }),
    };
  };
  const cage = takeMesh();
  return { cage, target: takeMesh() };
}

function bytesOf(array: Float32Array | Uint32Array): Uint8Array {
  return new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
}
