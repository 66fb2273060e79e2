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

export { CagecastViewer, type Check } from './element.js';

declare global {
  interface HTMLElementTagNameMap {
    'cagecast-viewer': CagecastViewer;
  }
}

if (globalThis.customElements && !customElements.get('cagecast-viewer'))
  customElements.define('cagecast-viewer', CagecastViewer);
