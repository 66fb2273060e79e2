import { element, showError } from '../platform/page';
import { type Intake, kImage, kModel, kProject, sortFiles } from '../state/intake';
import { paths } from './file-paths';

const kMaxFiles = 1000;

/** The dropped files, including those in folders. @throws Error with a message for people. */
async function droppedFiles({ items, files }: DataTransfer): Promise<File[]> {
  const entries = [...items].flatMap((item) => item.webkitGetAsEntry() ?? []);
  // Use the files as they are: entries lose their media types.
  if (!entries.some(({ isDirectory }) => isDirectory)) return [...files];
  const found: File[] = [];
  const open = async (entry: FileSystemEntry): Promise<void> => {
    if (found.length >= kMaxFiles)
      throw new Error(`${entries[0]!.name}: the folder contains more than ${kMaxFiles} files`);
    if (isFile(entry)) {
      const file = await new Promise<File>((resolve, reject) => entry.file(resolve, reject));
      paths.set(file, entry.fullPath);
      return void found.push(file);
    }
    for (const inner of await entriesOf(entry as FileSystemDirectoryEntry)) await open(inner);
  };
  for (const entry of entries) await open(entry);
  if (found.length === 0) throw new Error(`${entries[0]!.name}: the folder is empty`);
  return found;
}

const isFile = (entry: FileSystemEntry): entry is FileSystemFileEntry => entry.isFile;

async function entriesOf(folder: FileSystemDirectoryEntry): Promise<FileSystemEntry[]> {
  const reader = folder.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    // Returns entries in batches, and an empty batch at the end.
    const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (some.length === 0) return all;
    all.push(...some);
  }
}

/**
 * Listens for files that are chosen, or dropped anywhere on the page.
 * @param onFiles A file given to one of the three fields gets the role of the field.
 * @param takes   Whether what was dropped is for somebody else, who takes it.
 */
export function setUpFiles(onFiles: (intake: Intake) => void, takes: (dropped: readonly File[]) => boolean): void {
  for (const role of ['target', 'cage', 'texture'] as const) {
    const input = element(`${role}-input`, HTMLInputElement);
    const tile = element(`${role}-file`, HTMLElement);
    const give = (files: File[]): void => {
      const models = files.filter(({ name }) => kModel.test(name));
      const isMixed = files.some(({ name }) => kProject.test(name)) || (role === 'target' && models.length > 1);
      if (isMixed && !takes(files)) onFiles(sortFiles(files));
      const main = isMixed
        ? undefined
        : (files.find((file) => (role === 'texture' ? kImage : kModel).test(file.name)) ?? files[0]);
      if (main) onFiles({ [role]: main, unclear: [], warnings: [], all: files });
    };
    input.addEventListener('change', () => {
      const files = [...(input.files ?? [])];
      input.value = ''; // lets the user choose the same file again
      give(files);
    });
    tile.addEventListener('drop', (event) => {
      const files = [...(event.dataTransfer?.files ?? [])];
      // The handler of the page sorts several files, and folders.
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
      (files) => files.length > 0 && !takes(files) && onFiles(sortFiles(files)),
      (error: Error) => showError(error.message),
    );
  });
}
