import { DataTexture, Loader, type LoadingManager, type Texture, type WebGLRenderer } from 'three';
import { KTX2Loader } from 'three/addons/loaders/KTX2Loader.js';

/**
 * Makes a decoder of KTX2 textures, whose files come with the page. Dispose of it: it holds workers.
 * @param renderer Its GPU determines the texture format. Without a renderer, textures are white.
 */
export function makeKtx2Loader(manager: LoadingManager, renderer: WebGLRenderer | undefined): KTX2Loader {
  return renderer
    ? new KTX2Loader(manager).setWorkerLimit(2).detectSupport(renderer)
    : (new Blank(manager) as Loader as KTX2Loader);
}

class Blank extends Loader<Texture> {
  override load(_url: string, onLoad: (texture: Texture) => void): void {
    const texture = new DataTexture(new Uint8Array([255, 255, 255, 255]), 1, 1);
    texture.needsUpdate = true;
    onLoad(texture);
  }

  dispose(): void {}
}
