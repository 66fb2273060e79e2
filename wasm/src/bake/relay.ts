import { type Mesh, type TransferOptions, type TransferResult, transfer } from '../api/index.js';
import { CagecastError } from '../core/error.js';
import { boxOf } from '../inspect/geometry.js';
import { cornersOf, nearestFirst } from './bake.js';
import { checkImage, checkNames, type Image } from './image.js';
import { type Baked, type FillOptions, fill } from './layout.js';

/** Options of `relayPaint`. */
export interface RelayOptions extends Omit<FillOptions, 'wrap'> {
  /** Width of the result in texels, 1 to 8192. Default: that of the image. */
  width?: number | undefined;
  /** Its height. Default: that of the image, or the width if one is given. */
  height?: number | undefined;
  /** Of the two transfers that carry the paint. Default: those of `transfer`. */
  transfer?: TransferOptions | undefined;
}

/** One model with two cages. */
export interface Relay {
  model: Pick<Mesh, 'indices' | 'positions'>;
  /** The transfer from the cage that the image was drawn for. */
  from: TransferResult;
  /** That from the other cage. */
  to: TransferResult;
  /** How far paint goes on over holes of the first cage, in the unit of the model. */
  reach: number;
}

/** How far paint goes on over holes of its cage, as a share of the diagonal of cage or model, the smaller: half an eye, on a head. */
const kReach = 0.05;

/**
 * Carries a paint from one cage to another on the same model: `to` with the result paints the model as `from` with the image does.
 *
 * It goes by the model. Each of its triangles has a place in both layouts; the one in `to` shows what the one in `from` has. Where
 * several share a place in `to`, the one nearest to `to` is seen. Where `to` goes on and `from` has a hole or ends, the nearest paint
 * goes on, as far as 5 % of the diagonal of `from` or the model; what else `from` does not paint, such as eyes, stays transparent.
 *
 * Needs `init`. Cost: of two transfers, and as of `bakeTexture`: about a second for 1024². Memory: 32 bytes a texel.
 *
 * @param image  In the UVs of `from`; it repeats.
 * @param from   The cage that the image was drawn for.
 * @param to     Another cage, around the same model; its UVs should be within 0..1.
 * @throws {CagecastError} `badArgument` for an image that is none, and if nothing of the model is painted by both cages; else as
 * `transfer` and `bakeTexture`.
 *
 * @example
 * const fitted = (await fitCage(await loadTemplate('human-head'), head)).cage;
 * const forTemplate = relayPaint(paint, ownCage, fitted, head); // paints every model that the template is fitted to
 */
export function relayPaint(image: Image, from: Mesh, to: Mesh, model: Mesh, options: RelayOptions = {}): Baked {
  checkNames('relayPaint', 'options', options, 'width, height, kind, gutter, transfer');
  checkImage('relayPaint', 'image', image);
  const { transfer: rules, ...rest } = options;
  const results = { from: transferFrom('from', from, model, rules), to: transferFrom('to', to, model, rules) };
  return relay('relayPaint', image, { model, ...results, reach: reachOf(from, model) }, rest);
}

/** How far paint goes on over the holes of a cage on a model, in their unit. */
export const reachOf = (cage: Mesh, model: Mesh): number =>
  kReach * Math.min(boxOf(cage.positions).diagonal, boxOf(model.positions).diagonal);

/**
 * The same by the results of transfers, which have to be of one model.
 * @throws {CagecastError} as `relayPaint`.
 */
export function relay(
  fn: string,
  image: Image,
  { model, from, to, reach }: Relay,
  options: Omit<RelayOptions, 'transfer'>,
): Baked {
  const { indices, positions } = model;
  const isPainted = (t: number) => from.cosmeticTriangles[t] === 1;
  const goesOn = (t: number) =>
    !from.segmentStats[from.segments[indices[3 * t]!]!]!.culled &&
    [0, 1, 2].every((k) => from.distances[indices[3 * t + k]!]! <= reach);
  const order = [...to.cosmeticTriangles.keys()].filter((t) => to.cosmeticTriangles[t] === 1);
  if (!order.some(isPainted))
    throw new CagecastError('badArgument', fn, nothingShared(from, to), { argument: 'model' });
  // The first to take a place has it.
  nearestFirst(order, model, to.distances, { firstTriangle: 0 }).sort(
    (a, b) => Number(isPainted(b)) - Number(isPainted(a)),
  );
  const corners = Uint32Array.from({ length: 3 * order.length }, (_, i) => 3 * order[Math.floor(i / 3)]! + (i % 3));
  const uvsOf = ({ uvs, cornerUvs }: TransferResult) =>
    cornersOf(cornerUvs.length > 0 ? cornerUvs : cornersOf(uvs, indices, 2), corners, 2);
  const layout = {
    name: 'model',
    to: uvsOf(to),
    from: uvsOf(from),
    painted: Uint8Array.from(order, (t) => Number(isPainted(t) || goesOn(t))),
    positions: options.kind === 'normal' ? cornersOf(cornersOf(positions, indices, 3), corners, 3) : undefined,
  };
  const { width = image.width, height = options.width ?? image.height } = options;
  return fill(fn, [layout], image, { ...options, width, height });
}

/** Why there is nothing to carry over. */
function nothingShared(from: TransferResult, to: TransferResult): string {
  const [own, other] = [from, to].map(({ cosmeticTriangles }) => cosmeticTriangles.filter((one) => one === 1).length);
  return `model has no triangle that both cages paint: of its ${from.cosmeticTriangles.length}, from paints ${own}, to paints ${other}; inspect says why, fitCage or makeCage gives it another cage`;
}

/** A transfer whose errors name the arguments of `relayPaint`. */
function transferFrom(name: 'from' | 'to', cage: Mesh, model: Mesh, options: TransferOptions | undefined) {
  try {
    return transfer(cage, model, options);
  } catch (error) {
    if (!(error instanceof CagecastError)) throw error;
    const names: Record<string, string> = { cage: name, target: 'model', options: 'options.transfer' };
    const { code, reason, argument, at } = error;
    const renamed = reason.replace(/^(cage|target|options)\b/, (word) => names[word]!);
    const blamed = argument === 'options' ? argument : names[argument ?? ''];
    throw new CagecastError(code, 'relayPaint', renamed, { argument: blamed, at, cause: error });
  }
}
