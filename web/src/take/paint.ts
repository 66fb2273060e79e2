import { kBlends, type Blend, type Layer, type Style } from '../layers/layer'
import type { LayerStack } from '../layers/stack'
import type { Opener } from '../open'
import { titleOf } from '../paint'
import { kChecker, paintName } from '../samples'
import type { Session } from '../session'
import type { LinkedLayer } from './link'
import type { Paints } from './take'

/**
 * The layers, to be taken away.
 * @param png Makes a PNG of what they look like together; without it, where nothing can be drawn, the latest paint is taken.
 */
export function paintOf(session: Session, stack: LayerStack, opener: Opener, png = () => latestPng(session)): Paints {
  /** What a link calls what is in a layer; nothing if it is the visitor's own. */
  const nameOf = ({ sheet }: Layer): string | undefined => {
    if (sheet === session.checker) return kChecker
    return opener.samples.some(({ paints }) => paints.some(({ file }) => file === sheet.picture)) ? paintName(sheet.picture) : undefined
  }
  return {
    png,
    linked: {
      get layers() {
        return stack.layers.flatMap((layer) => {
          const paint = nameOf(layer)
          const { opacity, tint, blend, visible } = layer
          return paint ? [{ paint, opacity, tint, blend, visible }] : []
        })
      },
      get left() {
        return stack.layers.filter((layer) => !nameOf(layer)).length
      },
      restore(layers) {
        const end = session.on('progress', async ({ state }) => {
          if (state !== 'ready') return
          end()
          // The visitor's own stay: no link may cost anyone their work.
          for (const layer of stack.layers) if (layer !== stack.base && nameOf(layer)) stack.remove(layer.id)
          const [base, ...others] = layers
          if (base && stack.base && nameOf(stack.base) === base.paint) stack.restyle(stack.base, styleOf(base))
          for (const layer of others) {
            const paint = await opener.paint(layer.paint)
            if (paint && !stack.full) stack.add(titleOf(paint), paint, styleOf(layer))
          }
        })
      },
    },
  }
}

function styleOf({ opacity, tint, blend, visible }: LinkedLayer): Style {
  return { opacity, tint, blend: kBlends.includes(blend as Blend) ? (blend as Blend) : 'normal', visible }
}

function latestPng({ shown }: Session): Promise<Blob> {
  const image = shown!.paint.texture.image as ImageBitmap | HTMLCanvasElement
  const canvas = new OffscreenCanvas(image.width, image.height)
  canvas.getContext('2d')!.drawImage(image, 0, 0)
  return canvas.convertToBlob({ type: 'image/png' })
}
