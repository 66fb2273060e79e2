import { answerBy } from '../../platform/ask-worker';
import { draw } from './draw';
import { patterns } from './patterns';
import { portrait } from './portrait';
import type { Canvas } from './spots';

/** Paints to draw for a cage: textures, or small pictures of it. */
export interface DrawRequest {
  names: readonly string[];
  canvas: Canvas;
  /** Texels, or pixels, per side. */
  size: number;
  kind: 'texture' | 'portrait';
}

/** A PNG for each of the names. */
export interface Drawn {
  files: Blob[];
}

answerBy(async ({ names, canvas, size, kind }: DrawRequest): Promise<Drawn> => {
  const make = kind === 'texture' ? draw : portrait;
  const files = names.map(async (name) => {
    const pixels = new ImageData(make(patterns[name]!, canvas, size), size);
    const board = new OffscreenCanvas(size, size);
    board.getContext('2d')!.putImageData(pixels, 0, 0);
    return board.convertToBlob();
  });
  return { files: await Promise.all(files) };
});
