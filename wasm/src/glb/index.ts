/**
 * A model file in, the painted file out: what `cagecast transfer` does, as one function for Node, pages and edge functions.
 * @module cagecast/glb
 */
export { type PaintedGlb, type PaintOptions, paintGlb } from './paint-glb.js';
