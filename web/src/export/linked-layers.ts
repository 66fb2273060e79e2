import { type Blend, blendModes, type Edits, type Layer, type LayerStack, type Style } from '#three';
import type { Opener } from '../loading/opener';
import { paintName } from '../loading/samples';
import { ask } from '../platform/ask';
import { pngOf } from '../platform/png';
import { type Paint, titleOf } from '../state/paint';
import { kChecker } from '../state/sample';
import type { Session } from '../state/session';
import type { LinkedLayer } from './link';
import { kDamagedLink, type LinkedLayers } from './links';
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
  /** The name of a layer's paint in links, or its strokes; undefined for the user's own. */
  const nameOf = ({ sheet }: Layer): string | undefined => {
    if (sheet === session.checker) return kChecker;
    const name = (sheet as Paint).drawn ?? paintName(sheet.picture ?? '');
    return opener.has(name) ? name : (sheet as Paint).linked;
  };
  let requests = 0;
  return {
    png,
    layers: {
      async write() {
        const { layers } = stack;
        const texts = await strokes.write(layers);
        // Strokes of a link may not fit into this one.
        const paintOf = (layer: Layer) =>
          texts.get(layer) ?? ((layer.sheet as Paint).linked ? undefined : nameOf(layer));
        const known = layers.map((layer) => ({ layer, paint: paintOf(layer) }));
        return {
          layers: known.flatMap(({ layer: { opacity, tint, blend, visible }, paint }) =>
            paint ? [{ paint, opacity, tint, blend, visible }] : [],
          ),
          omitted: known.flatMap(({ layer, paint }) => (paint ? [] : layer.name)),
        };
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
          const paints: (Paint | undefined)[] = [];
          try {
            for (const { paint } of rest)
              paints.push(await (Strokes.has(paint) ? Strokes.read(paint) : opener.paint(paint)));
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
          if (known.length < layers.length || paints.includes(undefined)) ask(kDamagedLink);
          // Earlier undo steps do not apply any more.
          edits.forget();
        });
      },
    },
  };
}

function styleOf({ opacity, tint, blend, visible }: LinkedLayer): Partial<Style> {
  return { opacity, tint, blend: blendModes.includes(blend as Blend) ? (blend as Blend) : 'normal', visible };
}

function latestPng({ layers }: LayerStack): Promise<Blob> {
  const layer = layers.findLast(({ visible }) => visible);
  if (!layer) throw new Error('There is no visible paint.');
  return pngOf(layer.sheet.texture.image as ImageBitmap | HTMLCanvasElement);
}
