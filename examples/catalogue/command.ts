import { type FileHandle, open } from 'node:fs/promises';
import { asFailure, Failure, meaningOf } from './failure.ts';
import { type Catalogue, openCatalogue } from './jobs.ts';

/** Runs a program of this folder. What it cannot do is said in one sentence, and the exit code is 2. @param run  Returns the exit code. */
export async function command(run: (catalogue: Catalogue) => Promise<number>): Promise<void> {
  const catalogue = openCatalogue();
  try {
    process.exitCode = await run(catalogue);
  } catch (error) {
    console.error(asFailure(error).message);
    process.exitCode = 2;
  } finally {
    await catalogue.close();
  }
}

/** The lines of a file, one by one: it may be larger than the memory. @throws {Failure} if it cannot be read. */
export async function* linesOf(
  path: string,
  opened: () => Promise<FileHandle> = () => open(path),
): AsyncGenerator<string> {
  try {
    const file = await opened();
    yield* file.readLines();
  } catch (error) {
    throw (error as NodeJS.ErrnoException).code ? new Failure('missing', `${path} ${meaningOf(error)}`) : error;
  }
}
