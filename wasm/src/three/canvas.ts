export type Canvas = HTMLCanvasElement | OffscreenCanvas;
export type Context = CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D;

/** An element where there is a document, as its fonts are those of the page. @throws where there is no canvas. */
export function makeCanvas(width: number, height: number): Canvas {
  if (typeof document === 'undefined') return new OffscreenCanvas(width, height);
  return Object.assign(document.createElement('canvas'), { width, height });
}

/** An image as the data URL of a PNG file. */
export async function toPng(image: ImageData): Promise<string> {
  const canvas = makeCanvas(image.width, image.height);
  (canvas.getContext('2d') as Context).putImageData(image, 0, 0);
  if ('toDataURL' in canvas) return canvas.toDataURL();
  const reader = new FileReader();
  const end = new Promise((resolve) => reader.addEventListener('loadend', resolve));
  reader.readAsDataURL(await canvas.convertToBlob());
  await end;
  return reader.result as string;
}

/** The image file of a data URL, its bytes and media type. @throws if it is none. */
export function fromDataUrl(url: string): { bytes: Uint8Array<ArrayBuffer>; type: string } {
  const [, type, base64] = /^data:(image\/[\w.+-]+);base64,(.*)$/s.exec(url) ?? [];
  if (base64 === undefined) throw new Error('it is no data URL of an image');
  return { bytes: Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)), type: type! };
}

/** The picture of an image file, as it is stored. @throws if it is none. */
export const asStored = (file: Blob): Promise<ImageBitmap> =>
  createImageBitmap(file, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
