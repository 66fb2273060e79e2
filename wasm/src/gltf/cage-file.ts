export { partNamesOf, shapeOf as cageModelOf, skeletonOf, templateOf } from '../scene/cage-model.js';
