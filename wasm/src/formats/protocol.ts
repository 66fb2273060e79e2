import type { Format } from '../gltf/kinds.js';
import type { FormatLimits } from './limits.js';

/** What a thread that reads a file is sent: the file, then the files that it asked for. */
export type Question =
  | { bytes: Uint8Array; format: Format; limits: FormatLimits }
  | { ask: number; found: Uint8Array | undefined };

/** What it says: that it begins, that it needs a file or goes without one, and at the end the GLB, if there is one, or what is wrong. */
export type Answer =
  | { begun: true }
  | { ask: number; name: string }
  | { missing: [name: string, reason: string] }
  | { glb: Uint8Array<ArrayBuffer> | undefined }
  | { wrong: string };
