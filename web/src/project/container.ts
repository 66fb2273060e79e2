import { damaged, listOf, objectOf, textOf } from './checks';
import type { Files } from './project';

// A project file: 8 letters, two 32-bit numbers (little-endian), the text, then the files one after the other.
const kMagic = 'CAGECAST';
const kHead = 16; // bytes
/** Grows when older pages cannot read what newer ones write. */
export const kVersion = 1;
/** A number above this is no version, but letters of a text. */
const kMaxVersions = 255;
const kMaxText = 2 ** 24;
const kMaxFiles = 4096;

/** The file of a project; the parts are not copied. */
export function writeProject(parts: object, files: ReadonlyMap<string, Blob>): Blob {
  const list = [...files].map(([key, file]) => ({ key, name: nameOf(file), type: file.type, size: file.size }));
  const text = new TextEncoder().encode(JSON.stringify({ parts, files: list }));
  const head = new DataView(new ArrayBuffer(kHead));
  [...kMagic].forEach((letter, at) => head.setUint8(at, letter.charCodeAt(0)));
  head.setUint32(8, kVersion, true);
  head.setUint32(12, text.length, true);
  return new Blob([head, text, ...files.values()], { type: 'application/octet-stream' });
}

/** Reads the file of a project; it may be overwritten afterwards, as by saving the project again. @throws Error that says what is wrong. */
export async function readProject(file: Blob): Promise<{ parts: Record<string, unknown>; files: Files }> {
  const head = new DataView(await file.slice(0, kHead).arrayBuffer());
  const magic = String.fromCharCode(...new Uint8Array(head.buffer).subarray(0, kMagic.length));
  if (magic !== kMagic || head.byteLength < kHead || head.getUint32(8, true) > kMaxVersions)
    throw new Error('this is not a Cagecast project');
  if (head.getUint32(8, true) !== kVersion)
    throw new Error('this project was saved by a newer version of the page: reload the page and try again');
  const length = head.getUint32(12, true);
  if (length > kMaxText) damaged('its text is too long');
  const parsed: unknown = await file
    .slice(kHead, kHead + length)
    .text()
    .then(JSON.parse)
    .catch(() => damaged('its text cannot be read'));
  const saved = objectOf(parsed, 'content');
  const found = new Map<unknown, File>();
  let at = kHead + length;
  for (const entry of listOf(saved.files, kMaxFiles, 'files')) {
    const { key, name, type, size } = objectOf(entry, 'file');
    if (!(Number.isSafeInteger(size) && (size as number) >= 0)) damaged('a file has no size');
    const end = at + (size as number);
    if (end > file.size) damaged('it ends too early');
    found.set(
      key,
      new File([await file.slice(at, end).arrayBuffer()], textOf(name, 'file'), { type: textOf(type, '') }),
    );
    at = end;
  }
  return { parts: objectOf(saved.parts, 'content'), files: filesIn(found) };
}

/** Gives the files of a project by key. */
export const filesIn =
  (found: ReadonlyMap<unknown, File>): Files =>
  (key) =>
    found.get(key) ?? damaged('a file is missing');

/** The name of a file; paintings have none. */
export const nameOf = (file: Blob): string => (file instanceof File ? file.name : 'painting');
