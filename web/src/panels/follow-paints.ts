import { Composite, type Edits, type LayerStack } from 'cagecast/three/paint';
import type { Model } from '../state/model';
import { type Paint, titleOf } from '../state/paint';
import { haveSameUvs } from '../state/same-uvs';
import type { Session } from '../state/session';
import type { Viewer } from '../view/viewer';

/** Makes the paint of the current model the base layer, and adds the user's own paints on top. */
export function followPaints(session: Session, stack: LayerStack, edits: Edits): void {
  const { checker } = session;
  const setBase = (paint: Paint): void => {
    edits.forgetChoices();
    stack.setBase(titleOf(paint), paint);
  };
  let last: Model | undefined;
  session.on('transfer', ({ cage }) => {
    const base = stack.base?.sheet as Paint | undefined;
    const isSame = last !== undefined && haveSameUvs(last, cage);
    last = cage;
    // A sample's paint does not fit another cage's UVs: show the checker instead.
    if (base?.sample && base.sample !== cage.sample && !isSame) setBase(checker);
  });
  session.on('paint', (paint) => {
    if (paint === checker || paint.sample) return setBase(paint);
    edits.do(`adding ${titleOf(paint)}`, () => {
      stack.add(titleOf(paint), paint);
      // The checker was only a placeholder.
      if (stack.base?.sheet === checker) stack.restyle(stack.base, { visible: false });
    });
  });
}

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
