import {
  CagecastError,
  init,
  type Mesh,
  type Projection,
  project,
  type SplitVertices,
  splitVertices,
  type Timings,
} from 'cagecast';
import type { Reply, Request } from './transfer-messages';

const kAtRest = 1000; // milliseconds without a request
const kLongest = 200; // milliseconds: of longer ones little is compiling, and the next request would wait
const kTiming = 200; // milliseconds, in slices, between which the next request comes through
const kSlice = 20;

init().catch(() => {}); // begun before the first request; told with it

let rest: ReturnType<typeof setTimeout> | undefined;

addEventListener('message', async ({ data: request }: MessageEvent<Request>) => {
  const { id } = request;
  clearTimeout(rest);
  try {
    await init();
    const answer = await answerTo(request);
    postMessage({ id, answer } satisfies Reply, {
      transfer: buffersOf({ ...answer, ...('split' in answer && answer.split) }),
    });
    if (request.task === 'project' && 'timings' in answer && answer.timings.total < kLongest)
      rest = setTimeout(timeAgain, kAtRest, request);
  } catch (error) {
    const code = error instanceof CagecastError ? error.code : 'internal';
    postMessage({ id, code, message: error instanceof Error ? error.message : String(error) } satisfies Reply);
  }
});

async function answerTo({ id, task, cage, target, options }: Request) {
  if (task === 'project') {
    const projection = project(cage, target, options);
    postMessage({ id, half: true } satisfies Reply);
    return { ...projection, split: splitAtSeams(target, projection) };
  }
  if (task === 'cut') {
    const { cutBorders } = await import('cagecast/borders');
    return cutBorders(cage, target, options.result, options.rules);
  }
  const { inspect } = await import('cagecast/inspect');
  return inspect(cage, target, options);
}

/**
 * Times a projection whose code the browser has compiled, now and then until it has been at it for long enough: the mean of the
 * quicker half of the runs, as the clocks of browsers are coarse, and others want the processor too.
 */
function timeAgain(request: Request & { task: 'project' }, runs: Timings[] = [], spent = 0): void {
  const { id, cage, target, options } = request;
  const started = performance.now();
  do runs.push(project(cage, target, options).timings);
  while (performance.now() - started < kSlice);
  spent += performance.now() - started;
  if (spent < kTiming) {
    rest = setTimeout(timeAgain, kSlice, request, runs, spent);
    return;
  }
  runs.sort((a, b) => a.total - b.total);
  const quicker = runs.slice(0, Math.ceil(runs.length / 2));
  const again = { ...runs[0]! };
  for (const step of Object.keys(again) as (keyof Timings)[])
    again[step] = quicker.reduce((sum, run) => sum + run[step], 0) / quicker.length;
  postMessage({ id, again } satisfies Reply);
}

function splitAtSeams(target: Mesh, { cornerUvs, uvs }: Projection): SplitVertices {
  if (cornerUvs.length > 0) return splitVertices(target, cornerUvs);
  const ofVertices = new Float32Array(2 * target.indices.length);
  target.indices.forEach((vertex, corner) => ofVertices.set(uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * corner));
  return splitVertices(target, ofVertices);
}

/** The buffers of the arrays that an object holds: they are handed over instead of copied. */
function buffersOf(holder: object): ArrayBuffer[] {
  const arrays = Object.values(holder).filter((value): value is ArrayBufferView<ArrayBuffer> =>
    ArrayBuffer.isView(value),
  );
  return [...new Set(arrays.map(({ buffer }) => buffer))];
}
