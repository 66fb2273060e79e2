// Edits of any file: of its bytes, of the numbers and words in it, and of how often something is there. Each is a function, made by
// fast-check, which finds the fewest edits that are enough for a fault.
import fc from 'fast-check';

type Edit = (bytes: Buffer) => Buffer;

/** Places are shares of a length, in 2^24ths, so that an edit means something in any file. */
const kPlaces = 2 ** 24;
const place = fc.nat({ max: kPlaces - 1 });
const at = (where: number, count: number): number => Math.floor((where / kPlaces) * count);

/** A file is at most this long after its edits, as the promise is about small files. */
const kMaxBytes = 900_000;

/** Sizes and counts that readers trip over. */
const count = fc.oneof(
  fc.constantFrom(0, 1, 2, 3, 0x7f, 0xff, 0x7fff, 0xffff, 2 ** 24, 2 ** 28, 2 ** 31 - 1, 2 ** 31, 2 ** 32 - 1, 2 ** 32),
  fc.nat({ max: 300 }),
);
/** How often something is there: mostly a few times, seldom so often that a square of it hurts. */
const times = fc.oneof(
  { weight: 12, arbitrary: fc.constantFrom(0, 2, 3, 9) },
  { weight: 1, arbitrary: fc.constantFrom(1000, 20_000) },
);
const numberText = fc.oneof(
  count.map(String),
  count.map((n) => String(-n)),
  fc.constantFrom(
    'NaN',
    'nan',
    'inf',
    '-inf',
    '1e400',
    '-1e39',
    '1e-46',
    '9007199254740993',
    '0x10',
    '1_000',
    '.',
    '--1',
  ),
  fc.float().map(String),
);
/** Words that mean something to JavaScript. */
const objectWord = fc.constantFrom(
  '__proto__',
  'constructor',
  'prototype',
  'toString',
  'length',
  'hasOwnProperty',
  'then',
);

const sameLength: fc.Arbitrary<Edit> = fc.oneof(
  fc.tuple(place, fc.nat({ max: 255 })).map(([where, value]) => (bytes) => {
    const out = Buffer.from(bytes);
    if (out.length > 0) out[at(where, out.length)] = value;
    return out;
  }),
  // A number of four or eight bytes.
  fc.tuple(place, count, fc.boolean()).map(([where, value, isLong]) => (bytes) => {
    const out = Buffer.from(bytes);
    const size = isLong ? 8 : 4;
    if (out.length < size) return out;
    const begin = at(where, out.length - size + 1);
    if (isLong) out.writeBigUInt64LE(BigInt(value), begin);
    else out.writeUInt32LE(value % 2 ** 32, begin);
    return out;
  }),
  fc.tuple(place, fc.float()).map(([where, value]) => (bytes) => {
    const out = Buffer.from(bytes);
    if (out.length >= 4) out.writeFloatLE(value, at(where, out.length - 3));
    return out;
  }),
);
const otherLength: fc.Arbitrary<Edit> = fc.oneof(
  fc.tuple(place, fc.uint8Array({ minLength: 1, maxLength: 12 })).map(([where, more]) => (bytes) => {
    const begin = at(where, bytes.length + 1);
    return Buffer.concat([bytes.subarray(0, begin), more, bytes.subarray(begin)]);
  }),
  place.map((where) => (bytes) => bytes.subarray(0, at(where, bytes.length + 1))),
);
const bytesEdit = fc.oneof({ weight: 5, arbitrary: sameLength }, { weight: 1, arbitrary: otherLength });

/** Cuts a stretch out, or writes it again, there or elsewhere, some times. */
const stretchEdit: fc.Arbitrary<Edit> = fc
  .tuple(place, fc.nat({ max: 400 }), place, times)
  .map(([where, length, to, often]) => (bytes) => {
    const begin = at(where, bytes.length + 1);
    const stretch = bytes.subarray(begin, begin + length);
    const rest = often === 0 ? Buffer.concat([bytes.subarray(0, begin), bytes.subarray(begin + length)]) : bytes;
    return repeated(rest, stretch, at(to, rest.length + 1), often);
  });

const repeated = (bytes: Buffer, stretch: Buffer, to: number, often: number): Buffer => {
  const room = Math.floor((kMaxBytes - bytes.length) / Math.max(1, stretch.length));
  const copies = new Array<Buffer>(Math.max(0, Math.min(often, room))).fill(stretch);
  return Buffer.concat([bytes.subarray(0, to), ...copies, bytes.subarray(to)]);
};

/** Does something with one of the parts of a text that a pattern finds. Bytes are its characters. */
const partOf =
  (pattern: RegExp, where: number, change: (part: string, parts: readonly string[]) => string): Edit =>
  (bytes) => {
    const text = bytes.toString('latin1');
    const parts = [...text.matchAll(pattern)];
    if (parts.length === 0) return bytes;
    const { 0: part, index } = parts[at(where, parts.length)]!;
    const changed = change(
      part,
      parts.map(([one]) => one),
    );
    return Buffer.from(text.slice(0, index) + changed + text.slice(index + part.length), 'latin1');
  };

const kNumber = /-?\d[\d.eE+-]*/g;
const kWord = /[A-Za-z_][\w:]*/g;
const kLine = /[^\n]+\n?/g;
const kBrace = /[{}[\]()"]/g;

const textEdit: fc.Arbitrary<Edit> = fc.oneof(
  { weight: 3, arbitrary: fc.tuple(place, numberText).map(([where, text]) => partOf(kNumber, where, () => text)) },
  { weight: 1, arbitrary: fc.tuple(place, objectWord).map(([where, text]) => partOf(kWord, where, () => text)) },
  // One word of the file in place of another.
  fc.tuple(place, place).map(([where, from]) => partOf(kWord, where, (_, words) => words[at(from, words.length)]!)),
  fc
    .tuple(place, fc.constantFrom('', '{', '}', '(', ')', '[', ']', '"', '@'))
    .map(([where, by]) => partOf(kBrace, where, () => by)),
  // Lines that are missing, or there many times.
  fc.tuple(place, times).map(([where, often]) =>
    partOf(kLine, where, (line, lines) => {
      const room = Math.floor((kMaxBytes - lines.join('').length) / line.length);
      return line.repeat(Math.max(0, Math.min(often, room)));
    }),
  ),
  fc
    .tuple(place, place)
    .map(([where, from]) => partOf(kLine, where, (line, lines) => line + lines[at(from, lines.length)]!)),
);

/** Edits of a text, or of a file in which places and lengths are written, so that most others break it at once. */
const editOf = (isText: boolean) =>
  fc.oneof(
    { weight: isText ? 6 : 1, arbitrary: textEdit },
    { weight: isText ? 2 : 8, arbitrary: bytesEdit },
    { weight: 1, arbitrary: stretchEdit },
  );

/** Other versions of a file. */
export const mutantsOf = (file: Buffer): fc.Arbitrary<Buffer> =>
  fc
    .array(editOf(!file.includes(0)), { minLength: 1, maxLength: 5 })
    .map((edits) => edits.reduce((bytes, change) => change(bytes), file));
