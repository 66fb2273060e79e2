import { CagecastError, init, project } from 'cagecast'
import type { Reply, Request } from './transfer-messages'

init().catch(() => {}) // begun before the first request; told with it

addEventListener('message', async ({ data: { id, cage, target } }: MessageEvent<Request>) => {
  try {
    await init()
    const projection = project(cage, target)
    const { uvs, zones, triangles, distances, segments, indices } = projection
    const transfer = [uvs, zones, triangles, distances, segments, indices].map((array) => array.buffer)
    postMessage({ id, projection } satisfies Reply, { transfer })
  } catch (error) {
    const code = error instanceof CagecastError ? error.code : 'internal'
    postMessage({ id, code, message: error instanceof Error ? error.message : String(error) } satisfies Reply)
  }
})
