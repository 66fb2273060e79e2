import { damaged, listOf, objectOf, textOf } from '../state/project/checks';
import { type Files, filesIn, kVersion } from '../state/project/project';
import { plainName, unzip, zip } from './zip';

// A project file is a ZIP: this text lists the other files in it.
const kText = 'project.json';
const kMaxText = 2 ** 24;
const kMaxFiles = 4096;

/** The file of a project. @throws Error that names a file which cannot be read any more. */
export async function writeProject(parts: object, files: ReadonlyMap<string, Blob>): Promise<Blob> {
  const entries = [...files].map(([key, blob], number) => {
    const name = blob instanceof File ? blob.name : 'painting';
    return { key, blob, name, type: blob.type, path: `${number + 1}-${plainName(name)}` };
  });
  for (const { blob, name } of entries)
    await blob
      .slice(0, 1)
      .arrayBuffer()
      .catch(() => {
        throw new Error(`${name}: the file was changed or deleted after it was opened; open it again`);
      });
  const list = entries.map(({ key, name, type, path }) => ({ key, name, type, path }));
  const text = new Blob([JSON.stringify({ version: kVersion, parts, files: list })]);
  return zip([{ name: kText, blob: text }, ...entries.map(({ path, blob }) => ({ name: path, blob }))]);
}

/** Reads the file of a project; it may be overwritten afterwards, as by saving the project again. @throws Error that says what is wrong. */
export async function readProject(file: Blob): Promise<{ parts: Record<string, unknown>; files: Files }> {
  const all = await unzip(file);
  const text = all?.get(kText);
  if (!all || !text) throw new Error('this is not a Cagecast project, or not a whole one');
  if (text.size > kMaxText) damaged('its text is too long');
  const parsed: unknown = await text
    .text()
    .then(JSON.parse)
    .catch(() => damaged('its text cannot be read'));
  const { version, parts, files } = objectOf(parsed, 'content');
  if (version !== kVersion)
    throw new Error('this project was saved by another version of the page: reload the page and try again');
  const found = new Map<unknown, File>();
  for (const entry of listOf(files, kMaxFiles, 'files')) {
    const { key, name, type, path } = objectOf(entry, 'file');
    const blob = all.get(textOf(path, '')) ?? damaged('a file is missing');
    found.set(key, new File([await blob.arrayBuffer()], textOf(name, 'file'), { type: textOf(type, '') }));
  }
  return { parts: objectOf(parts, 'content'), files: filesIn(found) };
}
