import type { Mesh, TransferOptions } from 'cagecast'

/** What the page asks of the worker that writes models. */
export interface ExportRequest {
  /** The target's file first, then those it may refer to. */
  files: { name: string; bytes: ArrayBuffer }[]
  cage: Mesh
  /** A PNG in the cage's UVs. */
  texture: Uint8Array<ArrayBuffer>
  options: TransferOptions
}

export type ExportReply = { glb: Uint8Array<ArrayBuffer> } | { message: string }
