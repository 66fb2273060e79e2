import { encodePng } from '../../platform/encode-png';
import { readKtx2 } from './ktx2';

/** An image: 4 bytes per pixel, sRGB and alpha, colours not multiplied by it; its upper row first, as glTF's UVs have it. */
export interface Pixels {
  width: number;
  height: number;
  data: Uint8ClampedArray<ArrayBuffer>;
}

/**
 * Reads an image file, KTX2 too, to the byte, also what is transparent: through WebGL, as a canvas in 2D multiplies colours by alpha.
 * @param fit Chooses the size to read it in by the size it has, 8 bits a channel.
 * @throws Error in plain words, without a name, if the browser cannot.
 */
export async function readPixels(
  file: Blob,
  fit: (width: number, height: number) => [number, number] = (...size) => size,
): Promise<Pixels> {
  const asItIs: ImageBitmapOptions = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };
  const source = file.type === 'image/ktx2' ? await readKtx2(await file.arrayBuffer()) : file;
  let bitmap = await createImageBitmap(source, asItIs).catch(() => {
    throw new Error('there is an image the browser cannot read');
  });
  const [width, height] = fit(bitmap.width, bitmap.height);
  if (width !== bitmap.width || height !== bitmap.height) {
    bitmap = await createImageBitmap(bitmap, {
      ...asItIs,
      resizeWidth: width,
      resizeHeight: height,
      resizeQuality: 'high',
    });
  }
  const gl = new OffscreenCanvas(1, 1).getContext('webgl2');
  if (!gl) throw new Error('textures cannot be read here, for want of WebGL 2');
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(
    gl.FRAMEBUFFER,
    gl.COLOR_ATTACHMENT0,
    gl.TEXTURE_2D,
    gl.getParameter(gl.TEXTURE_BINDING_2D),
    0,
  );
  const data = new Uint8ClampedArray(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
  const error = gl.getError();
  gl.getExtension('WEBGL_lose_context')?.loseContext();
  bitmap.close();
  if (error !== gl.NO_ERROR) throw new Error(`a texture of ${width} × ${height} pixels cannot be read here`);
  return { width, height, data };
}

/** Writes a PNG that has every byte of the image. */
export async function writePng({ width, height, data }: Pixels): Promise<Uint8Array<ArrayBuffer>> {
  const bitmap = await createImageBitmap(new ImageData(data, width, height), { premultiplyAlpha: 'none' });
  return new Uint8Array(await (await encodePng(bitmap)).arrayBuffer());
}
