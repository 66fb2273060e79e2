// What the build puts in place of error.js in cagecast/borders: its errors are those of the main entry.
export { CagecastError } from '../index.js';
export { coreCodes, show, type Code } from '../error.js';
