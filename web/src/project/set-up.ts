import type { History } from 'cagecast/three/paint';
import type { Live } from '../live/live-panel';
import { download } from '../platform/download';
import { announce, element, showError } from '../platform/page';
import type { CageMaker } from '../scene/cage-maker';
import type { Viewer } from '../view/viewer';
import type { WardrobeOfPage } from '../wardrobe/set-up-wardrobe';
import { barePart } from './bare-part';
import { cagePart, landmarksPart } from './cage-part';
import { nameOf, readProject, writeProject } from './container';
import { Keeper, type Offer } from './keeper';
import { type LayersOfPage, layersPart } from './layers-part';
import { Project } from './project';
import { scenePart } from './scene-part';
import { settingsParts } from './settings-parts';
import { wardrobePart } from './wardrobe-part';

/** What projects are made of. */
export interface ProjectOfPage extends LayersOfPage {
  history: History;
  maker: CageMaker;
  live: Live;
  /** Undefined without WebGL, as is the wardrobe. */
  viewer: Viewer | undefined;
  wardrobe: WardrobeOfPage | undefined;
}

/** Keeps the page's work in the browser, and saves and opens it as a file. */
interface Projects {
  /** For features that join. */
  project: Project;
  /** Brings back what was kept. @returns Whether that failed. */
  restore(): Promise<boolean>;
  open(file: File): Promise<void>;
  /** Whether nothing would be lost by leaving now. */
  readonly isKept: boolean;
}

export function setUpProjects(page: ProjectOfPage): Projects {
  const { session, stack, history, live, viewer, wardrobe } = page;
  const project = new Project(session, scenePart(session, page.opener, viewer?.renderer));
  project.add(layersPart(page));
  for (const part of settingsParts(session, live, viewer?.controls)) project.add(part);
  project.add(barePart(session));
  project.add(cagePart(session, page.opener, wardrobe));
  project.add(landmarksPart(page.maker));
  if (wardrobe) project.add(wardrobePart(wardrobe));
  const keeper = new Keeper(project, session, history, {
    offer: showOffer,
    note: (text) => void (element('kept-note', HTMLElement).textContent = text),
  });
  page.opener.onReplace = () => void keeper.putAside();
  const touch = (): void => project.touch();
  for (const event of ['zones', 'rules', 'view', 'paint'] as const) session.on(event, touch);
  for (const event of ['change', 'select'] as const) stack.on(event, touch);
  history.on('change', touch);
  if (wardrobe) wardrobe.onChange = touch;

  const open = async (file: File): Promise<void> => {
    try {
      const { parts, files } = await readProject(file);
      if (await keeper.open(parts, files)) announce(`${file.name} is open.`);
    } catch (error) {
      session.fail(new Error(`${file.name}: ${(error as Error).message}`, { cause: error }));
    }
  };
  const save = element('save-project', HTMLButtonElement);
  session.on('zones', () => (save.disabled = false));
  save.addEventListener('click', async () => {
    try {
      const { parts, files } = project.snapshot()!;
      const made = new Map<string, Blob>();
      for (const [key, make] of files) {
        const file = await make();
        // Of one that cannot be read, the download would fail without a word.
        await file
          .slice(0, 1)
          .arrayBuffer()
          .catch(() => {
            throw new Error(`${nameOf(file)}: the file was changed or deleted after it was opened; open it again`);
          });
        made.set(key, file);
      }
      download(writeProject(parts, made), `${session.shown!.target.name.replace(/\.\w+$/, '')}.cagecast`);
      announce('Project saved.');
    } catch (error) {
      showError(`The project could not be saved: ${(error as Error).message}`);
    }
  });
  const input = element('open-project', HTMLInputElement);
  input.addEventListener('change', () => {
    const [file] = input.files ?? [];
    input.value = ''; // so that the same file can be chosen again
    if (file) void open(file);
  });
  return {
    project,
    open,
    restore: () => keeper.restore(),
    get isKept() {
      return keeper.isKept;
    },
  };
}

function showOffer({ text, action }: Offer): void {
  const [box, button] = [element('kept', HTMLElement), element('kept-action', HTMLButtonElement)];
  box.querySelector('p')!.textContent = text;
  button.hidden = action === undefined;
  button.textContent = action?.title ?? '';
  button.onclick = () => {
    // What follows says its own.
    box.hidden = true;
    action?.run();
  };
  box.hidden = false;
}
