import { type Dirent, readdirSync, statSync } from 'node:fs';
import { matcher } from '../../core/patterns.js';
import { listingError } from './files.js';

/**
 * The files that a pattern names, in order: `*` matches any text within a name, `**` any folders. Names that begin with a dot are
 * only matched by patterns that do. Links to folders are followed, except by `**`, which could go round in circles. A pattern without
 * `*` is returned as it is.
 * @throws {InputError} with the name of a folder that cannot be listed; a missing one has no files.
 */
export function filesOf(pattern: string): string[] {
  if (!pattern.includes('*')) return [pattern];
  const segments = pattern.replaceAll('\\', '/').split('/');
  const first = segments.findIndex((segment) => segment.includes('*'));
  return walk(
    segments
      .slice(0, first)
      .map((name) => `${name}/`)
      .join(''),
    segments.slice(first),
  );
}

/** @param prefix  The path of a folder with a slash at its end; empty for the current one. */
function walk(prefix: string, [segment = '', ...rest]: string[]): string[] {
  const entries = list(prefix.length > 1 ? prefix.slice(0, -1) : prefix || '.');
  const inside = (folders: Dirent[], segments: string[]) =>
    folders.flatMap(({ name }) => walk(`${prefix}${name}/`, segments));
  const isHidden = ({ name }: Dirent) => name.startsWith('.');
  if (segment === '**') {
    const folders = entries.filter((entry) => entry.isDirectory() && !isHidden(entry));
    return [...walk(prefix, rest), ...inside(folders, [segment, ...rest])];
  }
  const matches = matcher(segment);
  const fitting = entries.filter((entry) => matches(entry.name) && (segment.startsWith('.') || !isHidden(entry)));
  const isFolder = (entry: Dirent) =>
    entry.isDirectory() || (entry.isSymbolicLink() && leadsToFolder(`${prefix}${entry.name}`));
  if (rest.length > 0) return inside(fitting.filter(isFolder), rest);
  return fitting.filter((entry) => !isFolder(entry)).map(({ name }) => `${prefix}${name}`);
}

function list(folder: string): Dirent[] {
  try {
    return readdirSync(folder, { withFileTypes: true }).sort((a, b) => (a.name < b.name ? -1 : 1));
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
