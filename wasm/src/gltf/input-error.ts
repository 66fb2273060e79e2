export * from '../scene/input-error.js';
