import { readdirSync, statSync } from 'node:fs';
import { listingError } from '../gltf/files.js';
import { matcher } from './options.js';

/**
 * The files that a pattern names, in order: `*` matches any text within a name, `**` any folders. Names that begin with a dot are
 * only matched by patterns that do. Links to folders are followed, except by `**`, which could go round in circles. A pattern without
 * `*` is returned as it is.
 * @throws {InputError} that names a folder that cannot be listed; one that is not there has no files.
 */
export function filesOf(pattern: string): string[] {
  if (!pattern.includes('*')) return [pattern];
  const segments = pattern.replaceAll('\\', '/').split('/');
  const firstStar = segments.findIndex((segment) => segment.includes('*'));
  return walk(segments.slice(0, firstStar).join('/'), pattern.startsWith('/'), segments.slice(firstStar));
}

function walk(folder: string, isAbsolute: boolean, [segment = '', ...rest]: string[]): string[] {
  const place = folder || (isAbsolute ? '/' : '.');
  const at = (name: string) => (folder === '' && !isAbsolute ? name : `${folder}/${name}`);
  const entries = list(place);
  const inside = (names: string[], segments: string[]) => names.flatMap((name) => walk(at(name), isAbsolute, segments));
  const folders = entries.filter(({ isFolder }) => isFolder);
  if (segment === '**') {
    const shown = folders.filter(({ name, isLink }) => !isLink && !name.startsWith('.')).map(({ name }) => name);
    return [...walk(folder, isAbsolute, rest), ...inside(shown, [segment, ...rest])];
  }
  const matches = matcher(segment);
  const fits = (name: string) => matches(name) && (segment.startsWith('.') || !name.startsWith('.'));
  const names = (some: Entry[]) => some.map(({ name }) => name).filter(fits);
  if (rest.length > 0) return inside(names(folders), rest);
  return names(entries.filter(({ isFolder }) => !isFolder)).map(at);
}

interface Entry {
  name: string;
  isFolder: boolean;
  isLink: boolean;
}

function list(folder: string): Entry[] {
  try {
    const entries = readdirSync(folder, { withFileTypes: true }).map((entry) => {
      const isLink = entry.isSymbolicLink();
      return {
        name: entry.name,
        isFolder: isLink ? leadsToFolder(`${folder}/${entry.name}`) : entry.isDirectory(),
        isLink,
      };
    });
    return entries.sort((a, b) => (a.name < b.name ? -1 : 1));
  } catch (error) {
    if (['ENOENT', 'ENOTDIR'].includes((error as NodeJS.ErrnoException).code!)) return [];
    throw listingError(error);
  }
}

function leadsToFolder(link: string): boolean {
  try {
    return statSync(link).isDirectory();
  } catch {
    return false; // It leads nowhere, or to itself.
  }
}
