/** A file cannot be used. The message says what is wrong and where, and names the file once it is known. */
export class InputError extends Error {
  override readonly name = 'InputError';

  /** The same, of the same class, with the file's name in front. */
  in(file: string): InputError {
    const Class = this.constructor as typeof InputError;
    return new Class(`${file}: ${this.message}`, { cause: this.cause });
  }
}

/** An error with a name in front, such as a file's, if it is an `InputError` and there is one; any other as it is. */
export const withName = (error: unknown, name: string | undefined): unknown =>
  error instanceof InputError && name !== undefined ? error.in(name) : error;

/** Does something with what may have a name, such as a file. @throws {InputError} with the name in front. */
export function naming<Result>(name: string | undefined, work: () => Result): Result {
  try {
    const result = work();
    if (!(result instanceof Promise)) return result;
    return result.catch((error: unknown) => {
      throw withName(error, name);
    }) as Result;
  } catch (error) {
    throw withName(error, name);
  }
}

/** The first line of any error's message. */
export function firstLine(error: unknown): string {
  return (error instanceof Error ? error.message : String(error)).split('\n', 1)[0] ?? '';
}
