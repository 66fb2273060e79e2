import { hasCages } from '../../parts/own-cages.js';
import { wrong } from '../errors.js';
import { extract } from './extract-scene.js';
import type { Loaded } from './models.js';

/** A target that has its cage with it. @throws {CagecastError} `badOption` if it has none. */
export function ownCage(fn: string, target: Loaded): Loaded {
  if (hasCages(extract(target, 'cage').parts)) return target;
  const text = 'options.cage is undefined, and no mesh of target is named as the outer cage of another';
  throw wrong(text, fn, 'badOption', { argument: 'cage' });
}
