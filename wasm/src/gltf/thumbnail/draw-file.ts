import type { Mesh } from '../../api/index.js';
import { partsNamed } from '../../api/parts.js';
import { CagecastError } from '../../core/error.js';
import { type Drawn, extract, extractDrawn, namedParts, type WhichCount } from '../../scene/extract.js';
import { InputError, naming } from '../../scene/input-error.js';
import { hostDecode } from '../host-decode.js';
import { type GltfFile, openGltf } from '../open-gltf.js';
import { drawSurfaces } from './draw.js';
import { framed, headPoints, pointsOf } from './frame.js';
import { kSize, type Thumbnail, type ThumbnailOptions } from './options.js';
import { Picture } from './picture.js';
import { type Surface, surfacesOf } from './surfaces.js';
import { type Angles, viewAt, views } from './views.js';

/** Samples along each side of a pixel. */
const kSamples = 2;

/**
 * Draws a file.
 * @param options     Checked.
 * @param whichCount  Default: what is drawn.
 * @throws {InputError} that names the file; {CagecastError} `unsupported`
 */
export async function drawFile(
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
  naming(file.path, () => drawSurfaces(picture, view, surfaces));
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
  { view, frame: patterns, cage }: ThumbnailOptions,
): Promise<[Thumbnail['framed'], ArrayLike<number>]> {
  if (patterns) {
    // Overlays are named as what they lie on.
    const own = drawn.parts.filter((part) => !drawn.overlays.has(part));
    const fail = (text: string) => new InputError(`frame: ${text}`);
    const named = patterns.flatMap((pattern) => partsNamed(pattern, namedParts(file, own), fail));
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
