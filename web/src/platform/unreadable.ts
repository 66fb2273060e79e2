/** The error for a file that was chosen, but cannot be read any more. */
export const unreadable = (name: string, cause: unknown): Error =>
  new Error(`${name}: the file was changed or deleted after it was opened; open it again`, { cause });

/** @throws Error that says what to do, if a file that was chosen cannot be read any more. */
export async function checkReadable(file: Blob): Promise<void> {
  try {
    await file.slice(0, 1).arrayBuffer();
  } catch (error) {
    throw unreadable(file instanceof File ? file.name : 'a painting', error);
  }
}
