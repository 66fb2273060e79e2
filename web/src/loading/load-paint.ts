import { CanvasTexture, RepeatWrapping, SRGBColorSpace, Texture } from 'three';
import { maxCompositeSize } from '#three';
import type { Paint } from '../state/paint';

const kLargest = maxCompositeSize;

/**
 * Reads an image to paint with.
 * @param picture URL of an image of the page's own, which is trusted; an object URL of the file by default.
 * @throws Error that names the file.
 */
export async function loadPaint(file: File, picture?: string): Promise<Paint> {
  const bitmap = await (picture === undefined ? readImage(file) : decode(file));
  const texture = new Texture(bitmap);
  // glTF's UV origin is the upper left corner of the image.
  texture.flipY = false;
  texture.needsUpdate = true;
  return { name: file.name, texture: prepare(texture), picture: picture ?? URL.createObjectURL(file), file };
}

/** Reads an image, reduced in size if it is very large. @throws Error that names the file. */
export async function readImage(file: File): Promise<ImageBitmap> {
  const { checkPicture } = await import('./given-file');
  await checkPicture(file);
  return decode(file);
}

async function decode(file: File): Promise<ImageBitmap> {
  let bitmap: ImageBitmap;
  try {
    bitmap = await createImageBitmap(file, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
  } catch {
    throw new Error(`${file.name}: the browser cannot read this image; use PNG, JPEG or WebP`);
  }
  const shrink = kLargest / Math.max(bitmap.width, bitmap.height);
  if (shrink >= 1) return bitmap;
  const resizeWidth = Math.max(1, Math.round(bitmap.width * shrink));
  const resizeHeight = Math.max(1, Math.round(bitmap.height * shrink));
  try {
    return await createImageBitmap(bitmap, { resizeWidth, resizeHeight, resizeQuality: 'high' });
  } finally {
    bitmap.close(); // else it takes its memory until garbage is collected
  }
}

/** Makes a lettered checker, which shows where the texture lands and how it is stretched. */
export function makeChecker(): Paint {
  let texture: Texture | undefined;
  return {
    name: 'UV checker',
    picture: checkerPicture(),
    get texture() {
      // Drawn on demand: the first canvas and font take 0.2 s.
      return (texture ??= checkerTexture());
    },
  };
}

/** A cell of the checker. */
interface Cell {
  row: number;
  column: number;
  color: string;
  dark: boolean;
}

const kCells = 8; // per side

const checkerCells: readonly Cell[] = Array.from({ length: kCells ** 2 }, (_, number) => {
  const [row, column] = [Math.floor(number / kCells), number % kCells];
  const dark = (row + column) % 2 === 0;
  return { row, column, dark, color: `hsl(${(360 * number) / kCells ** 2} 62% ${dark ? 42 : 76}%)` };
});

function checkerPicture(): string {
  const cells = checkerCells.map(({ row, column, color }) => `<path fill="${color}" d="M${column} ${row}h1v1h-1"/>`);
  return `data:image/svg+xml,${encodeURIComponent(`<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${kCells} ${kCells}">${cells.join('')}</svg>`)}`;
}

function checkerTexture(): Texture {
  const size = 1024;
  const cell = size / kCells;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = size;
  const context = canvas.getContext('2d')!;
  context.font = `600 ${cell * 0.36}px system-ui, sans-serif`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  for (const { row, column, color, dark } of checkerCells) {
    context.fillStyle = color;
    context.fillRect(column * cell, row * cell, cell, cell);
    context.fillStyle = dark ? '#fff' : '#1b1b1b';
    context.fillText('ABCDEFGH'[column]! + (row + 1), (column + 0.5) * cell, (row + 0.52) * cell);
  }
  const texture = new CanvasTexture(canvas);
  texture.flipY = false;
  return prepare(texture);
}

function prepare(texture: Texture): Texture {
  texture.colorSpace = SRGBColorSpace;
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.anisotropy = 8;
  return texture;
}
