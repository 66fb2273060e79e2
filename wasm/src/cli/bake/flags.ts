import { type Command, Option } from 'commander';
import { mostTexels } from '../../bake/index.js';
import { addConfigFlags, type ConfigFlags, settingsResolver } from '../config/config-flags.js';
import { borderKinds } from '../config/settings.js';
import { addRuleFlags, maskInputs, type RuleFlags, wholeNumberWithin } from '../options.js';
import { addPrintFlags, type PrintFlags, print } from '../print.js';
import type { Progress } from '../progress.js';
import { addReadFlags, type ReadFlags, readingOf } from '../read-flags.js';
import { autoCage } from '../run.js';
import { endingIn, refuseOverwriting, wrongUsage } from '../usage.js';
import { type BakeCommand, bakeCommand } from './command.js';

type Flags = Pick<BakeCommand, 'normal' | 'orm' | 'output' | 'part' | 'size' | 'borders'> &
  RuleFlags &
  ConfigFlags &
  ReadFlags &
  PrintFlags & { back?: boolean };

/** What its help says after the flags. */
const kHelp = `
A part is not painted if its material has no texture, or its UVs are not an unwrapping; the summary says which. Where UVs
overlap, as those of mirrored halves do, the part that comes first has the texels. Overlays of an earlier transfer are taken away.

Examples:
  cagecast bake head.glb cage.glb paint.png -o painted.glb
  cagecast bake head.glb cage.glb paint.png --normal scales.png --size 2048 -o painted.glb
  cagecast bake head.glb cage.glb --back -o paint-again.png`;

/** Adds the command that bakes paint into textures. */
export function addBakeCommand(program: Command, progress: Progress): void {
  const command = program
    .command('bake')
    .description("bake PAINT into TARGET's own textures, in its own UVs; its geometry stays as it is")
    .argument('<TARGET>', 'GLB, glTF or VRM that receives the paint')
    .argument('<CAGE>', 'GLB or glTF that the paint was drawn for; it must have UVs; auto makes one')
    .argument('[PAINT]', "PNG in the cage's UV space; JPEG and WebP where sharp is installed")
    .allowExcessArguments(false)
    .addOption(
      new Option(
        '-o, --output <OUT>',
        "a GLB or VRM, or a PNG of the paint alone, in TARGET's UVs; - for a GLB on the standard output",
      )
        .argParser(endingIn('.glb', '.vrm', '.png'))
        .makeOptionMandatory(),
    )
    .option('--normal <MAP>', "a normal map in the cage's UV space")
    .option('--orm <MAP>', "occlusion, roughness and metalness in the cage's UV space, as in glTF")
    .option('--back', "the way back: write what is painted on TARGET as a PNG in the cage's UV space")
    .addOption(
      new Option(
        '--part <NAME>',
        'for a PNG: only parts of this node or material (* matches any text); a node that holds others means all below it; may be repeated',
      )
        .default([], 'all')
        .argParser((name: string, before: string[]) => [...before, name]),
    )
    .addOption(
      new Option(
        '--size <TEXELS>',
        `the longer side of painted textures; 1 to ${mostTexels} (default: as before)`,
      ).argParser(wholeNumberWithin(1, mostTexels, ' of texels')),
    )
    .addOption(
      new Option('--borders <HOW>', 'triangle: the paint ends at triangle edges; cut: exactly at holes and seams')
        .choices(borderKinds)
        .default('triangle'),
    );
  addPrintFlags(addReadFlags(addConfigFlags(addRuleFlags(command))))
    .addHelpText('after', kHelp)
    .action(async (target: string, cage: string, paint: string | undefined, flags: Flags, command: Command) => {
      const { normal, orm, output, part, size, back = false } = flags;
      const refuse = (text: string) => command.error(text, { exitCode: wrongUsage });
      const isPicture = output.toLowerCase().endsWith('.png');
      if (back && (!isPicture || paint !== undefined || normal !== undefined || orm !== undefined))
        refuse('--back takes TARGET and CAGE only, and writes a PNG');
      if (!back && isPicture && paint === undefined) refuse('to write a PNG, PAINT is needed');
      if (isPicture && (normal !== undefined || orm !== undefined)) refuse('--normal and --orm need an OUT.glb');
      if (!back && paint === undefined && normal === undefined && orm === undefined)
        refuse('there is nothing to bake: give PAINT, --normal or --orm');
      if (!isPicture && part.length > 0) refuse('--part is for a PNG; for a GLB, use --exclude');
      if (flags.quiet) progress.silence();
      const own = [target, cage === autoCage ? undefined : cage, paint, normal, orm];
      const inputs = [...own, ...maskInputs(flags), flags.config || undefined];
      refuseOverwriting(command, inputs, [output]);
      const found = await bakeCommand(
        {
          target,
          cage,
          paint,
          normal,
          orm,
          output,
          back,
          part,
          size,
          ...(await settingsResolver(command, flags)(target)),
          reading: readingOf(flags),
        },
        progress,
      );
      progress.clear();
      print(found, flags, [output]);
    });
}
