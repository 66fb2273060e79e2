// What the build puts in place of error.js in cagecast/borders: its errors are those of the main entry.

export { type Code, coreCodes, show } from '../error.js';
export { CagecastError } from '../index.js';
