/** Saves a file. */
export function download(blob: Blob, name: string): void {
  const address = URL.createObjectURL(blob);
  const link = document.createElement('a');
  link.href = address;
  link.download = name;
  link.click();
  // Later, as the browser still has to read it.
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
