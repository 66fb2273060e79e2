import { faultOfNames } from '../../api/option-names.js';
import type { Image } from '../../bake/image.js';
import { show } from '../../core/error.js';
import { type Drawn, extract, extractDrawn, type WhichCount } from '../../gltf/extract-file.js';
import { InputError } from '../../gltf/input-error.js';
import { type GltfFile, openGltf } from '../../gltf/open-gltf.js';
import { CagecastError, type Code, type Mesh } from '../../index.js';
import { partsOf } from '../locks.js';
import { hostDecode } from './decode.js';
import { drawSurfaces } from './draw.js';
import { framed, headPoints, pointsOf } from './frame.js';
import { Picture } from './picture.js';
import { type Surface, surfacesOf } from './surfaces.js';
import { type Angles, type ViewName, viewAt, views } from './views.js';

/** Options of `thumbnail`. */
export interface ThumbnailOptions {
  /** Pixels along each side; 16 to 2048. Default: 256. */
  size?: number | undefined;
  /**
   * From where the model is seen: `front`, `back`, its own `left` and `right`, `top`, `bottom`; `face`, its head from the front, or all of it
   * if no joint is called a head; or an azimuth and an elevation. Default: `front`, which is +z, and −z of a VRM 0.
   */
  view?: ViewName | Angles | undefined;
  /** Patterns for names of nodes, meshes and materials: what is to fill the picture, in which `*` stands for any text. Default: all that is drawn. */
  parts?: readonly string[] | undefined;
  /** What is to fill the picture, by a cage around it: the bytes of a GLB, or a mesh, in the space of the model's scene. */
  cage?: Uint8Array | Pick<Mesh, 'positions'> | undefined;
  /** The colour behind the model: `#rrggbb`, or `#rrggbbaa`. Default: transparent. */
  background?: string | undefined;
  /**
   * Decodes an image of the model: RGBA, not premultiplied. Default: `createImageBitmap` and `OffscreenCanvas`; Node has neither, and takes
   * what sharp makes, as in the example.
   */
  decode?: ((bytes: Uint8Array, mimeType: string) => Image | Promise<Image>) | undefined;
}

const kOptions = ['size', 'view', 'parts', 'cage', 'background', 'decode'];
/** Pixels along each side: by default, at least, at most. */
export const [kSize, kSmallest, kLargest] = [256, 16, 2048];
/** Samples along each side of a pixel. */
const kSamples = 2;

/** What `thumbnail` made. */
export interface Thumbnail {
  /** Pixels, both the same. */
  width: number;
  height: number;
  /** RGBA, 4 bytes per pixel, not premultiplied, from the top left, as `ImageData` and sharp take it. */
  data: Uint8ClampedArray<ArrayBuffer>;
  /** What fills the picture: `face` only if a head was found. */
  framed: 'model' | 'face' | 'parts' | 'cage';
  /** The textures that are not shown, each with the reason: `"skin: is a KTX2 image"`. Their materials have their plain colours. */
  undecoded: string[];
}

/**
 * Draws a model, painted or not: the bytes of a GLB or VRM in, a picture out. Without a GPU, a page or three.js, so it runs in Node, workers
 * and edge functions, too.
 *
 * Shown: base colours with their textures, vertex colours, alpha modes, overlays of paint, in a light at the eye. Skins are in their bind pose;
 * nodes that are hidden, cages and markers are left out. Not shown: other maps, reflections and glow.
 *
 * A texture that cannot be decoded is no error: the picture is made, and `undecoded` names it.
 * Cost: some 200 ms for an avatar of 19,000 triangles at 256 pixels, besides decoding its images; memory of 32 bytes for each pixel.
 * @throws {CagecastError} `badArgument`, `badOption`; `unsupported` if textures are to be decoded and neither the host nor `decode` can.
 *
 * @example
 * import { thumbnail } from 'cagecast/glb';
 *
 * const decode = async (bytes) => {
 *   const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
 *   return { width: info.width, height: info.height, data };
 * };
 * const { width, height, data } = await thumbnail(await readFile('painted.vrm'), { view: 'face', decode });
 * await sharp(data, { raw: { width, height, channels: 4 } }).webp().toFile('painted.webp');
 */
export async function thumbnail(bytes: Uint8Array, options: ThumbnailOptions = {}): Promise<Thumbnail> {
  if (!(bytes instanceof Uint8Array)) throw wrong('bytes', bytes, 'a Uint8Array');
  checkOptions(options);
  try {
    return await thumbnailOf(await openGltf('bytes', bytes), options);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    throw new CagecastError('badArgument', 'thumbnail', error.message, {
      argument: error.message.split(/\W/, 1)[0],
      cause: error,
    });
  }
}

/**
 * Draws a file.
 * @param options     Checked.
 * @param whichCount  Default: what is drawn.
 * @throws {InputError} that names the file; {CagecastError} `unsupported`
 */
