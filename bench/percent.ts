/** A share as a text. */
export const percent = (share: number): string => {
  if (!Number.isFinite(share)) return '–';
  // What is not all of it must not be rounded to all of it, nor something to nothing.
  const rounded = Math.min(Math.max(100 * share, share > 0 ? 0.01 : 0), share < 1 ? 99.99 : 100);
  return `${Number(rounded.toFixed(2))} %`;
};
