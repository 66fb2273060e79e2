/** The options of a texture in an MTL, and how many words each takes at most. Vectors may be shorter. */
const kOptions = new Map<string | undefined, number>([
  ...['-blendu', '-blendv', '-boost', '-bm', '-cc', '-clamp', '-imfchan', '-texres', '-type'].map(
    (name) => [name, 1] as const,
  ),
  ['-mm', 2],
  ...['-o', '-s', '-t'].map((name) => [name, 3] as const),
]);
/** What three's loader reads, and what a shorter vector is filled up with; it takes others for a part of the name. */
const kKept = new Map([
  ['-bm', '1'],
  ['-mm', '0'],
  ['-o', '0'],
  ['-s', '1'],
]);
const kVector = 3;

const isNumber = (word: string | undefined): boolean =>
  word !== undefined && word !== '' && Number.isFinite(Number(word));

/** The value of a texture as three's loader expects it: of its options those that it reads, whole, and the name without quotes. */
function plainTexture(value: string): string {
  const words = value.split(/\s+/);
  const options: string[] = [];
  let at = 0;
  const most = () => kOptions.get(words[at]?.toLowerCase());
  for (let length = most(); length !== undefined; length = most()) {
    const name = words[at++]!.toLowerCase();
    const values = words.slice(at, at + length);
    const count = length === kVector ? values.findIndex((word) => !isNumber(word)) : -1;
    const own = count < 0 ? values : values.slice(0, count);
    at += own.length;
    const filler = kKept.get(name);
    if (filler === undefined) continue;
    options.push(name, ...own, ...new Array<string>(Math.max(0, length - own.length)).fill(filler));
  }
  const file = words
    .slice(at)
    .join(' ')
    .replace(/^"(.*)"$/, '$1');
  return [...options, file].join(' ');
}

/**
 * An MTL as three's loader reads it: words are parted by one space, options of textures are whole, and of two values for how opaque a
 * material is there is the one that says it straight (d): some programs write both as 1.
 */
export const plainMaterials = (text: string): string =>
  text
    .split(/^(?=[ \t]*newmtl\b)/im)
    .map((material) => {
      const lines = material.split('\n').map((line) => /^\s*(\S+)\s+(\S.*)$/.exec(line.trimEnd())?.slice(1) ?? [line]);
      const saysOpacity = lines.some(([key]) => key!.toLowerCase() === 'd');
      return lines
        .filter(([key]) => !(saysOpacity && key!.toLowerCase() === 'tr'))
        .map(([key, value]) => {
          if (value === undefined) return key!;
          return `${key} ${/^(map_|bump|disp|norm|refl)/i.test(key!) ? plainTexture(value) : value}`;
        })
        .join('\n');
    })
    .join('');