export async function thumbnailOf(
  file: GltfFile,
  options: ThumbnailOptions,
  whichCount?: Exclude<WhichCount, 'cage'>,
): Promise<Thumbnail> {
  const { size = kSize, view: from = 'front', background, decode } = options;
  const drawn = extractDrawn(file, whichCount);
  if (drawn.parts.length === 0)
    throw new InputError('has no triangles in its scene; at least one is needed').in(file.path);
  const undecoded: string[] = [];
  const read = decode ?? hostDecode() ?? refuseImages;
  const surfaces = await surfacesOf(file, drawn.parts, async (...image) => read(...image), undecoded);
  const view = viewAt(turnedTo(file, typeof from === 'string' ? views[from] : from));
  const [what, points] = await toFill({ file, drawn, surfaces }, options);
  const picture = new Picture({
    size,
    view,
    ...framed(points, view),
    samples: kSamples,
    background: background === undefined ? undefined : colorOf(background),
  });
  drawSurfaces(picture, view, surfaces);
  return { ...picture.image(), framed: what, undecoded };
}

/** A model that is drawn: its file, its parts, and the surface of each. */
interface Model {
  file: GltfFile;
  drawn: Drawn;
  surfaces: readonly Surface[];
}

/** What fills the picture, and its points, 3 numbers each. @throws {InputError} */
async function toFill(
  { file, drawn, surfaces }: Model,
  { view, parts: patterns, cage }: ThumbnailOptions,
): Promise<[Thumbnail['framed'], ArrayLike<number>]> {
  if (patterns) {
    // Overlays are named as what they lie on.
    const own = drawn.parts.filter((part) => !drawn.overlays.has(part));
    const named = patterns.flatMap((pattern) => partsOf({ file, extracted: { parts: own } }, 'parts', pattern));
    return ['parts', pointsOf(named.map((p) => surfaces[drawn.parts.indexOf(own[p]!)]!))];
  }
  if (cage) return ['cage', (await cagePoints(cage)).map((x, i) => x - drawn.origin[i % 3]!)];
  const head = view === 'face' ? headPoints(file, drawn, surfaces) : undefined;
  return head ? ['face', head] : ['model', pointsOf(surfaces)];
}

/** A direction to a model as its own: one of VRM 0 looks the other way. */
function turnedTo({ json: { extensions } }: GltfFile, { azimuth = 0, elevation }: Angles): Angles {
  const looksBack = extensions?.['VRM'] !== undefined && extensions['VRMC_vrm'] === undefined;
  return { azimuth: azimuth + (looksBack ? 180 : 0), elevation };
}

/** The points of a cage. @throws {InputError} */
async function cagePoints(cage: Uint8Array | Pick<Mesh, 'positions'>): Promise<Float32Array> {
  if (!(cage instanceof Uint8Array)) return cage.positions;
  const { positions } = extract(await openGltf('cage', cage), undefined, 'cage').mesh;
  if (positions.length === 0) throw new InputError('cage: has no triangles in its scene; at least one is needed');
  return positions;
}

const kHex = /^#(?:[\da-f]{6}|[\da-f]{8})$/i;

/** Whether a text is a colour as `background` takes it. */
export const isColor = (text: unknown): text is string => typeof text === 'string' && kHex.test(text);

const colorOf = (text: string): number[] =>
  [1, 3, 5, 7].map((at) => (at < text.length ? Number.parseInt(text.slice(at, at + 2), 16) : 255));

const refuseImages = (): never => {
  throw new CagecastError(
    'unsupported',
    'thumbnail',
    'this host does not decode images; give options.decode, by sharp for example: async (bytes) => { const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true }); return { width: info.width, height: info.height, data }; }',
    { argument: 'decode' },
  );
};

/** @throws {CagecastError} */
function checkOptions(options: ThumbnailOptions): void {
  const fault = faultOfNames('thumbnail', 'options', options, kOptions);
  if (fault !== undefined) throw new CagecastError('badOption', 'thumbnail', fault);
  const { size, view, parts, cage, background, decode } = options;
  const check = (name: string, value: unknown, isRight: boolean, type: string) => {
    if (value !== undefined && !isRight) throw wrong(`options.${name}`, value, type, 'badOption');
  };
  check(
    'size',
    size,
    Number.isInteger(size) && size! >= kSmallest && size! <= kLargest,
    `a whole number from ${kSmallest} to ${kLargest}`,
  );
  const isAngle = (angle: unknown) => angle === undefined || Number.isFinite(angle);
  if (typeof view === 'object' && view !== null) {
    check('view.azimuth', view.azimuth, isAngle(view.azimuth), 'a finite number');
    check(
      'view.elevation',
      view.elevation,
      isAngle(view.elevation) && Math.abs(view.elevation!) <= 90,
      'a number from -90 to 90',
    );
  } else
    check(
      'view',
      view,
      typeof view === 'string' && Object.hasOwn(views, view),
      `${Object.keys(views).join(', ')} or { azimuth, elevation }`,
    );
  check('parts', parts, Array.isArray(parts) && parts.length > 0, 'an array of patterns');
  check(
    'cage',
    cage,
    cage instanceof Uint8Array || (cage?.positions instanceof Float32Array && cage.positions.length > 0),
    'the bytes of a GLB, or a mesh',
  );
  if (parts && cage)
    throw new CagecastError(
      'badOption',
      'thumbnail',
      'options.parts and options.cage are both given; one of them says what fills the picture',
    );
  check('background', background, isColor(background), 'a colour such as "#ffffff"');
  check('decode', decode, typeof decode === 'function', 'a function');
}

const wrong = (name: string, value: unknown, type: string, code: Code = 'badArgument') =>
  new CagecastError(code, 'thumbnail', `${name} is ${show(value)}, not ${type}`, { argument: name.split('.')[0] });
