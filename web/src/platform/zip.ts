/** The remainders of CRC-32, by the lowest byte. */
const kTable = Uint32Array.from({ length: 256 }, (_, byte) => {
  for (let bit = 0; bit < 8; bit++) byte = byte & 1 ? 0xedb88320 ^ (byte >>> 1) : byte >>> 1;
  return byte >>> 0;
});

function crc32(bytes: Uint8Array): number {
  let crc = 0xffffffff;
  for (const byte of bytes) crc = kTable[(crc ^ byte) & 255]! ^ (crc >>> 8);
  return ~crc >>> 0;
}

/** Numbers of 2 or 4 bytes, lowest byte first: those of 2 bytes are given as texts. */
function record(...fields: (number | `${number}`)[]): Uint8Array<ArrayBuffer> {
  const bytes = fields.flatMap((field) => {
    const value = Number(field);
    const low = [value & 255, (value >>> 8) & 255];
    return typeof field === 'string' ? low : [...low, (value >>> 16) & 255, value >>> 24];
  });
  return Uint8Array.from(bytes);
}

const kUtf8 = '2048'; // the flag for names in UTF-8
const kByUnix = '788'; // version 2.0, made by Unix: on other systems some programs take names to be in an old code page
const kPlainFile = 0x81a40000; // that its owner may write and all may read
const kFirstDay = '33'; // 1 January 1980, the earliest date of the format

/**
 * Puts files into one, uncompressed, as models and pictures hardly get smaller.
 * @param files Less than 4 GB in all.
 */
export async function zip(files: readonly { name: string; blob: Blob }[]): Promise<Blob> {
  const [parts, entries]: [BlobPart[], Uint8Array<ArrayBuffer>[]] = [[], []];
  let at = 0;
  for (const { name, blob } of files) {
    const encoded = new TextEncoder().encode(name);
    const crc = crc32(new Uint8Array(await blob.arrayBuffer()));
    const { size } = blob;
    const common = ['20', kUtf8, '0', '0', kFirstDay, crc, size, size, `${encoded.length}`, '0'] as const;
    const head = record(0x04034b50, ...common);
    parts.push(head, encoded, blob);
    entries.push(record(0x02014b50, kByUnix, ...common, '0', '0', '0', kPlainFile, at), encoded);
    at += head.length + encoded.length + size;
  }
  const length = entries.reduce((sum, entry) => sum + entry.length, 0);
  const count = `${files.length}` as const;
  const end = record(0x06054b50, '0', '0', count, count, length, at, '0');
  return new Blob([...parts, ...entries, end], { type: 'application/zip' });
}

/** A name that every system can unpack: projects come from strangers, who name their files as they like. */
export function plainName(name: string): string {
  const plain = name.replace(/[\p{Cc}"*/:<>?\\|]/gu, '-').replace(/^[.\s]+/, '');
  return [...plain].slice(0, 50).join(''); // 200 bytes at most, of 255
}

/** Such a name, that no other file has. */
export function freeName(stem: string, ending: string, files: readonly { name: string }[]): string {
  const short = plainName(stem) || 'avatar';
  for (let number = 1; ; number++) {
    const name = `${short}${number > 1 ? `-${number}` : ''}-painted.${ending}`;
    if (!files.some((file) => file.name.toLowerCase() === name.toLowerCase())) return name;
  }
}

const kEntry = 46; // bytes of an entry without its name
const kHead = 30; // bytes before a file, without its name
const kEnd = 22; // bytes of the last record

/** Finds the files in a file that `zip` made, without reading them; undefined if it is none. */
export async function unzip(file: Blob): Promise<Map<string, Blob> | undefined> {
  const view = async (from: number, to: number): Promise<DataView> =>
    new DataView(await file.slice(from, to).arrayBuffer());
  const last = file.size - kEnd;
  const end = last < 0 ? undefined : await view(last, file.size);
  if (end?.getUint32(0, true) !== 0x06054b50) return undefined;
  const list = await view(end.getUint32(16, true), last);
  const found = new Map<string, Blob>();
  let total = 0;
  for (let at = 0; at + kEntry <= list.byteLength; ) {
    const [size, length] = [list.getUint32(at + 24, true), list.getUint16(at + 28, true)];
    const isStored = list.getUint32(at, true) === 0x02014b50 && list.getUint16(at + 10, true) === 0;
    const next = at + kEntry + length;
    const from = list.getUint32(at + 42, true) + kHead + length;
    total += size;
    // Files that share their bytes would make a large project of a small file.
    if (!isStored || next > list.byteLength || from + size > last || total > file.size) return undefined;
    const name = new TextDecoder().decode(new Uint8Array(list.buffer, at + kEntry, length));
    found.set(name, file.slice(from, from + size));
    at = next;
  }
  return found.size === end.getUint16(10, true) ? found : undefined;
}
