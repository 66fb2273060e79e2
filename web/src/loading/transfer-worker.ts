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
} from 'cagecast';
import type { Reply, Request } from '../state/transfers';

const kIdle = 1000; // milliseconds without a request before retiming
const kLongest = 200; // milliseconds: longer transfers are not retimed, as compiling is a small part of them
const kTiming = 200; // milliseconds in all, in slices that let the next request through
const kSlice = 20;

init().catch(() => {}); // start early; errors are reported with the first request

let timer: ReturnType<typeof setTimeout> | undefined;

addEventListener('message', async ({ data: request }: MessageEvent<Request>) => {
  const { id } = request;
  clearTimeout(timer);
  try {
    await init();
    const answer = await answerTo(request);
    postMessage({ id, answer } satisfies Reply, {
      transfer: buffersOf({ ...answer, ...('split' in answer && answer.split) }),
    });
    if (request.task === 'project' && 'timings' in answer && answer.timings.total < kLongest)
      timer = setTimeout(retime, kIdle, request);
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
  const { inspect } = await import('#inspect');
  return inspect(cage, target, options);
}

/**
 * Times a projection once the browser has compiled its code: the mean of the quicker half of its runs, as browser clocks are
 * coarse and other processes interfere.
 */
function retime(request: Request & { task: 'project' }, runs: Timings[] = [], spent = 0): void {
  const { id, cage, target, options } = request;
  const started = performance.now();
  do runs.push(project(cage, target, options).timings);
  while (performance.now() - started < kSlice);
  spent += performance.now() - started;
  if (spent < kTiming) {
    timer = setTimeout(retime, kSlice, request, runs, spent);
    return;
  }
  runs.sort((a, b) => a.total - b.total);
  const quicker = runs.slice(0, Math.ceil(runs.length / 2));
  const retimed = { ...runs[0]! };
  for (const step of Object.keys(retimed) as (keyof Timings)[])
    retimed[step] = quicker.reduce((sum, run) => sum + run[step], 0) / quicker.length;
  postMessage({ id, retimed } satisfies Reply);
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
