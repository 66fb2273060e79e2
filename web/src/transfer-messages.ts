import type { Code, Mesh, Projection, ProjectOptions } from 'cagecast'

/** What the page asks of the worker. */
export interface Request {
  id: number
  cage: Mesh
  target: Mesh
  options: ProjectOptions
}

/** What the worker replies, with the id it was asked with. */
export type Reply = { id: number; projection: Projection } | { id: number; code: Code; message: string }
