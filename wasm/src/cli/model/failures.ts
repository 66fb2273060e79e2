import { firstLine, InputError } from '../../gltf/input-error.js';
import { CagecastError } from '../../index.js';

/** What the command ends with if it does not end with 0. */
export const kExit = {
  /** An input cannot be used. */
  unusable: 1,
  wrongUsage: 2,
  /** A cage does not fit. */
  unfit: 3,
  /** `diff` found a change over the limit. */
  changed: 4,
} as const;

/** Arguments that cannot be used together. */
export class UsageError extends InputError {}

/** What an error says of what went wrong. Others than those of files and of the package are defects. */
export const messageOf = (error: unknown): string =>
  error instanceof InputError || error instanceof CagecastError
    ? error.message
    : `failed unexpectedly (${firstLine(error)}); please report it`;
