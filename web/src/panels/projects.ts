import type { History } from '#three';
import { readLink, readLook } from '../export/link';
import { loadPaint } from '../loading/load-paint';
import type { Opener } from '../loading/opener';
import { paintName } from '../loading/samples';
import { ask } from '../platform/ask';
import { download } from '../platform/download';
import { pack, unpack } from '../platform/pack';
import { announce, element, showError } from '../platform/page';
import { readProject, writeProject } from '../platform/project-file';
import { shelfOf } from '../platform/shelf';
import type { CageMaker } from '../state/cage-maker';
import type { Loader } from '../state/model';
import { barePart } from '../state/project/bare-part';
import { cagePart } from '../state/project/cage-part';
import { Keeper } from '../state/project/keeper';
import { type LayersOfPage, layersPart } from '../state/project/layers-part';
import { Project } from '../state/project/project';
import { scenePart } from '../state/project/scene-part';
import { settingsParts, viewPart } from '../state/project/settings-parts';
import { wardrobePart } from '../state/project/wardrobe-part';
import type { WardrobeOfPage } from '../state/wardrobe/kept';
import type { Live } from '../tools/live/live-panel';
import type { Viewer } from '../view/viewer';
import { brushPart } from './brush-part';

/** What projects are made of. */
export interface ProjectOfPage extends Omit<LayersOfPage, 'samples' | 'images'> {
  loader: Loader;
  opener: Opener;
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

const kBrief = 10_000; // milliseconds

export function setUpProjects(page: ProjectOfPage): Projects {
  const { session, stack, history, live, viewer, wardrobe } = page;
  const samples = page.opener;
  const project = new Project(session, scenePart(session, samples, page.loader));
  const images = {
    check: async (...given: Parameters<LayersOfPage['images']['check']>) =>
      (await import('../loading/given-file')).checkPictures(...given),
    load: loadPaint,
    nameOf: paintName,
    pack,
    unpack,
  };
  const templates = [...element('template-select', HTMLSelectElement).options].map(({ value }) => value);
  const parts = [
    layersPart({ ...page, samples, images }),
    ...settingsParts(session, live),
    brushPart,
    barePart(session),
    cagePart({ session, samples, templates }, wardrobe),
    ...(wardrobe ? [wardrobePart(wardrobe)] : []),
    viewPart(session, viewer?.controls),
  ];
  for (const part of parts) project.add(part);
  const shelf = shelfOf((fragment) => (readLink(fragment) ?? readLook(fragment)) !== undefined);
  let close = (): void => {};
  const keeper = new Keeper({ project, session, history }, shelf, {
    offer(offer) {
      close();
      if (!offer) return;
      const { text, action, isBrief } = offer;
      close = ask({ text, answers: action ? [action] : [], ...(isBrief && { lasts: kBrief }) });
    },
    note: (text) => void (element('kept-note', HTMLElement).textContent = text),
    error: showError,
  });
  document.addEventListener('visibilitychange', () => document.hidden && void keeper.save());
  // Else the link in the address bar, which is opened now, would be opened instead of the work at the next visit.
  addEventListener('hashchange', () => project.touch());
  page.opener.onReplace = (target) => (target ? keeper.replaceBy(target) : keeper.putAside());
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
      for (const [key, make] of files) made.set(key, await make());
      download(await writeProject(parts, made), `${session.shown!.target.name.replace(/\.\w+$/, '')}.cagecast`);
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
