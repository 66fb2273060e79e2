export * from '../scene/extract.js';
