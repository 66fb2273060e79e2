import { dirname } from 'node:path';
import { filesBeside, filesNamedIn } from '../io/beside.js';
import { filesOf } from '../io/glob.js';
import { kAutoCage, type TransferCommand } from '../model/sources.js';
import { isTiled, tilePath } from '../model/uv-bounds.js';
import type { Run } from './run-transfer.js';

/** What says which files a command reads. */
type Reads = Omit<TransferCommand, 'borders' | 'compress'>;

/** The files that a transfer reads, as its arguments and settings name them. */
export const filesNamedBy = ({ target, cage, referenceCage, texture, rules, regions = [] }: Reads): string[] => {
  const cages = [cage, ...regions.map((region) => region.cage)].filter((path) => path !== kAutoCage);
  const textures = [texture, ...regions.map((region) => region.texture)];
  const masks = [rules.masks.never?.path, rules.masks.always?.path];
  return [target, ...cages, referenceCage, ...textures, ...masks].filter((path) => path !== undefined);
};

/** The same with the tiles of textures, and what glTFs name that are there. */
export const filesReadBy = (command: Reads): string[] =>
  filesNamedBy(command)
    .flatMap((path) => (isTiled(path) ? filesOf(tilePath(path, '*')) : [path]))
    .flatMap((path) => [path, ...filesBeside(path, command.reading)]);

/** The same, and the configuration, when the models are read. */
export const allFilesReadBy = (command: Reads, { target, cage }: Run): string[] => [
  ...filesReadBy(command),
  ...filesNamedIn(target.file.json, dirname(command.target)),
  ...filesNamedIn(cage.file.json, dirname(command.cage)),
  ...(command.rules.config === undefined ? [] : [command.rules.config]),
];
