import type { Edits, LayerStack } from '#three';
import type { Model } from './model';
import { isOffered, type Paint, titleOf } from './paint';
import { haveSameUvs } from './same-uvs';
import type { Session } from './session';

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
    // What was made for a cage does not fit another one's UVs: until there is another, the checker is shown.
    if ((base?.drawn || (base?.sample && base.sample !== cage.sample)) && !isSame) setBase(checker);
  });
  session.on('paint', (paint) => {
    if (isOffered(paint, checker)) return setBase(paint);
    edits.do(`adding ${titleOf(paint)}`, () => {
      stack.add(titleOf(paint), paint);
      // The checker was only a placeholder.
      if (stack.base?.sheet === checker) stack.restyle(stack.base, { visible: false });
    });
  });
}
