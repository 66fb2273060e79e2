import { CagecastError, init, project } from 'cagecast'
import type { Reply, Request } from './transfer-messages'

init().catch(() => {}) // begun before the first request; told with it

addEventListener('message', async ({ data: request }: MessageEvent<Request>) => {
  const { id } = request
  try {
    await init()
    const answer = await answerTo(request)
    const arrays = Object.values(answer).filter((value): value is ArrayBufferView<ArrayBuffer> => ArrayBuffer.isView(value))
    const transfer = arrays.map((array) => array.buffer)
    postMessage({ id, answer } satisfies Reply, { transfer })
  } catch (error) {
    const code = error instanceof CagecastError ? error.code : 'internal'
    postMessage({ id, code, message: error instanceof Error ? error.message : String(error) } satisfies Reply)
  }
})

async function answerTo({ task, cage, target, options }: Request) {
  if (task === 'project') return project(cage, target, options)
  const { inspect } = await import('cagecast/inspect')
  return inspect(cage, target, options)
}
