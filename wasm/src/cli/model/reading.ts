import { defaultLimits, type ReadLimits } from '../../gltf/checks/read-limits.js';
import type { FormatLimits } from '../../gltf/formats/limits.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';

/** How files are read. */
export interface ReadOptions {
  limits: ReadLimits & Partial<FormatLimits>;
  /** Whether files may be read that are not in the folder of the glTF that refers to them. */
  allowOutside: boolean;
  /** The UV set of a cage that counts. Default: as `chooseUvSet` finds it. */
  cageUvs?: UvSetChoice | undefined;
}

/** How files are read if nothing else is said. */
export const defaultReading: ReadOptions = { limits: defaultLimits, allowOutside: false };
