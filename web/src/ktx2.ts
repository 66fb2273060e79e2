import { DataTexture, Loader, type Texture } from 'three'
import type { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js'

/** What the visitor is told of a model with such textures. */
export const kWithoutKtx2 = 'Its KTX2 textures are not shown here, but saved with it.'

/**
 * Leaves KTX2 textures white, so that their model opens: Basis' transcoder makes functions out of text, which the page's
 * security policy forbids.
 */
export function leaveKtx2Out(): KTX2Loader {
  return new Blank() as Loader as KTX2Loader
}

class Blank extends Loader<Texture> {
  override load(_url: string, onLoad: (texture: Texture) => void): void {
    const texture = new DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1)
    texture.needsUpdate = true
    onLoad(texture)
  }
}
