import { faultOfNames } from '../../api/option-names.js';
import { CagecastError, type Code, show } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { InputError } from '../../scene/input-error.js';
import { openGltf } from '../open-gltf.js';
import { drawFile } from './draw-file.js';
import { isColor, kLargest, kSmallest, type Thumbnail, type ThumbnailOptions } from './options.js';
import { views } from './views.js';

const kOptions = ['size', 'view', 'frame', 'cage', 'background', 'decode'];

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
 * import { thumbnail } from 'cagecast/gltf';
 *
 * const decode = async (bytes) => {
 *   const { data, info } = await sharp(bytes).ensureAlpha().raw().toBuffer({ resolveWithObject: true });
 *   return { width: info.width, height: info.height, data };
 * };
 * const { width, height, data } = await thumbnail(await readFile('painted.vrm'), { view: 'face', decode });
 * await sharp(data, { raw: { width, height, channels: 4 } }).webp().toFile('painted.webp');
 */
export async function thumbnail(bytes: Uint8Array, options: ThumbnailOptions = {}): Promise<Thumbnail> {
  const file = plainArray(bytes, 'Uint8Array');
  if (!file) throw wrong('bytes', bytes, 'a Uint8Array');
  checkOptions(options);
  try {
    return await drawFile(await openGltf('bytes', file), options);
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    throw new CagecastError('badArgument', 'thumbnail', error.message, {
      argument: error.message.split(/\W/, 1)[0],
      cause: error,
    });
  }
}

/** @throws {CagecastError} */
function checkOptions(options: ThumbnailOptions): void {
  const fault = faultOfNames('thumbnail', 'options', options, kOptions);
  if (fault !== undefined) throw new CagecastError('badOption', 'thumbnail', fault);
  const { size, view, frame, cage, background, decode } = options;
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
  check('frame', frame, Array.isArray(frame) && frame.length > 0, 'an array of patterns');
  check(
    'cage',
    cage,
    cage instanceof Uint8Array || (cage?.positions instanceof Float32Array && cage.positions.length > 0),
    'the bytes of a GLB, or a mesh',
  );
  if (frame && cage)
    throw new CagecastError(
      'badOption',
      'thumbnail',
      'options.frame and options.cage are both given; one of them says what fills the picture',
    );
  check('background', background, isColor(background), 'a colour such as "#ffffff"');
  check('decode', decode, typeof decode === 'function', 'a function');
}

const wrong = (name: string, value: unknown, type: string, code: Code = 'badArgument') =>
  new CagecastError(code, 'thumbnail', `${name} is ${show(value)}, not ${type}`, { argument: name.split('.')[0] });
