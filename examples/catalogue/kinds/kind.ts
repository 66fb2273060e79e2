/** A kind of job. To add one: a file like transfer.ts, and a line in index.ts. */
export interface Kind {
  /** Part of each job's key: another number makes all jobs of this kind new. */
  version: number;
  /** The inputs of a job by name: whether a line of the manifest must have them. */
  inputs: Record<string, 'required' | 'optional'>;
  /** The ending of the file that a job writes, if it writes one. */
  ending?: string;
  /** How many seconds a job may take. Default: CATALOGUE_SECONDS */
  seconds?: number;
  /**
   * Does a job, in a process of its own that may be killed at any time: it reads and writes nothing but what it is given and returns.
   * @throws {Failure} if there is a reason; any other error is reported as unexpected.
   */
  run(inputs: Record<string, Uint8Array>, settings: Record<string, unknown>): Promise<Answer>;
}

/** What a job came to. */
export interface Answer {
  /** Becomes part of its line in the results: short, plain data. */
  facts: Facts;
  output?: Uint8Array;
}

export interface Facts {
  verdict?: string;
  /** Why the verdict is not better, in a sentence. */
  why?: string;
  /** Codes of findings, the most severe first. */
  findings?: string[];
  /** How bad it is, 0 to 1: the report shows the worst. */
  severity?: number;
  /** The share of triangles that may be painted. */
  painted?: number;
  [name: string]: unknown;
}
