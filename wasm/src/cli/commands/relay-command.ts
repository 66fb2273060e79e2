import { type Command, Option } from 'commander';
import { mostTexels } from '../../bake/image.js';
import { kinds } from '../../bake/layout.js';
import type { Kind } from '../../bake/raster.js';
import { reachOf, relay } from '../../bake/relay.js';
import { scaledTo } from '../../gltf/bake/plan.js';
import { percent } from '../../inspect/finding.js';
import { encodePng, readImage } from '../io/images.js';
import type { Io } from '../io/io.js';
import { refuseOverwriting, writeFiles } from '../io/output.js';
import { UsageError } from '../model/failures.js';
import { resolveSettings } from '../model/settings.js';
import type { Sources } from '../model/sources.js';
import { configLine, integer } from '../model/text.js';
import { allFilesReadBy } from '../transfer/files-read.js';
import { inFile } from '../transfer/models.js';
import { readTarget } from '../transfer/read-target.js';
import { uvSetsLine } from '../transfer/report-parts.js';
import { runTransfer } from '../transfer/run-transfer.js';
import * as common from './common-flags.js';
import { type Found, perform } from './perform.js';
import { addTarget } from './transfer-command.js';

interface RelayFlags extends common.SettingFlags, common.AroundFlags, common.ReadFlags, common.PrintFlags {
  texture: string;
  /** The other cage. */
  to: string;
  /** A PNG in its UVs. */
  output: string;
  kind: Kind;
  size?: number;
}

/** The arguments of `cagecast relay`. */
interface RelayCommand extends Sources, Pick<RelayFlags, 'to' | 'output' | 'kind' | 'size'> {
  paint: string;
}

/** What its help says after the flags. */
const kHelp = `
Where several surfaces share a place in the other cage's UVs, the one nearest to that cage is seen. Holes of CAGE are filled with the
paint beside them; what it does not paint otherwise stays transparent.

Example:
  cagecast relay head.glb --cage cage.glb --texture paint.png --to fitted.glb -o paint-for-template.png`;

/** More of the paint than this is lost where a cage's UVs overlap, or where it does not tell limbs apart. */
const kMuchLost = 0.1;

/** Adds the command that carries a paint from one cage to another. */
export function addRelayCommand(program: Command, io: Io): void {
  const command = addTarget(program.command('relay'))
    .description('carry PAINT, drawn for CAGE, over to another cage on the same TARGET')
    .requiredOption('--texture <PAINT>', "PNG in the cage's UV space; JPEG and WebP where sharp is installed")
    .requiredOption('--to <CAGE>', 'the other cage; auto makes one')
    .addOption(
      common
        .parsed(
          '-o, --output <OUT.png>',
          "a PNG in the other cage's UV space; - for the standard output",
          common.endingIn('.png'),
        )
        .makeOptionMandatory(),
    )
    .addOption(new Option('--kind <KIND>', 'what the image holds').choices(kinds).default(kinds[0]))
    .addOption(
      common.parsed(
        '--size <TEXELS>',
        `the longer side of the result; 1 to ${mostTexels} (default: as of PAINT)`,
        common.wholeNumberWithin(1, mostTexels, ' of texels'),
      ),
    );
  common.addFlags(command, 'Parts', 'Painting', 'Reading', 'Printing');
  command.addHelpText('after', kHelp).action((target: string, flags: RelayFlags) => {
    const { texture: paint } = flags;
    const around = common.aroundOf(flags, target);
    const fault = common.wholeCageFault(flags.set);
    if (fault !== undefined) throw new UsageError(fault);
    const inputs = [target, ...common.inputsOf(flags), ...common.inputsOf({ cage: flags.to })];
    return perform(io, flags, { inputs, outputs: [flags.output] }, async () => {
      const { rules } = resolveSettings(await common.layersFor(flags)(target));
      const reading = common.readingOf(flags);
      return relayCommand({ ...flags, target, ...around, cageUvs: flags.set?.cageUvs, paint, rules, reading }, io);
    });
  });
}

/** Carries a paint over. @throws {InputError} that names the file at fault; then no file is written. */
async function relayCommand(command: RelayCommand, io: Io): Promise<Found> {
  const { target, cage, paint, to: other, output, kind, size, rules, reading } = command;
  const image = await readImage(paint, reading);
  const model = await readTarget(target, reading, io, rules);
  const from = await runTransfer(command, io, undefined, model);
  const to = await runTransfer(
    { ...command, cage: other, template: undefined, cageUvs: undefined },
    io,
    undefined,
    model,
  );
  io.step('carrying the paint over');
  const [width, height] = scaledTo(image, size);
  const { mesh } = model.extracted;
  const results = { from: from.result, to: to.result, reach: reachOf(from.cage.extracted.mesh, mesh) };
  const { overlap, ...baked } = inFile({ target: model, cage: from.cage }, () =>
    relay('relay', image, { model: mesh, ...results }, { width, height, kind }),
  );
  refuseOverwriting(
    [...allFilesReadBy(command, from), ...allFilesReadBy({ ...command, cage: other }, to), paint],
    [output],
  );
  writeFiles([{ path: output, data: await encodePng(baked) }], io);
  const painted = to.result.cosmeticTriangles.filter((one) => one === 1).length;
  const shared = to.result.cosmeticTriangles.filter(
    (one, t) => one === 1 && from.result.cosmeticTriangles[t] === 1,
  ).length;
  return {
    lines: [
      `wrote ${output}: ${width} × ${height}; of the ${integer(painted)} triangles that ${other} paints, ${cage} paints ${integer(shared)}`,
      overlap.lost > kMuchLost &&
        `${percent(overlap.lost)} of the paint found its place in the UVs of ${other} taken, by what is nearer to it`,
      uvSetsLine(from.cage.extracted.mesh),
      uvSetsLine(to.cage.extracted.mesh, `leave no other in ${other}`),
      configLine(rules.config),
    ],
    report: { output, width, height, triangles: { painted, shared }, overlap, config: rules.config ?? null },
  };
}
