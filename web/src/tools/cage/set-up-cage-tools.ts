import type { History } from '#three';
import { ask } from '../../platform/ask';
import { element } from '../../platform/page';
import type { CageMaker } from '../../state/cage-maker';
import type { Session } from '../../state/session';
import type { Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import type { CageAdjuster } from './cage-adjuster';
import type { LandmarkEditor } from './landmark-editor';

const kHintLasts = 8000; // milliseconds

/** Offers tools for a cage that was made here. They load when there is one. */
export function setUpCageTools(
  session: Session,
  viewer: Viewer,
  tools: Tools,
  maker: CageMaker,
  history: History,
): void {
  const details = element('make-options', HTMLDetailsElement);
  let options: Promise<unknown> | undefined;
  const offerOptions = (): Promise<unknown> =>
    (options ??= import('./make-options').then(
      ({ MakeOptionsPanel }) => new MakeOptionsPanel(session, viewer, maker, tools, history),
      (error) => {
        options = undefined;
        session.fail(error);
      },
    ));
  details.addEventListener('toggle', () => details.open && void offerOptions());
  // Marks of an earlier visit are of use with their tool.
  session.on('zones', () => session.bare && void offerOptions());
  maker.markBare = async () => {
    if (!(await offerOptions())) return;
    const brush = element('bare-brush', HTMLButtonElement);
    if (brush.ariaPressed !== 'true') brush.click();
    ask({ text: 'Brush over what is to stay bare.', answers: [], lasts: kHintLasts });
  };

  let adjuster: Promise<CageAdjuster> | undefined;
  element('adjust-cage', HTMLButtonElement).addEventListener('click', async () => {
    adjuster ??= import('./cage-adjuster').then(
      ({ CageAdjuster }) => new CageAdjuster(session, viewer, tools, maker, history),
    );
    try {
      (await adjuster).start();
    } catch (error) {
      adjuster = undefined;
      session.fail(error);
    }
  });

  let landmarks: Promise<LandmarkEditor> | undefined;
  let last: object | undefined;
  maker.on('fitting', async (fitting) => {
    last = fitting;
    if (!fitting && !landmarks) return;
    landmarks ??= import('./landmark-editor').then(
      ({ LandmarkEditor }) => new LandmarkEditor(session, viewer, tools, maker, history),
    );
    const editor = await landmarks.catch((error) => {
      landmarks = undefined;
      session.fail(error);
    });
    if (last === fitting) editor?.edit(fitting);
  });
}
