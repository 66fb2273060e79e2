import { CagecastError, init, project } from 'cagecast'
import type { Reply, Request } from './transfer-messages'

init().catch(() => {}) // begun before the first request; told with it

addEventListener('message', async ({ data: { id, cage, target, options } }: MessageEvent<Request>) => {
  try {
    await init()
    const projection = project(cage, target, options)
    const arrays = Object.values(projection).filter((value): value is ArrayBufferView<ArrayBuffer> => ArrayBuffer.isView(value))
    const transfer = arrays.map((array) => array.buffer)
    postMessage({ id, projection } satisfies Reply, { transfer })
  } catch (error) {
    const code = error instanceof CagecastError ? error.code : 'internal'
    postMessage({ id, code, message: error instanceof Error ? error.message : String(error) } satisfies Reply)
  }
})
