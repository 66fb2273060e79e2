import { InputError } from '../../scene/input-error.js';
import type { UvSetChoice } from '../../scene/uv-sets.js';
import type { ReadOptions } from './reading.js';
import type { ResolvedSettings, Rules } from './settings.js';
import type { UvBounds } from './uv-bounds.js';

/** The files of a transfer, and how they are read. */
export interface Sources {
  target: string;
  cage: string;
  /** A cage that is fitted to the target, instead of one: `auto`, the name of one that comes with the package, or a file. */
  template?: string | undefined;
  /** Whether the cage has to be named as such, as none was given but the target. */
  isOwnCage?: boolean | undefined;
  /** The UV set of the cage, by its number or name. Default: as `chooseUvSet` finds it. */
  cageUvs?: UvSetChoice | undefined;
  /** The part of the cage's UVs that the texture covers; by default 0..1. */
  uvBounds?: UvBounds | undefined;
  /** A cage with the UVs of all triangles that count; others count as cut away. */
  referenceCage?: string | undefined;
  rules: Rules;
  reading: ReadOptions;
}

/** The name of a cage that is made on the way; a file of this name is `./auto`. */
export const kAutoCage = 'auto';

/** What stands for the template in the name of a texture. */
const kTemplate = '{template}';

/** Whether a path names a texture for each template. */
export const isByTemplate = (path: string): boolean => path.includes(kTemplate);

/** The path of the texture for a template. @throws {InputError} if it is one for each, and there is no template. */
export function texturePath(path: string, template: string | undefined): string {
  if (template === undefined && isByTemplate(path))
    throw new InputError(`${kTemplate} stands for what --template comes to; give that, or a file`).in(path);
  return path.replaceAll(kTemplate, template ?? '');
}

/** A further cage, and the texture that was drawn for it. */
export interface Region {
  cage: string;
  texture: string;
}

/** The arguments of `cagecast transfer`. */
export interface TransferCommand extends Sources, ResolvedSettings {
  texture?: string | undefined;
  output?: string | undefined;
  report?: string | undefined;
  /** Further cages with textures: each paints only what none before it does. */
  regions?: readonly Region[] | undefined;
  /** Whether to inspect the cage as well. */
  inspects?: boolean | undefined;
}
