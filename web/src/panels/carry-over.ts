import type { WebGLRenderer } from 'three';
import { Composite, readStraight } from '#three';
import { loadPaint } from '../loading/load-paint';
import type { RelayRequest } from '../loading/relay-worker';
import { askWorker } from '../platform/ask-worker';
import { requireGraphics } from '../platform/graphics';
import { pngOf } from '../platform/png';
import type { Model } from '../state/model';
import type { PutAwayLayers } from '../state/put-away-layers';
import type { Session } from '../state/session';

/**
 * Carries the paint of the cage before over to the current one, as one layer.
 * @throws Error if that cannot be; nothing is changed then, or if it was cancelled.
 */
export async function carryOver(session: Session, away: PutAwayLayers, renderer: WebGLRenderer): Promise<void> {
  const { earlier } = away;
  const { shown, rules } = session;
  if (!earlier || !shown) return;
  requireGraphics(renderer);
  let isWanted = true;
  const done = session.work('Carrying the paint over', 0.1, { abort: () => (isWanted = false) });
  try {
    const composite = new Composite();
    composite.set(earlier.layers);
    composite.update(renderer);
    const { width, height, data } = readStraight(renderer, composite.texture, composite.size);
    composite.dispose();
    const { preset, threshold, weldTolerance } = rules;
    const request: RelayRequest = {
      image: { width, height, data },
      from: meshOf(earlier.cage),
      to: meshOf(shown.cage.mesh),
      model: meshOf(shown.target.mesh),
      transfer: { preset, threshold, weldTolerance, parts: session.choices.parts, locks: session.choices.locks },
    };
    const worker = new Worker(new URL('../loading/relay-worker.ts', import.meta.url), { type: 'module' });
    const relayed = await askWorker<ImageData>(worker, request, [data.buffer]);
    const png = await pngOf(new ImageData(relayed.data, relayed.width, relayed.height));
    const paint = await loadPaint(new File([png], 'carried over.png', { type: 'image/png' }));
    if (isWanted) away.carryOver('carried over', paint);
  } finally {
    if (isWanted) done();
  }
}

/** A mesh as its file has it. */
const meshOf = ({ positions, rest = positions, indices, uvs, groups }: Model['mesh']) => ({
  positions: rest,
  indices,
  uvs,
  groups,
});
