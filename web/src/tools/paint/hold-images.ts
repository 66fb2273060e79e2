import { loadPaint, readImage } from '../../loading/load-paint';
import { ask, kAskedFor, type Question } from '../../platform/ask';
import { element, showError } from '../../platform/page';
import { hasFace, landmarksOf } from '../../state/model';
import type { Session } from '../../state/session';
import type { Layers } from './painter';
import type { StickerTool } from './sticker-tool';

/**
 * Lets an image be placed as a sticker, or as a photo of a face where the cage has one.
 * @param choose Chooses the tool for stickers, or none.
 * @returns Takes an image; returns what else can be done with it.
 */
export function holdImages(
  session: Session,
  layers: Layers,
  sticker: StickerTool,
  choose: (on: boolean) => void,
): (image: ImageBitmap) => Question['answers'] {
  const putOnFace = async (photo: ImageBitmap): Promise<void> => {
    const { askForEyes, drawFace, findFace } = await import('./face-photo');
    choose(false);
    askForEyes(photo, async (dots) => {
      const { cage } = session.shown!;
      const face = findFace(landmarksOf(cage));
      if (!face) return showError('This model has no face that the page knows of.');
      const file = new File([await drawFace(photo, dots, cage.mesh, face)], 'Face.png', { type: 'image/png' });
      const paint = await loadPaint(file);
      layers.edits.do('adding Face', () => layers.stack.add('Face', paint));
    });
  };
  const hold = (image: ImageBitmap): Question['answers'] => {
    choose(true);
    sticker.setImage(image);
    if (!session.shown || !hasFace(session.shown.cage)) return [];
    return [{ title: 'It is a face', run: () => void putOnFace(image) }];
  };
  const input = element('sticker-image', HTMLInputElement);
  input.addEventListener('change', async (event) => {
    event.stopPropagation(); // it is not read yet
    const file = input.files?.[0];
    input.value = ''; // so that the same file can be chosen again
    if (!file) return;
    try {
      const answers = hold(await readImage(file));
      const text = `${file.name}: click where it belongs on the model.`;
      if (answers.length > 0) ask({ text, answers, lasts: kAskedFor });
    } catch (error) {
      showError((error as Error).message);
    }
  });
  return hold;
}
