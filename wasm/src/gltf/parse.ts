import type { GLTF } from '@gltf-transform/core';
import { show } from '../core/error.js';
import { InputError } from '../scene/input-error.js';
import { checkLists } from './checks/check-geometry.js';
import { checkNesting } from './checks/limits.js';
import type { ReadLimits } from './checks/read-limits.js';
import { adviceOn } from './kinds.js';

/** The JSON of a GLB or glTF file, and the GLB's bytes. @throws {InputError} with a message that does not name the file. */
export function parseGltf(bytes: Uint8Array, limits: ReadLimits): { json: GLTF.IGLTF; binary: Uint8Array | undefined } {
  if (bytes.byteLength === 0) throw new InputError('the file is empty');
  const isGlb = String.fromCharCode(...bytes.subarray(0, 4)) === 'glTF';
  const { text, binary } = isGlb ? chunks(bytes) : { text: bytes, binary: undefined };
  checkNesting(text, limits);
  let json: GLTF.IGLTF | null;
  try {
    json = JSON.parse(new TextDecoder().decode(text)) as GLTF.IGLTF | null;
  } catch (cause) {
    throw new InputError(
      isGlb
        ? 'its JSON is damaged'
        : (adviceOn(bytes) ?? 'is neither a GLB or glTF file nor one of FBX (7 or newer), OBJ, PLY, STL or USD'),
      {
        cause,
      },
    );
  }
  if (json?.asset?.version === undefined) throw new InputError('is JSON but not glTF: it has no asset.version');
  const { version } = json.asset;
  if (!/^2\./.test(String(version)))
    throw new InputError(`is glTF ${typeof version === 'string' ? version : show(version)}; only 2.x can be read`);
  checkLists(json);
  return { json, binary };
}

/** The two chunks of a GLB. */
function chunks(bytes: Uint8Array): { text: Uint8Array; binary: Uint8Array | undefined } {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const have = bytes.byteLength;
  if (have < 20) throw new InputError(`is truncated: a GLB has at least 20 bytes, this one ${have}`);
  const version = view.getUint32(4, true);
  if (version !== 2) throw new InputError(`is a GLB of version ${version}; only version 2 can be read`);
  const length = view.getUint32(8, true);
  if (length > have) throw new InputError(`is truncated: its header says ${length} bytes, there are ${have}`);
  const found: Record<number, Uint8Array> = {};
  for (let at = 12; at + 8 <= length; ) {
    const size = view.getUint32(at, true);
    const type = view.getUint32(at + 4, true);
    if (at + 8 + size > length)
      throw new InputError(`is damaged: the chunk at byte ${at} has ${size} bytes, ${length - at - 8} are left`);
    found[type] ??= bytes.subarray(at + 8, at + 8 + size);
    at += 8 + size;
  }
  const text = found[0x4e4f534a]; // "JSON"
  if (text === undefined) throw new InputError('is damaged: it has no JSON chunk');
  return { text, binary: found[0x004e4942] }; // "BIN\0"
}
