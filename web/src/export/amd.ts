/**
 * Imports a script that hands what it makes to AMD's `define`: as it is, so that loaders of three's, which want it as text, and
 * this share one file. One at a time, and only in a worker of its own, whose `define` it takes.
 */
export async function importAmd<Made>(address: string): Promise<Made> {
  const made = new Promise<Made>((resolve) => {
    const define = (_: [], make: () => Made): void => resolve(make());
    Object.assign(globalThis, { define: Object.assign(define, { amd: true }) });
  });
  await import(/* @vite-ignore */ address);
  return made;
}
