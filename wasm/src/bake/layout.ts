import { CagecastError, show } from '../core/error.js';
import { dot } from '../inspect/geometry.js';
import { fillGutter } from './gutter.js';
import { checkImage, checkNames, checkSize, colorByte, type Image, linearOf, wrongArgument } from './image.js';
import { kMaxLayers } from './pattern.js';
import { type Corners, type Kind, Raster, type Wrap } from './raster.js';

/** Triangles in two textures: the filled one, and the image that fills it. */
export interface Layout {
  /** What a report calls them. */
  name: string;
  /** 6 per triangle: the UVs of its corners in the texture that is filled. */
  to: Float32Array | Float64Array;
  /** 6 per triangle: those in the image; may be empty if nothing is painted. */
  from: Float32Array | Float64Array;
  /** 1 per triangle: 1 if it is painted; others only take their place. */
  painted: Uint8Array;
  /** 9 per triangle: the positions of its corners, for normal maps. */
  positions?: Float32Array | undefined;
}

/** Options of everything that fills a texture. */
export interface FillOptions {
  /** Width of the texture in texels, 1 to 8192. Default: 1024. */
  width?: number | undefined;
  /** Its height. Default: its width. */
  height?: number | undefined;
  /** What image and texture hold. Default: `color`, which is averaged in linear light. */
  kind?: Kind | undefined;
  /** Width of the gutter around charts, in texels, so that filtering and mipmaps mix no other colour in. Default: 1/64 of the longer side. */
  gutter?: number | undefined;
  /** How the texture goes on beyond its border, across and down. Default: `repeat`, as in glTF. */
  wrap?: Wrap | readonly [Wrap, Wrap] | undefined;
}

/** A filled texture. Where nothing lies it is transparent. The caller owns the arrays. */
export interface Baked extends Image {
  data: Uint8ClampedArray<ArrayBuffer>;
  kind: Kind;
  /** 1 per texel: 255 where it may be painted, without the gutter; less at borders. What is opaque here but not in `data` is where the image is transparent. */
  mask: Uint8Array<ArrayBuffer>;
  /** Where the UVs of the texture overlap, as those of mirrored halves do: the triangle that came first has the texels. */
  overlap: {
    /** Texels claimed twice, as a share of all that are covered. */
    texels: number;
    /** Share of the paint that found its texels taken. */
    lost: number;
    /** The names of the parts that share texels. */
    parts: string[];
  };
}

const kGutter = 1 / 64; // of the longer side
/** Texels beyond what is painted that a sample may reach. */
const kBorder = 2;
/** UVs beyond this are those of a pattern, too. */
const kFarthest = 32;
/** What an image may hold; the first is the default. */
export const kinds: readonly Kind[] = ['color', 'data', 'normal'];
const wraps: readonly Wrap[] = ['repeat', 'mirror', 'clamp'];

/** The options of a fill, complete. */
interface Fill {
  width: number;
  height: number;
  kind: Kind;
  gutter: number;
  wraps: readonly [Wrap, Wrap];
}

/** Checks the options of a fill. @throws {CagecastError} `badOption` or `badArgument`. */
export function checkFill(fn: string, options: FillOptions = {}): Fill {
  checkNames(fn, 'options', options, 'width, height, kind, gutter, wrap, parts');
  const wrong = (text: string) => new CagecastError('badOption', fn, `options.${text}`);
  const { kind = 'color', wrap = 'repeat' } = options;
  const width = checkSize(fn, 'options.width', options.width ?? 1024);
  const height = checkSize(fn, 'options.height', options.height ?? width);
  const gutter = options.gutter ?? Math.ceil(kGutter * Math.max(width, height));
  if (!Number.isInteger(gutter) || gutter < 0 || gutter > Math.max(width, height))
    throw wrong(`gutter is ${gutter}, not a whole number of texels from 0 to ${Math.max(width, height)}`);
  if (!kinds.includes(kind)) throw wrong(`kind is ${show(kind)}; there are: ${kinds.join(', ')}`);
  const both: readonly [Wrap, Wrap] = typeof wrap === 'string' ? [wrap, wrap] : wrap;
  if (!Array.isArray(both) || both.length !== 2 || !both.every((one) => wraps.includes(one)))
    throw wrong(`wrap is ${show(wrap)}; there are: ${wraps.join(', ')}, or one for each direction`);
  return { kind, width, height, gutter, wraps: both };
}

/**
 * Fills a texture by an image. Painted triangles come in the order of the layouts; those with the orientation of the texture
 * first, so that one of two mirrored halves is complete. Cost: as of `bakeTexture`.
 * @throws {CagecastError} `badArgument`
 */
