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

/** The picture of an image file, as it is stored. @throws if it is none. */
export const asStored = (file: Blob): Promise<ImageBitmap> =>
  createImageBitmap(file, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
