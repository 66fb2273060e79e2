import { type Command, Option } from 'commander';
import { forms } from '../../gltf/glb-writer.js';
import { settingsResolver } from '../config/config-flags.js';
import { borderKinds } from '../config/settings.js';
import { maskInputs } from '../options.js';
import { addRegionFlag } from '../paint/paint-flags.js';
import { boundsFault } from '../paint/read-paint.js';
import { print } from '../print.js';
import type { Progress } from '../progress.js';
import { readingOf } from '../read-flags.js';
import { autoCage } from '../run.js';
import { type Region, type TransferCommand, transferCommand } from '../transfer/command.js';
import { endingIn, refuseOverwriting, wrongUsage } from '../usage.js';
import { addCommonFlags, type CommonFlags } from './common-flags.js';

/** What its help says after the flags. */
const kHelp = `
_NCZ is 0 for a vertex that may be painted. Other values say why it must not be painted:
  1  occluded: another surface of the target lies over it
  2  uncovered: the cage has a hole over it, or it lies outside the cage
  3  culled: the cage covers too little of its segment (connected part), or has a hole meant for that segment
If the triangles at a vertex need different UVs, copies of the vertex with all its attributes are added after the
existing vertices; --seams vertex adds none. --borders cut also adds vertices, which blend existing ones. Draco changes
the order of vertices.
If TARGET was written by an earlier transfer, its UVs, zones and overlays are replaced. If it has an extension that is not
known here, the old copy of what is written anew, as by --compress, stays beside the new one: the extension may refer to it.
An overlay fills what a material cuts out by its alpha (alphaMode MASK), as between hairs; cagecast bake does not.
Each --region adds UVs and zones of its own (_NCZ_1, …) to the same vertices. --uv-bounds and --reference-cage are about
--cage alone. Within --uv-bounds, the UVs in OUT are 0..1. Zones are about the cage, whatever the bounds: vertices outside of
them may have _NCZ 0. A triangle across the bounds is painted whole, beyond them with the edge of the texture; --borders cut
does not cut it there.
With <UDIM> in the name of a texture, each tile of the cage's UVs has its own: 1001, 1002 to its right, 1011 above. A triangle
shows the tile that the centre of its UVs is in. A glTF gets OUT.bin and OUT-image0.png, … beside it. A mesh that is drawn as
many instances (EXT_mesh_gpu_instancing) is taken once, where its first instance is; all instances show the same paint.
Of several scenes, in TARGET as in cages, only the default one is read, or the first if none is the default; the others
stay as they are.
A file may be - for the standard input or output; if OUT is, the summary goes to the standard error.
--cage auto makes a cage for TARGET on the way, as cagecast make does, and excludes the parts whose names make leaves out by
default, unless --keep names them; for a file named auto, write ./auto.

Examples:
  cagecast transfer head.glb --cage cage.glb --texture paint.png -o painted.glb
  cagecast transfer head.glb --cage cage.glb --threshold 0.3 --report report.json
  cagecast transfer body.glb --cage cage.glb --keep skin --exclude '*eye*' -o painted.glb
  cagecast transfer body.glb --cage face.glb --texture face.png --region arms.glb=arms.png -o painted.gltf
  cagecast transfer body.glb --cage tiled.glb --texture 'skin.<UDIM>.png' -o painted.glb`;

/** Adds the command that transfers to a file. */
export function addTransferCommand(program: Command, progress: Progress): void {
  addRegionFlag(addCommonFlags(program.command('transfer')))
    .description('write TARGET with a new UV set and the attribute _NCZ (Non-Cosmetic Zone), otherwise unchanged')
    .option(
      '--texture <PAINT>',
      "PNG, JPEG, WebP or KTX2 in the cage's UV space, shown as an overlay on the triangles that may be painted; <UDIM> in its name stands for the number of each tile",
    )
    .addOption(
      new Option(
        '-o, --output <OUT.glb>',
        'where to write the GLB, VRM, or glTF with its files beside it; - for the standard output',
      ).argParser(endingIn('.glb', '.vrm', '.gltf')),
    )
    .addOption(
      new Option(
        '--borders <HOW>',
        'triangle: the paint ends at existing triangle edges; cut: triangles are cut at holes and seams',
      )
        .choices(borderKinds)
        .default('triangle'),
    )
    .addOption(
      new Option(
        '--compress <HOW>',
        'how the painted meshes of OUT are compressed; keep: as in TARGET; animations and skins stay as they are',
      )
        .choices(forms)
        .default('keep'),
    )
    .option('--report <R.json>', 'where to write counts, areas, segments and timings as JSON')
    .addHelpText('after', kHelp)
    .action(
      async (
        target: string,
        flags: CommonFlags &
          Pick<TransferCommand, 'texture' | 'output' | 'report' | 'borders' | 'compress'> & { region: Region[] },
        command: Command,
      ) => {
        const { cage, texture, output, report, uvBounds, referenceCage, region: regions } = flags;
        if (flags.quiet) progress.silence();
        if (texture !== undefined && output === undefined)
          command.error('--texture needs -o OUT.glb, the file to add it to', { exitCode: wrongUsage });
        if (regions.length > 0 && output === undefined)
          command.error('--region needs -o OUT.glb, the file to add it to', { exitCode: wrongUsage });
        if (flags.borders === 'cut' && output === undefined)
          command.error('--borders cut needs -o OUT.glb, the file for the cut target', { exitCode: wrongUsage });
        const fault = boundsFault(texture, uvBounds);
        if (fault !== undefined) command.error(fault, { exitCode: wrongUsage });
        const cages = [cage, ...regions.map((region) => region.cage)].filter((path) => path !== autoCage);
        const textures = [texture, ...regions.map((region) => region.texture)];
        const inputs = [target, referenceCage, ...cages, ...textures, ...maskInputs(flags), flags.config || undefined];
        refuseOverwriting(command, inputs, [output, report]);
        const found = await transferCommand(
          {
            target,
            cage,
            uvBounds,
            referenceCage,
            texture,
            regions,
            output,
            report,
            ...(await settingsResolver(command, flags)(target)),
            reading: readingOf(flags),
          },
          progress,
        );
        progress.clear();
        print(found, flags, [output, report]);
      },
    );
}
