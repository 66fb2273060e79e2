import { warnBeforeLeaving } from '../platform/leave';
import { flags } from '../platform/shelf';
import { type ProjectOfPage, setUpProjects } from './projects';

/**
 * Begins to keep the page's work: at once if there is some, else after the first model is shown, so that the store does not
 * compete with it.
 * @returns A function that brings work back; it says whether it tried and failed.
 */
export function beginProjects(page: ProjectOfPage): () => Promise<boolean> {
  const projects = setUpProjects(page);
  page.opener.onProject = (file) => void projects.open(file);
  warnBeforeLeaving(page.history, () => projects.isKept);
  if (flags.get('work')) return () => projects.restore();
  const end = page.session.on('progress', ({ state }) => {
    if (state === 'working') return;
    end();
    void projects.restore();
  });
  return async () => false;
}
