import { element, showError } from '../platform/page';

/** What a file is taken for. */
export type Role = 'target' | 'cage' | 'texture';

/** Files that came in together. */
export interface Intake {
  target?: File | undefined;
  cage?: File | undefined;
  texture?: File | undefined;
  /** Models of which it is not clear yet which is the target. */
  unclear: File[];
  /** What is doubtful about it, in words. */
  doubts: string[];
  /** Everything that came along: a .gltf finds its .bin and images here. */
  all: File[];
}

const kModel = /\.(glb|gltf)$/i;
const kCage = /cage/i;
const kImage = /\.(png|jpe?g|webp)$/i;

/**
 * Sorts files by what they are: models by name, images as paint unless a .gltf came with them.
 * A file that is neither is taken for a target if there is nothing else, so that the reader says what is wrong with it.
 */
export function sortFiles(all: readonly File[]): Intake {
  const models = all.filter(({ name }) => kModel.test(name));
  const others = all.filter((file) => !models.includes(file));
  const [cages, rest] = [models.filter(({ name }) => kCage.test(name)), models.filter(({ name }) => !kCage.test(name))];
  // What comes with a .gltf is a part of it.
  const withGltf = models.some(({ name }) => /\.gltf$/i.test(name));
  const images = withGltf ? [] : others.filter(({ name, type }) => kImage.test(name) || type.startsWith('image/'));
  const intake: Intake = { texture: images.at(-1), unclear: [], doubts: [], all: [...all] };
  const known = cages.length === 1 || (cages.length > 0 && rest.length > 0) || models.length === 1;
  if (known) [intake.cage, intake.target] = [cages[0], rest[0]];
  else if (models.length > 1) intake.unclear = models.slice(0, 2);
  else if (images.length === 0) intake.target = others[0];

  const [one, other] = intake.unclear;
  if (one && other && cages.length > 0)
    intake.doubts.push(
      `${one.name} and ${other.name} are both called cages: the one with more triangles is taken for the target.`,
    );
  const used = [intake.target, intake.cage, intake.texture, one, other];
  const [left, ...more] = (withGltf ? models : all).filter((file) => !used.includes(file));
  if (left)
    intake.doubts.push(
      `${left.name}${more.length > 0 ? ` and ${more.length} more are` : ' is'} left out: one target, one cage and one paint are taken at a time.`,
    );
  return intake;
}

const kMostFiles = 1000;

/** The files that are dropped, those in folders too. @throws Error in plain words. */
async function droppedFiles({ items, files }: DataTransfer): Promise<File[]> {
  const entries = [...items].flatMap((item) => item.webkitGetAsEntry() ?? []);
  // As they come: entries lose what kind of file each is said to be.
  if (!entries.some(({ isDirectory }) => isDirectory)) return [...files];
  const found: File[] = [];
  const open = async (entry: FileSystemEntry): Promise<void> => {
    if (found.length >= kMostFiles)
      throw new Error(`${entries[0]!.name}: there are more than ${kMostFiles} files in this folder`);
    if (isFile(entry))
      return void found.push(await new Promise<File>((resolve, reject) => entry.file(resolve, reject)));
    for (const inner of await entriesOf(entry as FileSystemDirectoryEntry)) await open(inner);
  };
  for (const entry of entries) await open(entry);
  if (found.length === 0) throw new Error(`${entries[0]!.name}: this folder is empty`);
  return found;
}

const isFile = (entry: FileSystemEntry): entry is FileSystemFileEntry => entry.isFile;

async function entriesOf(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    // It gives some hundred at a time, and none when there are no more.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return all;
    all.push(...some);
  }
}

/**
 * Listens for files that are chosen or dropped, anywhere on the page.
 * @param onFiles Called with what came in; the role is known where a file was given to one of the three fields.
 */
export function setUpFiles(onFiles: (intake: Intake) => void): void {
  for (const role of ['target', 'cage', 'texture'] as const) {
    const input = element(`${role}-input`, HTMLInputElement);
    const tile = element(`${role}-file`, HTMLElement);
    const give = (files: File[]): void => {
      const main = files.find((file) => (role === 'texture' ? kImage : kModel).test(file.name)) ?? files[0];
      if (main) onFiles({ [role]: main, unclear: [], doubts: [], all: files });
    };
    input.addEventListener('change', () => {
      const files = [...(input.files ?? [])];
      input.value = ''; // so that the same file, edited, can be chosen again
      give(files);
    });
    tile.addEventListener('drop', (event) => {
      const files = [...(event.dataTransfer?.files ?? [])];
      // Several, or a folder of them: sorted by what they are.
      if (files.length !== 1 || event.dataTransfer!.items[0]?.webkitGetAsEntry()?.isDirectory) return;
      event.preventDefault();
      event.stopPropagation();
      hideVeil();
      give(files);
    });
  }

  const veil = element('veil', HTMLElement);
  const hideVeil = (): void => void (veil.hidden = true);
  addEventListener('dragover', (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    event.dataTransfer.dropEffect = 'copy';
    veil.hidden = false;
  });
  addEventListener('dragleave', (event) => {
    if (!event.relatedTarget) hideVeil();
  });
  addEventListener('drop', (event) => {
    event.preventDefault();
    hideVeil();
    if (!event.dataTransfer) return;
    droppedFiles(event.dataTransfer).then(
      (files) => files.length > 0 && onFiles(sortFiles(files)),
      (error: Error) => showError(error.message),
    );
  });
}
