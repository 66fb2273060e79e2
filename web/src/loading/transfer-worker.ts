import {
  CagecastError,
  cutBorders,
  init,
  type Mesh,
  type Projection,
  project,
  type SplitVertices,
  splitVertices,
  type Timings,
  transfer,
} from 'cagecast';
import type { Reply, Request } from '../state/transfers';

const kCompiling = 2; // runs

init().catch(() => {}); // start early; errors are reported with the first request

addEventListener('message', async ({ data: request }: MessageEvent<Request>) => {
  const { id } = request;
  try {
    await init();
    const answer = await answerTo(request);
    postMessage({ id, answer } satisfies Reply, {
      transfer: buffersOf({ ...answer, ...('split' in answer && answer.split) }),
    });
  } catch (error) {
    const known = error instanceof CagecastError ? error : new CagecastError('internal', request.task, String(error));
    const { code, fn, reason, argument, at } = known;
    postMessage({ id, error: [code, fn, reason, { argument, at }] } satisfies Reply);
  }
});

async function answerTo({ id, task, cage, target, options }: Request) {
  if (task === 'project') {
    const projection = project(cage, target, options);
    postMessage({ id, projected: true } satisfies Reply);
    return { ...projection, split: splitAtSeams(target, projection) };
  }
  if (task === 'cut') {
    return cutBorders(cage, target, options.result, options.rules);
  }
  if (task === 'time') {
    const { runs, rules } = options;
    const run = (): Timings => transfer(cage, target, rules).timings;
    for (let i = 0; i < kCompiling; i++) run();
    return { runs: Array.from({ length: runs }, run) };
  }
  const { inspect } = await import('#inspect');
  return inspect(cage, target, options);
}

function splitAtSeams(target: Mesh, { cornerUvs, uvs }: Projection): SplitVertices {
  if (cornerUvs.length > 0) return splitVertices(target, cornerUvs);
  const ofVertices = new Float32Array(2 * target.indices.length);
  target.indices.forEach((vertex, corner) => ofVertices.set(uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * corner));
  return splitVertices(target, ofVertices);
}

/** The buffers of all arrays in an object, to transfer instead of copy. */
function buffersOf(holder: object): ArrayBuffer[] {
  const arrays = Object.values(holder).filter((value): value is ArrayBufferView<ArrayBuffer> =>
    ArrayBuffer.isView(value),
  );
  return [...new Set(arrays.map(({ buffer }) => buffer))];
}
