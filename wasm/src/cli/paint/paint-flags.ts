import { type Command, InvalidArgumentError, Option } from 'commander';
import type { Region } from '../transfer/command.js';
import { parseBounds, type UvBounds } from './cage-area.js';

/** The flags about cages and textures, as commander parses them. */
export interface CageFlags {
  uvBounds?: UvBounds;
  referenceCage?: string;
}

/** Adds the flags that say which part of a cage counts. */
export const addCageAreaFlags = (command: Command): Command =>
  command
    .addOption(
      new Option(
        '--uv-bounds <U0,V0,U1,V1>',
        "the part of the cage's UVs that the texture covers; triangles wholly outside of it are not painted (default: all; the texture covers 0..1)",
      ).argParser(parseBounds),
    )
    .option(
      '--reference-cage <CAGE>',
      'another version of the cage. A triangle of --cage whose place in the UVs is empty in this file is left out, as if --cage had a hole there',
    );

/** Adds the flag for further cages. */
export const addRegionFlag = (command: Command): Command =>
  command.addOption(
    new Option(
      '--region <CAGE=PAINT>',
      'another cage with its texture, which paints only triangles that no cage before it paints; may be repeated',
    )
      .default([], 'none')
      .argParser(regionOf),
  );

function regionOf(text: string, before: Region[]): Region[] {
  // Names of folders may have a = in them, such as run=3.
  const [, cage, texture] = /^(.+?\.(?:glb|gltf|vrm)|[^=]+)=(.+)$/i.exec(text) ?? [];
  if (cage === undefined || texture === undefined)
    throw new InvalidArgumentError('It is not the file of a cage and that of a texture, with = between them.');
  return [...before, { cage, texture }];
}
