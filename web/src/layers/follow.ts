import { type Paint, titleOf } from '../scene/paint';
import type { Session } from '../scene/session';
import type { Viewer } from '../view/viewer';
import { Composite } from './composite';
import type { Edits } from './edits';
import type { LayerStack } from './stack';

/** Puts the paint of the model on show under everything, and the visitor's own paints on top as they come. */
export function followPaints(session: Session, stack: LayerStack, edits: Edits): void {
  const { checker } = session;
  const setBase = (paint: Paint): void => {
    edits.forgetChoices();
    stack.setBase(titleOf(paint), paint);
  };
  session.on('transfer', ({ cage }) => {
    const base = stack.base?.sheet as Paint | undefined;
    // A sample's paint means nothing on another cage: there the checker takes its place.
    if (base?.sample && base.sample !== cage.sample) setBase(checker);
  });
  session.on('paint', (paint) => {
    if (paint === checker || paint.sample) return setBase(paint);
    edits.do(`adding of ${titleOf(paint)}`, () => {
      stack.add(titleOf(paint), paint);
      // The checker stands in where there is no paint; here is one.
      if (stack.base?.sheet === checker) stack.restyle(stack.base, { visible: false });
    });
  });
}

/** Lets the picture show what the layers look like together. */
export function showComposite(viewer: Viewer, stack: LayerStack): Composite {
  const composite = new Composite();
  viewer.setPaint(composite.texture);
  viewer.beforeDraw(() => composite.update(viewer.renderer));
  stack.on('change', (layers) => {
    composite.set(layers);
    viewer.redraw();
  });
  return composite;
}
