/** What the adapters need for the parts of a scene that was cut; they load it when that is asked for. */
export type { CutTarget } from '../borders/index.js';
export { blend, blendSkin, ruleOf, type Blends } from './blend.js';
export { cutPart, decideAgain, type CutPart } from './part.js';
