/**
 * Imports an AMD script unmodified, so that it shares a file with the loaders of three.js, which read it as text. One at a time,
 * and only in a dedicated worker, as it sets the global `define`.
 */
export async function importAmd<Made>(address: string): Promise<Made> {
  const made = new Promise<Made>((resolve) => {
    const define = (_: [], make: () => Made): void => resolve(make());
    Object.assign(globalThis, { define: Object.assign(define, { amd: true }) });
  });
  await import(/* @vite-ignore */ address);
  return made;
}
