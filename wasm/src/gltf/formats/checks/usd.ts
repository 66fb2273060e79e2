import { InputError } from '../../../scene/input-error.js';
import { exceeds } from '../../checks/read-limits.js';
import type { FormatLimits } from '../limits.js';
import { checkBraces } from './nesting.js';

/** LZ4 makes a byte of at most 255, and a coded integer has at least 2 bits. */
const [kMaxBytesPerByte, kMaxIntegersPerByte] = [255, 4 * 255];

/**
 * Checks how deep the prims of a text are nested, and the counts of a binary layer. Of a USDZ, the files must be stored, as the format demands, not compressed, and no byte
 * may be in many of them.
 */
export function checkUsd(bytes: Uint8Array, limits: FormatLimits): void {
  if (bytes[0] !== 0x50 || bytes[1] !== 0x4b) checkLayer(bytes, limits);
  else
    for (const { name, content } of filesIn(bytes, limits)) if (/\.usd[ac]?$/i.test(name)) checkLayer(content, limits);
}

function checkLayer(bytes: Uint8Array, limits: FormatLimits): void {
  const isBinary = new TextDecoder().decode(bytes.subarray(0, 8)) === 'PXR-USDC';
  if (isBinary) checkSections(bytes);
  else checkBraces(bytes, 'prims', limits);
}

/** Checks counts at the beginning of sections of a binary layer against their sizes. */
function checkSections(bytes: Uint8Array): void {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const numberAt = (at: number): number => (at + 8 <= bytes.length ? Number(view.getBigUint64(at, true)) : 0);
  const list = numberAt(16);
  const kSection = 32; // bytes: a name, where it begins, how long it is
  for (let i = 0; i < numberAt(list) && list + 8 + kSection * (i + 1) <= bytes.length; ++i) {
    const at = list + 8 + kSection * i;
    const name = new TextDecoder().decode(bytes.subarray(at, at + 16)).replace(/\0.*/s, '');
    if (name !== 'TOKENS' && name !== 'PATHS') continue;
    const begin = numberAt(at + 16);
    const size = Math.min(numberAt(at + 24), Math.max(0, bytes.length - begin));
    const [count, unpacked] = [numberAt(begin), name === 'TOKENS' ? numberAt(begin + 8) : 0];
    if (count > kMaxIntegersPerByte * size || unpacked > kMaxBytesPerByte * size)
      throw new InputError(`its section ${name} says to have more than its ${size} bytes hold`);
  }
}

interface File {
  name: string;
  content: Uint8Array;
}

function filesIn(bytes: Uint8Array, limits: FormatLimits): File[] {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const end = endOfArchive(view);
  if (end === undefined) throw new InputError('its archive has no end');
  const count = view.getUint16(end + 8, true);
  let at = view.getUint32(end + 16, true);
  const isLong = end >= 20 && view.getUint32(end - 20, true) === 0x07064b50;
  if (isLong || count === 0xffff || at === 0xffffffff)
    throw new InputError('its archive is of the kind ZIP64, which USDZ is not');
  if (count > limits.parts) throw exceeds(`has ${count.toLocaleString('en')} files`, 'parts', limits);
  let all = 0;
  const files: File[] = [];
  for (let file = 0; file < count; ++file) {
    if (at + 46 > bytes.length) throw new InputError('the list of its files is damaged');
    const method = view.getUint16(at + 10, true);
    if (method !== 0)
      throw new InputError(`file ${file + 1} in it is compressed; in a USDZ, files are stored as they are`);
    all += view.getUint32(at + 20, true);
    if (all > bytes.length) throw new InputError(`the files in it have more bytes than its ${bytes.length} together`);
    const name = new TextDecoder().decode(bytes.subarray(at + 46, at + 46 + view.getUint16(at + 28, true)));
    const local = view.getUint32(at + 42, true);
    if (local + 30 > bytes.length) throw new InputError('the list of its files is damaged');
    const begin = local + 30 + view.getUint16(local + 26, true) + view.getUint16(local + 28, true);
    files.push({ name, content: bytes.subarray(begin, begin + view.getUint32(at + 20, true)) });
    at += 46 + [28, 30, 32].reduce((sum, length) => sum + view.getUint16(at + length, true), 0);
  }
  return files;
}

/** Where the record at the end of a ZIP begins, which a comment may follow. */
function endOfArchive(view: DataView): number | undefined {
  for (let at = view.byteLength - 22; at >= Math.max(0, view.byteLength - 22 - 0xffff); --at)
    if (view.getUint32(at, true) === 0x06054b50) return at;
  return undefined;
}
