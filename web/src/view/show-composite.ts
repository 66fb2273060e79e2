import { Composite, type LayerStack } from '#three';
import type { Viewer } from './viewer';

/** Shows the composite of the layers on the model. */
export function showComposite(viewer: Viewer, stack: LayerStack): Composite {
  const composite = new Composite();
  viewer.stage.setPaint(composite.texture);
  viewer.beforeDraw(() => composite.update(viewer.renderer));
  stack.on('change', (layers) => {
    composite.set(layers);
    viewer.redraw();
  });
  return composite;
}
