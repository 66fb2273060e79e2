import { type Blend, blendModes, type Edits, type Layer, type LayerStack, type Style } from '#three';
import type { Opener } from '../loading/opener';
import { paintName } from '../loading/samples';
import { pngOf } from '../platform/png';
import { type Paint, titleOf } from '../state/paint';
import { kChecker } from '../state/sample';
import type { Session } from '../state/session';
import type { LinkedLayer } from './link';
import type { LinkedLayers } from './links';
import { Strokes } from './strokes';

/**
 * The paint to export: the layers for links, and a PNG.
 * @param strokes Writes what was painted.
 * @param png     Encodes the composite of the layers; by default, without WebGL, the uppermost visible paint.
 */
export function exportedPaint(
  session: Session,
  stack: LayerStack,
  edits: Edits,
  { opener, strokes }: { opener: Opener; strokes: Strokes },
  png = () => latestPng(stack),
): { png(): Promise<Blob>; layers: LinkedLayers } {
  /** The name of a layer's paint in links; undefined for the user's own. */
  const nameOf = ({ sheet }: Layer): string | undefined => {
    if (sheet === session.checker) return kChecker;
    const name = (sheet as Paint).drawn ?? paintName(sheet.picture ?? '');
    return opener.has(name) ? name : (sheet as Paint).linked;
  };
  const textOf = (layer: Layer): string | undefined => nameOf(layer) ?? strokes.write(layer);
  let requests = 0;
  return {
    png,
    layers: {
      get layers() {
        return stack.layers.flatMap((layer) => {
          const paint = textOf(layer);
          const { opacity, tint, blend, visible } = layer;
          return paint ? [{ paint, opacity, tint, blend, visible }] : [];
        });
      },
      get omitted() {
        return stack.layers.flatMap((layer) => (textOf(layer) ? [] : layer.name));
      },
      restore(layers) {
        const before = session.shown?.target;
        const request = ++requests;
        const end = session.on('progress', async ({ state }) => {
          if (state === 'working') return;
          end();
          // The sample failed or was cancelled, or another link was followed.
          const target = session.shown?.target;
          if (state !== 'ready' || target === before || request !== requests) return;
          const known = layers.filter(({ paint }) => opener.has(paint) || Strokes.has(paint));
          // The lowest is the paint the sample opened with, unless that layer was removed.
          const isBase = stack.base !== undefined && nameOf(stack.base) === known[0]?.paint;
          const rest = isBase ? known.slice(1) : known;
          let paints: (Paint | undefined)[];
          try {
            paints = await readPaints(rest, layers, opener);
          } catch (error) {
            return session.fail(error);
          }
          // Another sample or link may have been opened meanwhile. The rest is synchronous.
          if (session.shown?.target !== target || request !== requests) return;
          // Keep the user's own layers.
          for (const layer of stack.layers) if (layer !== stack.base && nameOf(layer)) stack.remove(layer.id);
          const { base } = stack;
          if (base && isBase) stack.restyle(base, styleOf(known[0]!));
          else if (base && known.length === layers.length) stack.remove(base.id);
          rest.forEach((layer, i) => {
            const paint = paints[i];
            if (paint && !stack.full) stack.add(titleOf(paint), paint, styleOf(layer));
          });
          // Earlier undo steps do not apply any more.
          edits.forget();
        });
      },
    },
  };
}

/**
 * The paints of layers in a link, read one after the other; those that are damaged are left out.
 * @param all  All layers of the link. @throws Error that names the layer, if its strokes have a size that this page does not write: nothing is decoded then.
 */
async function readPaints(
  layers: readonly LinkedLayer[],
  all: readonly LinkedLayer[],
  opener: Opener,
): Promise<(Paint | undefined)[]> {
  const strokes = new Map<LinkedLayer, File | undefined>();
  for (const layer of layers)
    if (Strokes.has(layer.paint))
      strokes.set(
        layer,
        await Strokes.check(layer.paint).catch((error: Error) => {
          throw new Error(
            `The layers of the link are left out. Of number ${all.indexOf(layer) + 1}, ${error.message}.`,
          );
        }),
      );
  const paints: (Paint | undefined)[] = [];
  for (const layer of layers) {
    const file = strokes.get(layer);
    if (!strokes.has(layer)) paints.push(await opener.paint(layer.paint));
    else paints.push(file && (await Strokes.read(layer.paint, file).catch(() => undefined)));
  }
  return paints;
}

function styleOf({ opacity, tint, blend, visible }: LinkedLayer): Partial<Style> {
  return { opacity, tint, blend: blendModes.includes(blend as Blend) ? (blend as Blend) : 'normal', visible };
}

function latestPng({ layers }: LayerStack): Promise<Blob> {
  const layer = layers.findLast(({ visible }) => visible);
  if (!layer) throw new Error('There is no visible paint.');
  return pngOf(layer.sheet.texture.image as ImageBitmap | HTMLCanvasElement);
}