export function fill(fn: string, layouts: readonly Layout[], image: Image, options?: FillOptions): Baked {
  const { width, height, gutter, kind, wraps } = checkFill(fn, options);
  checkImage(fn, 'image', image);
  const raster = new Raster({ width, height }, wraps, image, densityOf(layouts, width * height, image), kind);
  for (const way of [1, -1]) {
    layouts.forEach((layout, part) => {
      for (let t = 0; t < layout.painted.length; ++t) {
        const to = cornersOf(layout.to, t);
        if (Math.sign(areaOf(to)) !== way) continue;
        const isPainted = layout.painted[t] === 1;
        const from = cornersOf(layout.from, t);
        const turn =
          isPainted && kind === 'normal' ? turnOf(layout.positions!.subarray(9 * t, 9 * t + 9), from, to) : undefined;
        try {
          raster.draw(to, isPainted ? { corners: from, turn } : undefined, part);
        } catch (error) {
          throw error instanceof CagecastError
            ? new CagecastError('badArgument', fn, `triangle ${t} of "${layout.name}": ${error.reason}`, {
                at: t,
                cause: error,
              })
            : error;
        }
      }
    });
  }
  const { share, parts } = raster.claimedTwice();
  const mask = raster.finish(gutter);
  return {
    width,
    height,
    kind,
    data: bytesOf(raster.colors, kind, new Uint8ClampedArray(4 * width * height)),
    mask,
    overlap: { texels: share, lost: raster.lost, parts: parts.map((part) => layouts[part]!.name) },
  };
}

/**
 * The image of painted triangles without what lies around them: texels that are not painted, or not completely, have the colours of
 * painted ones beside them, so that samples at borders mix nothing else in. A pattern, which repeats, stays as it is.
 * Cost: a third of that of filling a texture of its size.
 * @param layouts  By their place in the texture that is filled: `to`.
 * @throws {CagecastError} `badArgument`
 */
export function paintedOnly(fn: string, layouts: readonly Layout[], image: Image, options?: FillOptions): Image {
  const { kind } = checkFill(fn, options);
  const { width, height } = checkImage(fn, 'image', image);
  let laid = 0;
  for (const { to } of layouts) {
    for (let at = 0; at < to.length; at += 6) laid += Math.abs(areaOf(to, at));
    if (laid > kMaxLayers || to.some((place) => Math.abs(place) > kFarthest)) return image;
  }
  const raster = new Raster({ width, height }, ['repeat', 'repeat'], image, 1, kind);
  // What is painted comes first: it may share its texels.
  for (const isPainted of [1, 0]) {
    for (const { to, painted } of layouts) {
      for (let t = 0; t < painted.length; ++t) {
        if (painted[t] === isPainted) raster.draw(cornersOf(to, t), isPainted ? {} : undefined, 0);
      }
    }
  }
  // Texels that are painted completely give their colours to those beside them, and stay as they are.
  const whole = raster.finish(0).map((share) => Number(share === 255));
  const data = new Uint8ClampedArray(image.data);
  const { colors, table } = raster;
  for (let texel = 0; texel < whole.length; ++texel) {
    if (whole[texel] === 0) continue;
    const at = 4 * texel;
    const alpha = data[at + 3]! / 255;
    for (let k = at; k < at + 3; ++k) colors[k] = alpha * table[data[k]!]!;
    colors[at + 3] = alpha;
  }
  const covered = whole.slice();
  fillGutter(raster, covered, kBorder);
  for (let texel = 0; texel < covered.length; ++texel) {
    if (whole[texel] === 1) colors[4 * texel + 3] = 0;
    else if (covered[texel] === 1) data[4 * texel + 3] = 0;
  }
  return { width, height, data: bytesOf(colors, kind, data) };
}

const cornersOf = (uvs: Layout['to'], triangle: number): Corners => uvs.subarray(6 * triangle, 6 * triangle + 6);

/** Signed area, as a share of the texture; negative if mirrored. */
export const areaOf = (uvs: Corners, at = 0): number =>
  0.5 *
  ((uvs[at + 2]! - uvs[at]!) * (uvs[at + 5]! - uvs[at + 1]!) -
    (uvs[at + 4]! - uvs[at]!) * (uvs[at + 3]! - uvs[at + 1]!));

/** Texels of the image per texel of the texture, in one direction. */
function densityOf(layouts: readonly Layout[], texels: number, image: Image): number {
  let [own, there] = [0, 0];
  for (const { to, from, painted } of layouts) {
    for (let t = 0; t < painted.length; ++t) {
      if (painted[t] !== 1) continue;
      own += Math.abs(areaOf(to, 6 * t)) * texels;
      there += Math.abs(areaOf(from, 6 * t)) * image.width * image.height;
    }
  }
  return own === 0 ? 1 : Math.sqrt(there / own);
}

