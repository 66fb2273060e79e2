import { InputError } from '../../../scene/input-error.js';

/** Checks that whatever is begun in the text of an STL is ended, too: the loader looks for each end in all that follows. */
export function checkStl(bytes: Uint8Array): void {
  const kHead = 10; // the loader looks this far for the word that texts begin with
  if (!/solid/.test(new TextDecoder().decode(bytes.subarray(0, kHead)))) return;
  let [isSolid, isFacet] = [false, false];
  for (const [word] of new TextDecoder().decode(bytes).matchAll(/(?:end)?(?:solid|facet)/g)) {
    if (!isSolid)
      isSolid = true; // whether it is one that ends it or not: the loader looks for "solid"
    else if (word === 'endsolid') {
      if (isFacet) break;
      isSolid = false;
    } else if (word === 'endfacet') isFacet = !isFacet;
    else if (word === 'facet') isFacet = true;
  }
  if (isFacet) throw new InputError('one of its facets does not end');
  if (isSolid) throw new InputError('one of its solids does not end');
}
