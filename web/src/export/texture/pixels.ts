import type { Image } from 'cagecast/engines';
import { encodePng } from '../../platform/encode-png';
import { readKtx2 } from './ktx2';

type Pixels = Image & { data: Uint8ClampedArray<ArrayBuffer> };

/**
 * Reads an image file, including KTX2, without loss: through WebGL, as a 2D canvas premultiplies colours.
 * @param fit Chooses the size from the original size.
 * @throws Error without a file name, if the browser cannot read it.
 */
export async function readPixels(
  file: Blob,
  fit: (width: number, height: number) => [number, number] = (...size) => size,
): Promise<Pixels> {
  const asItIs: ImageBitmapOptions = { premultiplyAlpha: 'none', colorSpaceConversion: 'none' };
  const source = file.type === 'image/ktx2' ? await readKtx2(await file.arrayBuffer()) : file;
  let bitmap = await createImageBitmap(source, asItIs).catch(() => {
    throw new Error('the browser cannot read an image');
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
  if (!gl) throw new Error('reading textures needs WebGL 2');
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
  if (error !== gl.NO_ERROR) throw new Error(`this device cannot read a texture of ${width} × ${height} pixels`);
  return { width, height, data };
}

/** Encodes a PNG without loss. */
export async function writePng({ width, height, data }: Image): Promise<Uint8Array<ArrayBuffer>> {
  const bitmap = await createImageBitmap(new ImageData(data as Uint8ClampedArray<ArrayBuffer>, width, height), {
    premultiplyAlpha: 'none',
  });
  return new Uint8Array(await (await encodePng(bitmap)).arrayBuffer());
}
