import { exceeds } from '../../checks/read-limits.js';
import { type FormatLimits, mostBytes } from '../limits.js';

/** Lines are looked at by their first letter alone, as the loader does: `gA` begins a group, too. */
const kGroup = /(?:^|\n)[^\S\n]*[gou]/g;
const kLibrary = /(?:^|\n)[^\S\n]*mtllib[^\S\n]([^\n]*)/g;
const kMaterial = /(?:^|\n)[^\S\n]*newmtl/gi;

function countOf(text: string, pattern: RegExp): number {
  let count = 0;
  for (const _ of text.matchAll(pattern)) ++count;
  return count;
}

/** Checks the groups of an OBJ, each of which becomes an object. */
export function checkObj(bytes: Uint8Array, limits: FormatLimits): void {
  const groups = countOf(new TextDecoder().decode(bytes), kGroup);
  if (groups > limits.parts) throw exceeds(`has ${groups.toLocaleString('en')} groups`, 'parts', limits);
}

/** The libraries of materials that an OBJ names, each once: several in a line, with blanks in their names, or in quotes. */
export function librariesOf(text: string): string[] {
  const names = Array.from(text.matchAll(kLibrary), ([, line]) =>
    line!.split(/(?<=\.mtl"?)\s/i).map((name) => plainPath(name.replaceAll('"', ''))),
  );
  return [...new Set(names.flat())].filter((name) => name !== '');
}

/** A path with slashes, without detours, in which one file would have many names. */
function plainPath(name: string): string {
  const parts: string[] = [];
  for (const part of name.trim().replaceAll('\\', '/').split('/')) {
    if (part === '..' && parts.length > 0 && parts.at(-1) !== '..') parts.pop();
    else if (part !== '.' && (part !== '' || parts.length === 0)) parts.push(part);
  }
  return parts.join('/');
}

/** Checks the libraries of an OBJ together, before they are read. @param bytes  Of the OBJ. */
export function checkLibraries(libraries: readonly Uint8Array[], bytes: number, limits: FormatLimits): void {
  const most = mostBytes(bytes, limits);
  if (libraries.reduce((sum, { length }) => sum + length, 0) > most)
    throw exceeds(`its libraries have more than ${most.toLocaleString('en')} bytes`, 'expansion', limits);
}

/** Checks how many materials they have. */
export function checkMaterials(text: string, limits: FormatLimits): void {
  const materials = countOf(text, kMaterial);
  if (materials > limits.parts) throw exceeds(`has ${materials.toLocaleString('en')} materials`, 'parts', limits);
}
