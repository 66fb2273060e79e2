import { useThree } from '@react-three/fiber';
import { useEffect, useState } from 'react';
import { createPainter, type Painter, type PainterOptions } from '../three/internals.js';
import type { Painted } from './use-cagecast.js';

/** What pointers do, and how: fields of `Painter`. */
export interface UsePainterOptions extends Pick<PainterOptions, 'size'>, Partial<Pick<Painter, 'tool' | 'picture'>> {
  /** What differs from the brush that a painter begins with. */
  brush?: Partial<Painter['brush']> | undefined;
}

/**
 * Lets pointers paint on a model of the canvas, on the layers that it shows. What is painted stays with the layers, also when another
 * model shows them. Controls that listen to the canvas do not see what paints.
 * @param painted  What `useCagecast` returned, with layers.
 * @param options  `tool`: what pointers do, undefined to leave them to others; `brush`, `picture` and `size` as those of `Painter`.
 * @returns the painter; undefined as long as the model or the layers are not there.
 * @throws {CagecastError} as `createPainter`.
 *
 * @example
 * const painted = useCagecast(gltf, { template: 'human-head', layers });
 * usePainter(painted, { tool: 'brush', brush: { color: '#cc2244' } });
 */
export function usePainter(
  { applied, cage, layers }: Pick<Painted, 'applied' | 'cage' | 'layers'>,
  options: UsePainterOptions = {},
): Painter | undefined {
  const { tool, brush, picture, size } = options;
  const { camera } = useThree();
  const [painter, setPainter] = useState<Painter>();
  useEffect(() => {
    if (!applied || !layers || !cage) return undefined;
    const made = createPainter({ applied, layers, cage, size });
    setPainter(made);
    return () => {
      made.dispose();
      setPainter(undefined);
    };
  }, [applied, layers, cage, size]);
  useEffect(() => painter?.listen(camera), [painter, camera]);
  useEffect(() => {
    if (!painter) return;
    painter.tool = 'tool' in options ? tool : 'brush';
    painter.picture = picture;
    Object.assign(painter.brush, brush);
  });
  return painter;
}
