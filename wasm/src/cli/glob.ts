import { type Dirent, readdirSync } from 'node:fs';
import { matcher } from './options.js';

/**
 * The files that a pattern names, in order: `*` matches any text within a name, `**` any folders. Names that begin with a dot are
 * only matched by patterns that do. A pattern without `*` is returned as it is.
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
  const folders = entries.filter((entry) => entry.isDirectory()).map(({ name }) => name);
  if (segment === '**') {
    const shown = folders.filter((name) => !name.startsWith('.'));
    return [...walk(folder, isAbsolute, rest), ...inside(shown, [segment, ...rest])];
  }
  const matches = matcher(segment);
  const fits = (name: string) => matches(name) && (segment.startsWith('.') || !name.startsWith('.'));
  if (rest.length > 0) return inside(folders.filter(fits), rest);
  return entries.filter((entry) => !entry.isDirectory() && fits(entry.name)).map(({ name }) => at(name));
}

function list(folder: string): Dirent[] {
  try {
    return readdirSync(folder, { withFileTypes: true }).sort((a, b) => (a.name < b.name ? -1 : 1));
  } catch {
    return [];
  }
}
