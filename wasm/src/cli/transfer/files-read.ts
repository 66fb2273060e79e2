import { existsSync } from 'node:fs';
import { dirname } from 'node:path';
import { templateNames } from '../../cages/template-names.js';
import { filesBeside, filesNamedIn } from '../io/beside.js';
import { filesOf } from '../io/glob.js';
import { isByTemplate, kAutoCage, type TransferCommand, texturePath } from '../model/sources.js';
import { isTiled, tilePath } from '../model/uv-bounds.js';
import type { Run } from './run-transfer.js';
import { isKnownTemplate } from './template.js';

/** What says which files a command reads. */
type Reads = Omit<TransferCommand, 'borders' | 'compress'>;

/** The files that a transfer reads, as its arguments and settings name them. */
export const filesNamedBy = ({
  target,
  cage,
  template,
  referenceCage,
  texture,
  rules,
  regions = [],
}: Reads): string[] => {
  const cages = [cage, ...regions.map((region) => region.cage)].filter((path) => path !== kAutoCage);
  const from = isKnownTemplate(template) ? undefined : template;
  const textures = [texture, ...regions.map((region) => region.texture)];
  const masks = [rules.masks.never?.path, rules.masks.always?.path];
  return [target, ...cages, from, referenceCage, ...textures, ...masks].filter((path) => path !== undefined);
};

/** The same with the tiles of textures, and what glTFs name that are there. */
export const filesReadBy = (command: Reads): string[] =>
  filesNamedBy(command)
    .flatMap((path) => (isByTemplate(path) ? texturesOf(path) : [path]))
    .flatMap((path) => (isTiled(path) ? filesOf(tilePath(path, '*')) : [path]))
    .flatMap((path) => [path, ...filesBeside(path, command.reading)]);

/** The textures for templates that are there. */
const texturesOf = (path: string): string[] =>
  [...templateNames, 'made'].map((name) => texturePath(path, name)).filter((one) => isTiled(one) || existsSync(one));

/** The same, and the configuration, when the models are read. */
export const allFilesReadBy = (command: Reads, { target, cage }: Run): string[] => [
  ...filesReadBy(command),
  ...filesNamedIn(target.file.json, dirname(command.target)),
  ...filesNamedIn(cage.file.json, dirname(command.cage)),
  ...(command.rules.config === undefined ? [] : [command.rules.config]),
];
