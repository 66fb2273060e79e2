import { kChecker, paintName } from '../samples'
import type { Session } from '../session'
import type { Paints } from './take'

/** The paint that is shown, to be taken away. */
export function paintOf(session: Session): Paints {
  return {
    async png() {
      const image = session.shown!.paint.texture.image as ImageBitmap | HTMLCanvasElement
      const canvas = new OffscreenCanvas(image.width, image.height)
      canvas.getContext('2d')!.drawImage(image, 0, 0)
      return canvas.convertToBlob({ type: 'image/png' })
    },
    linked: {
      get layers() {
        const { paint } = session.shown!
        if (paint !== session.checker && !paint.sample) return []
        return [{ paint: paint.sample ? paintName(paint.picture) : kChecker, opacity: 1, tint: '#ffffff', blend: 'normal', visible: true }]
      },
      get left() {
        const { paint } = session.shown!
        return paint !== session.checker && !paint.sample ? 1 : 0
      },
      restore() {},
    },
  }
}
