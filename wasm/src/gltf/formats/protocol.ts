import type { Format } from '../kinds.js';
import type { FormatLimits } from './limits.js';

/** Messages to the reading thread: the file, then each file beside it, once asked for. */
export type Question =
  | { bytes: Uint8Array; format: Format; limits: FormatLimits }
  | { ask: number; found: Uint8Array | undefined };

/** Its messages: it begins (`times` is Linux's file of its times), needs a file, goes without one; and at the end the GLB, if there is one, or an error. */
export type Answer =
  | { begun: true; times: string | undefined }
  | { ask: number; name: string }
  | { missing: [name: string, reason: string] }
  | { glb: Uint8Array<ArrayBuffer> | undefined }
  | { wrong: string };
