import { CagecastError } from '../../api/index.js';
import { firstLine, InputError } from '../../scene/input-error.js';

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

/** What keeps a file from being read or written. */
export const reasons: Readonly<Record<string, string>> = {
  ENOENT: 'no such file',
  ENOTDIR: 'no such file',
  EISDIR: 'is a folder, not a file',
  EACCES: 'cannot be read: permission denied',
  ELOOP: 'is a link that leads back to itself',
  ENAMETOOLONG: 'its name is too long',
};

/** The message of an error. Errors of other kinds than files, system and package are defects. */
export function messageOf(error: unknown): string {
  if (error instanceof InputError || error instanceof CagecastError) return error.message;
  const { syscall, path, code = '' } = (error ?? {}) as NodeJS.ErrnoException;
  if (syscall === 'uv_cwd') return 'the current folder is gone; change to another one';
  if (syscall) return `${path ?? syscall}: ${reasons[code] ?? firstLine(error)}`;
  return `failed unexpectedly (${firstLine(error)}); please report it`;
}
