/** Maps the coordinate of a texel that may lie outside of the texture into it; −1 for none. */
export type Wrapping = (coordinate: number) => number;

/** A texture that is being filled. */
interface Texture {
  width: number;
  height: number;
  columnOf: Wrapping;
  rowOf: Wrapping;
  /** 4 per texel. */
  colors: Float32Array;
}

/**
 * Fills a gutter around what is covered, ring by ring: each texel is the mean of its neighbours in the rings before, so that
 * filtering and mipmaps mix no other colour in.
 * @param covered  1 per texel: 0 if nothing lies there; not 0 for the gutter, afterwards.
 * @param rings    The width of the gutter in texels.
 */
export function fillGutter(texture: Texture, covered: Uint8Array, rings: number): void {
  const { colors } = texture;
  const near = new Int32Array(8);
  const found = new Uint8Array(covered.length);
  let ring = new Int32Array(covered.length);
  let count = 0;
  /** Notes the empty neighbours of a texel. */
  const look = (texel: number, into: Int32Array, at: number): number => {
    let end = at;
    const neighbours = neighboursOf(texture, texel, near);
    for (let i = 0; i < neighbours; ++i) {
      const other = near[i]!;
      if (covered[other] !== 0 || found[other] === 1) continue;
      found[other] = 1;
      into[end++] = other;
    }
    return end;
  };
  if (rings > 0)
    for (let texel = 0; texel < covered.length; ++texel) if (covered[texel] !== 0) count = look(texel, ring, count);
  let next = new Int32Array(covered.length);
  for (let step = 0; step < rings && count > 0; ++step) {
    for (let i = 0; i < count; ++i) {
      const neighbours = neighboursOf(texture, ring[i]!, near);
      let [red, green, blue, alpha, inner] = [0, 0, 0, 0, 0];
      for (let n = 0; n < neighbours; ++n) {
        if (covered[near[n]!] === 0) continue;
        const at = 4 * near[n]!;
        red += colors[at]!;
        green += colors[at + 1]!;
        blue += colors[at + 2]!;
        alpha += colors[at + 3]!;
        ++inner;
      }
      const to = 4 * ring[i]!;
      colors[to] = red / inner;
      colors[to + 1] = green / inner;
      colors[to + 2] = blue / inner;
      colors[to + 3] = alpha / inner;
    }
    for (let i = 0; i < count; ++i) covered[ring[i]!] = 1;
    let end = 0;
    if (step + 1 < rings) for (let i = 0; i < count; ++i) end = look(ring[i]!, next, end);
    [ring, next, count] = [next, ring, end];
  }
}

/** The texels around one, of which there are at most eight. @returns how many. */
function neighboursOf({ width, height, columnOf, rowOf }: Texture, texel: number, out: Int32Array): number {
  const x = texel % width;
  const y = (texel - x) / width;
  let count = 0;
  const isInner = x > 0 && x < width - 1 && y > 0 && y < height - 1;
  for (let down = -1; down <= 1; ++down) {
    for (let right = -1; right <= 1; ++right) {
      if (down === 0 && right === 0) continue;
      if (isInner) {
        out[count++] = texel + down * width + right;
        continue;
      }
      const [column, row] = [columnOf(x + right), rowOf(y + down)];
      if (column >= 0 && row >= 0) out[count++] = row * width + column;
    }
  }
  return count;
}
