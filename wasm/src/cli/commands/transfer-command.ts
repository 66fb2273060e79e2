import { type Command, Option } from 'commander';
import type { Io } from '../io/io.js';
import { UsageError } from '../model/failures.js';
import { resolveSettings } from '../model/settings.js';
import type { Region } from '../model/sources.js';
import { boundsFault } from '../model/uv-bounds.js';
import { transferToFile } from '../transfer/transfer-to-file.js';
import * as common from './common-flags.js';
import { perform } from './perform.js';

/** The flags of the commands that transfer to one target. */
export interface TargetFlags extends common.SettingFlags, common.AroundFlags, common.ReadFlags, common.PrintFlags {}

interface TransferFlags extends TargetFlags {
  texture?: string;
  region: Region[];
  output?: string;
  report?: string;
}

/** Adds TARGET and the cage of a command that transfers to it. */
export const addTarget = (command: Command): Command =>
  command
    .argument('<TARGET>', 'GLB, glTF, VRM, FBX, OBJ, PLY, STL or USDZ')
    .option(
      '--cage <CAGE>',
      'a file of the same kinds but STL, with UVs that the texture was drawn for; auto makes one (default: the meshes of TARGET that are named as outer cages of others)',
    )
    .addOption(common.templateFlag());

/** What its help says after the flags. */
const kHelp = `
The attribute _NCZ (Non-Cosmetic Zone) of a vertex is 0 where it may be painted. Other values say why not:
  1  occluded: another surface of the target lies over it
  2  uncovered: the cage has a hole over it, or it lies outside the cage
  3  culled: the cage covers too little of its segment (connected part), or has a hole meant for that segment
Cages: a mesh named Head_OuterCage is the cage of Head_Geo alone. --cage auto makes a cage as cagecast make does; a file named auto
is ./auto. Parts that a cage was made without stay bare, unless --keep names them. A cage that faces the other way, as on a model of
VRM 0, is turned by half if it then fits clearly better; the summary says so.
OUT: what an earlier transfer added is replaced. Where triangles need different UVs, copies of vertices are added after the others
(not with --set seams=vertex); --borders cut adds some, too; Draco changes their order. --region adds UVs and zones of its own
(_NCZ_1, …). An overlay fills what a material cuts out by its alpha (MASK), as between hairs; cagecast bake does not. Triangles
that the texture hides are drawn by the overlay alone: it is opaque there, so that hair before it stays before it.
cageUvs, uvBounds and referenceCage are about --cage alone. Within the bounds, the UVs in OUT are 0..1. A triangle across them is
painted whole; zones do not depend on them.
<UDIM> stands for the tiles of the cage's UVs: 1001, 1002 to its right, 1011 above. A triangle shows the tile of its UVs' centre.
Of several scenes, the default one is read; of the instances of a mesh (EXT_mesh_gpu_instancing), the first.
A file may be - for the standard input or output; if OUT is, the summary goes to the standard error.

Examples:
  cagecast transfer head.glb --cage cage.glb --texture paint.png -o painted.glb
  cagecast transfer body.glb --cage cage.glb --keep skin --exclude "*eye*" -o painted.glb
  cagecast transfer body.glb --cage face.glb --texture face.png --region arms.glb=arms.png -o painted.gltf
  cagecast transfer body.glb --cage tiled.glb --texture "skin.<UDIM>.png" -o painted.glb`;

/** Adds the command that transfers to a file. */
export function addTransferCommand(program: Command, io: Io): void {
  const command = addTarget(program.command('transfer'))
    .description('write TARGET with a UV set and an attribute _NCZ more, and the texture as an overlay')
    .option(
      '--texture <PAINT>',
      "PNG, JPEG, WebP or KTX2 in the cage's UV space; with <UDIM> in its name, one for each tile",
    )
    .addOption(
      common.parsed(
        '-o, --output <OUT.glb>',
        'GLB, VRM, or glTF with its files beside it; - for the standard output',
        common.endingIn('.glb', '.vrm', '.gltf'),
      ),
    )
    .addOption(new Option('--report <R.json>', 'counts, areas, segments and timings as JSON'));
  common.addFlags(command, ...common.transferGroups);
  command.addHelpText('after', kHelp).action((target: string, flags: TransferFlags) => {
    const { texture, output, report, region: regions } = flags;
    const { cageUvs, uvBounds, referenceCage } = flags.set ?? {};
    const around = common.aroundOf(flags, target);
    const fault = common.outputFault(flags) ?? boundsFault(texture, uvBounds);
    if (fault !== undefined) throw new UsageError(fault);
    return perform(io, flags, { inputs: [target, ...common.inputsOf(flags)], outputs: [output, report] }, async () => {
      const settings = resolveSettings(await common.layersFor(flags)(target));
      const files = { target, ...around, cageUvs, uvBounds, referenceCage, texture, regions, output, report };
      return transferToFile({ ...files, ...settings, reading: common.readingOf(flags) }, io);
    });
  });
}
