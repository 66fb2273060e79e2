// Inspect, for those who study the method: loads when it is opened.
import { Explain } from '../../explain/explain-tool';
import { fetchLabels } from '../../loading/samples';
import { TransferClient } from '../../loading/transfer-client';
import { face, onFace } from '../../platform/face';
import { element } from '../../platform/page';
import type { Session } from '../../state/session';
import { Study } from '../../state/study/study';
import type { Tools } from '../../view/tool-rail';
import type { Viewer } from '../../view/viewer';
import { setUpHalves } from './halves';
import { showMethods } from './methods';
import { PartsTree } from './parts-tree';
import { ThresholdMarks } from './threshold-marks';
import { showTimes } from './times';

/** Adds what only Inspect has. @param stage Undefined without WebGL. */
export function addInspect(session: Session, stage: { viewer: Viewer; tools: Tools } | undefined): void {
  const study = new Study(session, new TransferClient(), fetchLabels);
  if (stage) {
    new Explain(session, stage.viewer, stage.tools);
    setUpHalves(session, study, stage.viewer);
  }
  new PartsTree(session, stage?.viewer.stage);
  new ThresholdMarks(session);
  showMethods(session, study);
  showTimes(session, study);
  placeColumns();
  onFace((shown) => (study.active = shown === 'inspect'));
}

/** Where there is room, parts are a column at the left of the view, and the film strip lies below it; else they are in the panel. */
function placeColumns(): void {
  const [parts, film] = [element('parts', HTMLElement), element('method', HTMLDetailsElement)];
  const [main, panel] = [document.querySelector('main')!, element('controls', HTMLElement)];
  const [afterParts, afterFilm] = [parts.nextSibling, film.nextSibling];
  const wide = matchMedia('(width >= 80em) and (height > 520px)');
  const place = (): void => {
    const isWide = wide.matches && face() === 'inspect';
    if (isWide === (parts.parentElement === main)) return;
    if (isWide) {
      main.prepend(parts);
      panel.before(film);
    } else {
      panel.insertBefore(parts, afterParts);
      panel.insertBefore(film, afterFilm);
    }
    film.open = isWide;
  };
  wide.addEventListener('change', place);
  onFace(place);
}
