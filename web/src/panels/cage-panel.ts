import type { TemplateName } from 'cagecast/cages';
import { download } from '../platform/download';
import { element } from '../platform/page';
import type { CageMaker } from '../state/cage-maker';
import type { Session } from '../state/session';

/** Connects the fields and buttons with which cages are made, fitted and saved. */
export function setUpCagePanel(session: Session, maker: CageMaker): void {
  const template = element('template-select', HTMLSelectElement);
  const save = element('save-cage', HTMLButtonElement);
  element('make-cage', HTMLButtonElement).addEventListener('click', () => maker.make());
  element('fit-cage', HTMLButtonElement).addEventListener('click', () => maker.fit(template.value as TemplateName));
  save.addEventListener('click', () => {
    const [file] = session.shown!.cage.files;
    download(file!, file!.name);
  });
  maker.on('template', (likely) => (template.value = likely));
  maker.on('notes', ({ note, missing }) => {
    if (note !== undefined) element('cage-note', HTMLElement).textContent = note;
    if (missing !== undefined) element('cage-missing', HTMLElement).textContent = missing;
  });
  session.on('transfer', ({ target, cage }) => {
    element('no-cage', HTMLElement).hidden = target.sample !== undefined && target.sample === cage.sample;
    // Of several files, saving the first would not do.
    save.hidden = cage.sample !== undefined || cage.files.length > 1;
  });
}
