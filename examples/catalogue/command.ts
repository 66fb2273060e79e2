import { open } from 'node:fs/promises';
import { Failure } from './failure.ts';
import { type Catalogue, openCatalogue } from './jobs.ts';

/** Runs a program of this folder. What it cannot do is said in one sentence, and the exit code is 2. @param run  Returns the exit code. */
export async function command(run: (catalogue: Catalogue) => Promise<number>): Promise<void> {
  const catalogue = openCatalogue();
  try {
    process.exitCode = await run(catalogue);
  } catch (error) {
    if (!(error instanceof Failure)) throw error;
    console.error(error.message);
    process.exitCode = 2;
  } finally {
    await catalogue.close();
  }
}

/** The lines of a file, one by one: it may be larger than the memory. @throws {Failure} if it cannot be read. */
export async function* linesOf(path: string): AsyncGenerator<string> {
  try {
    const file = await open(path);
    yield* file.readLines();
  } catch (error) {
    const { code } = error as NodeJS.ErrnoException;
    throw code ? new Failure('missing', `${path}: ${code}`) : error;
  }
}
