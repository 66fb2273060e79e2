import { InputError } from '../../../scene/input-error.js';

/** Bytes that a number takes in a binary file, by its type. */
export const sizes: Record<string, number> = {
  char: 1,
  int8: 1,
  uchar: 1,
  uint8: 1,
  short: 2,
  int16: 2,
  ushort: 2,
  uint16: 2,
  int: 4,
  int32: 4,
  uint: 4,
  uint32: 4,
  float: 4,
  float32: 4,
  double: 8,
  float64: 8,
};

/** A number and what parts it from the next one, in a text. */
const kText = 2;

/** Checks that a PLY is as long as its elements are, at least. A header that says nothing else is left to the loader. */
export function checkPly(bytes: Uint8Array): void {
  const end = endOfHeader(bytes);
  let isText = false;
  let element: { name: string; count: number; size: number } | undefined;
  let rest = bytes.length - end + 1; // what follows the last number may be missing
  const close = () => {
    if (!element) return;
    const { name, count, size } = element;
    const takes = `${count.toLocaleString('en')} elements "${name.slice(0, 40)}"`;
    if (size === 0 && count > 0) throw new InputError(`its header has ${takes} without a property`);
    rest -= count * size;
    if (rest < 0) throw new InputError(`its header has ${takes}, more than its ${bytes.length} bytes hold`);
  };
  for (const line of new TextDecoder('latin1').decode(bytes.subarray(0, end)).split(/[\r\n]/)) {
    const [word, first = '', second = ''] = line.trim().split(/\s+/, 3);
    if (word === 'format') isText = first === 'ascii';
    else if (word === 'element') {
      close();
      element = { name: first, count: Number.parseInt(second, 10) || 0, size: 0 };
    } else if (word === 'property' && element)
      element.size += isText ? kText : (sizes[first === 'list' ? second : first] ?? 1);
  }
  close();
}

/** Where the last word of the header ends; all of a file without it. */
export function endOfHeader(bytes: Uint8Array): number {
  const kWord = [...'end_header'].map((letter) => letter.charCodeAt(0));
  for (let at = bytes.indexOf(kWord[0]!); at >= 0; at = bytes.indexOf(kWord[0]!, at + 1))
    if (kWord.every((code, i) => bytes[at + i] === code)) return at + kWord.length;
  return bytes.length;
}
