import type { Code, Mesh, Projection, ProjectOptions } from 'cagecast'
import type { InspectOptions, Inspection } from 'cagecast/inspect'

/** What the worker can do, and what it answers. */
export interface Tasks {
  project: { options: ProjectOptions; answer: Projection }
  inspect: { options: InspectOptions; answer: Inspection }
}

/** What the page asks of the worker. */
export type Request = { [Task in keyof Tasks]: { id: number; task: Task; cage: Mesh; target: Mesh; options: Tasks[Task]['options'] } }[keyof Tasks]

/** What the worker replies, with the id it was asked with. */
export type Reply = { id: number; answer: Tasks[keyof Tasks]['answer'] } | { id: number; code: Code; message: string }
