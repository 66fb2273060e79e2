import { CagecastError, init, project, splitVertices, type Mesh, type Projection, type SplitVertices } from 'cagecast'
import type { Reply, Request } from './transfer-messages'

init().catch(() => {}) // begun before the first request; told with it

addEventListener('message', async ({ data: request }: MessageEvent<Request>) => {
  const { id } = request
  try {
    await init()
    const answer = await answerTo(request)
    postMessage({ id, answer } satisfies Reply, { transfer: buffersOf({ ...answer, ...('split' in answer && answer.split) }) })
  } catch (error) {
    const code = error instanceof CagecastError ? error.code : 'internal'
    postMessage({ id, code, message: error instanceof Error ? error.message : String(error) } satisfies Reply)
  }
})

async function answerTo({ id, task, cage, target, options }: Request) {
  if (task === 'project') {
    const projection = project(cage, target, options)
    postMessage({ id, half: true } satisfies Reply)
    return { ...projection, split: splitAtSeams(target, projection) }
  }
  if (task === 'cut') {
    const { cutBorders } = await import('cagecast/borders')
    return cutBorders(cage, target, options.result, options.rules)
  }
  const { inspect } = await import('cagecast/inspect')
  return inspect(cage, target, options)
}

function splitAtSeams(target: Mesh, { cornerUvs, uvs }: Projection): SplitVertices {
  if (cornerUvs.length > 0) return splitVertices(target, cornerUvs)
  const ofVertices = new Float32Array(2 * target.indices.length)
  target.indices.forEach((vertex, corner) => ofVertices.set(uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * corner))
  return splitVertices(target, ofVertices)
}

/** The buffers of the arrays that an object holds: they are handed over instead of copied. */
function buffersOf(holder: object): ArrayBuffer[] {
  const arrays = Object.values(holder).filter((value): value is ArrayBufferView<ArrayBuffer> => ArrayBuffer.isView(value))
  return [...new Set(arrays.map(({ buffer }) => buffer))]
}
