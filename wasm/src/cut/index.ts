/** What the adapters need for the parts of a scene that was cut; they load it when that is asked for. */
export type { CutTarget } from '../borders/index.js';
export { type Blends, blend, blendSkin, ruleOf } from './blend.js';
export { type CutPart, cutPart, decideAgain } from './part.js';
