/** Gives a file away: by the sheet for sharing of a phone or a tablet, elsewhere as a download. */
export async function handOver(blob: Blob, name: string): Promise<void> {
  const files = [new File([blob], name, { type: blob.type })];
  if (isTouched() && navigator.canShare?.({ files })) {
    try {
      return await navigator.share({ files });
    } catch (error) {
      if ((error as Error).name === 'AbortError') return; // it was closed
    }
  }
  download(blob, name);
}

/** Whether fingers are what the device is used with. */
export const isTouched = (): boolean => matchMedia('(pointer: coarse)').matches;

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