type Vector = [number, number, number];
const sum = (s: number, a: Vector, t: number, b: Vector): Vector => [
  s * a[0] + t * b[0],
  s * a[1] + t * b[1],
  s * a[2] + t * b[2],
];

function unit(a: Vector): Vector {
  const length = Math.sqrt(dot(a, a));
  return length > 0 ? [a[0] / length, a[1] / length, a[2] / length] : [0, 0, 0];
}

/** The tangent and bitangent of a triangle: where u grows and, as glTF has it, where v falls. */
function frameOf(positions: Float32Array, uvs: Corners): [Vector, Vector] {
  const at = (corner: number) => [...positions.subarray(3 * corner, 3 * corner + 3)] as Vector;
  const [p, q] = [sum(1, at(1), -1, at(0)), sum(1, at(2), -1, at(0))];
  const [u1, v1, u2, v2] = [uvs[2]! - uvs[0]!, uvs[3]! - uvs[1]!, uvs[4]! - uvs[0]!, uvs[5]! - uvs[1]!];
  const sign = Math.sign(u1 * v2 - u2 * v1);
  const tangent = unit(sum(sign * v2, p, -sign * v1, q));
  const along = sum(sign * u2, p, -sign * u1, q);
  return [tangent, unit(sum(1, along, -dot(along, tangent), tangent))];
}

/** The matrix from the tangent space of one UV layout to that of another, on a triangle. */
function turnOf(positions: Float32Array, from: Corners, to: Corners): [number, number, number, number] {
  const [[t, b], [ownT, ownB]] = [frameOf(positions, from), frameOf(positions, to)];
  return [dot(t, ownT), dot(b, ownT), dot(t, ownB), dot(b, ownB)];
}

/** Writes colours as bytes, but for transparent ones. @returns `data`. */
function bytesOf(
  colors: Float32Array,
  kind: Kind,
  data: Uint8ClampedArray<ArrayBuffer>,
): Uint8ClampedArray<ArrayBuffer> {
  const toByte = kind === 'color' ? colorByte() : (share: number) => 255 * share;
  for (let at = 0; at < data.length; at += 4) {
    const alpha = colors[at + 3]!;
    if (alpha <= 0) continue;
    let [r, g, b] = [colors[at]! / alpha, colors[at + 1]! / alpha, colors[at + 2]! / alpha];
    if (kind === 'normal') [r, g, b] = unitColor(r, g, b);
    data[at] = toByte(r);
    data[at + 1] = toByte(g);
    data[at + 2] = toByte(b);
    data[at + 3] = 255 * alpha;
  }
  return data;
}

/** A normal of length 1 as a colour. */
function unitColor(r: number, g: number, b: number): Vector {
  const normal = unit([2 * r - 1, 2 * g - 1, 2 * b - 1]);
  return [(normal[0] + 1) / 2, (normal[1] + 1) / 2, (normal[2] + 1) / 2];
}

/**
 * Lays a baked texture over an image of the same size, by its alpha; colours are mixed in linear light. The alpha of the image is
 * kept, and so are all bytes where nothing was baked, unless there is a factor.
 * @param factor  By which colours of the image are multiplied first, in linear light, as by glTF's `baseColorFactor`. Default: 1.
 * @returns a new image.
 * @throws {CagecastError} `badArgument` if the sizes differ.
 */
export function layOver(image: Image, baked: Baked, factor: readonly [number, number, number] = [1, 1, 1]): Image {
  const base = checkImage('layOver', 'image', image);
  const { width, height, data: over, kind } = baked;
  if (base.width !== width || base.height !== height)
    throw wrongArgument(
      'layOver',
      'image',
      `has ${base.width} × ${base.height} texels, what was baked ${width} × ${height}`,
    );
  const data = new Uint8ClampedArray(base.data);
  const isPlain = factor.every((share) => share === 1);
  const toByte = colorByte();
  for (let at = 0; at < data.length; at += 4) {
    const alpha = over[at + 3]! / 255;
    if (alpha === 0 && isPlain) continue;
    if (kind === 'color') {
      for (let k = at; k < at + 3; ++k)
        data[k] = toByte(alpha * linearOf[over[k]!]! + (1 - alpha) * factor[k - at]! * linearOf[data[k]!]!);
      continue;
    }
    const mixed = [0, 1, 2].map(
      (k) => (alpha * over[at + k]! + (1 - alpha) * factor[k]! * data[at + k]!) / 255,
    ) as Vector;
    const [r, g, b] = kind === 'normal' ? unitColor(...mixed) : mixed;
    data[at] = 255 * r;
    data[at + 1] = 255 * g;
    data[at + 2] = 255 * b;
  }
  return { width, height, data };
}
