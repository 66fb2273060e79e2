import { CagecastError, isRecord } from '../core/error.js';

/** Options of `fitCage`, which no landmark is named like. */
const kOptions = ['exclude', 'signal', 'onProgress'];

/** @throws {CagecastError} `badArgument` if options of `fitCage` are given in the place of landmarks. */
export function checkOrder(landmarks: unknown): void {
  const name = kOptions.find((option) => isRecord(landmarks) && option in landmarks);
  if (name === undefined) return;
  const text = `landmarks.${name} is an option; options come after landmarks: fitCage(template, model, undefined, { ${name} })`;
  throw new CagecastError('badArgument', 'fitCage', text, { argument: 'landmarks' });
}
