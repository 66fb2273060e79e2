import type { Extracted } from '../gltf/extract-file.js';
import type { Run } from './run.js';
import { listed } from './table.js';

/** What a report says of a cage. */
export interface CageReport {
  file: string;
  vertices: number;
  triangles: number;
  /** Of a cage that was made on the way: the names of the parts that are not painted because of them. */
  excluded?: readonly string[];
}

export const cageReport = (file: string, { mesh }: Extracted, { excluded }: Run): CageReport => ({
  file,
  vertices: mesh.positions.length / 3,
  triangles: mesh.indices.length / 3,
  ...(excluded && { excluded }),
});

/** How many names a line has at most. */
const kMaxNames = 12;

/** Says which parts a cage was made without; empty if there are none. */
export const excludedLine = ({ excluded = [] }: CageReport): string =>
  excluded.length === 0 ? '' : `excluded from the cage by their names: ${listed(excluded, kMaxNames)}`;
