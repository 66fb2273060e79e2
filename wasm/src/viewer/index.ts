/**
 * A web component that shows a painted model, for pages that use no three.js themselves. Importing defines the element
 * `<cagecast-viewer>`; in Node nothing happens.
 *
 * ```html
 * <script type="module">import 'cagecast/viewer';</script>
 * <cagecast-viewer target="head.glb" cage="cage.glb" paint="paint.png" alt="A painted head"></cagecast-viewer>
 * ```
 * @module cagecast/viewer
 */
import { CagecastViewer } from './element.js';

export type { Check } from './check.js';
export { CagecastViewer } from './element.js';
export type { ViewerEvents } from './events.js';
export type { ViewerAttributes } from './jsx.js';

declare global {
  interface HTMLElementTagNameMap {
    'cagecast-viewer': CagecastViewer;
  }
}

if (globalThis.customElements && !customElements.get('cagecast-viewer'))
  customElements.define('cagecast-viewer', CagecastViewer);
