export * from '../../scene/base-colors.js';
