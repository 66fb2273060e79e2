/** What the adapters need to cut the parts of a scene; they load it when that is asked for. */
export { cutBorders, type CutTarget } from '../borders/index.js';
export { blend, blendSkin, ruleOf, type Blends } from './blend.js';
export { cutPart, decideAgain, type CutPart } from './part.js';
