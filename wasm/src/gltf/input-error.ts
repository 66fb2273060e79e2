/** A file that cannot be used. Its message says what is wrong, where, and, once it is known, in which file. */
export class InputError extends Error {
  override readonly name = 'InputError';

  /** The same with the file's name in front. */
  in(file: string): InputError {
    return new InputError(`${file}: ${this.message}`, { cause: this.cause });
  }
}

/** The first line of any error's message. */
export function firstLine(error: unknown): string {
  return (error instanceof Error ? error.message : String(error)).split('\n', 1)[0] ?? '';
}
