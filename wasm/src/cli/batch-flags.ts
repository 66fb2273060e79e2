import { type Command, Option } from 'commander';
import { standard } from '../gltf/files.js';
import { forms } from '../gltf/glb-writer.js';
import { batchCommand, describeBatch } from './batch-command.js';
import { jobsOfManifest, jobsOfPatterns, placeholderFault, writtenBy } from './batch-jobs.js';
import { addConfigFlags, type ConfigFlags, settingsResolver } from './config/config-flags.js';
import { borderKinds } from './config/settings.js';
import { addRuleFlags, maskInputs, type RuleFlags, wholeNumberWithin } from './options.js';
import { writeStandard } from './output.js';
import { addCageAreaFlags, addRegionFlag, type CageFlags } from './paint/paint-flags.js';
import { boundsFault } from './paint/read-paint.js';
import { addPrintFlags, jsonText, oneLine, type PrintFlags } from './print.js';
import type { Progress } from './progress.js';
import { addReadFlags, type ReadFlags, readingOf } from './read-flags.js';
import type { Region, TransferCommand } from './transfer/command.js';
import { endingIn, unfit, unusable, wrongUsage } from './usage.js';

interface BatchFlags
  extends RuleFlags,
    CageFlags,
    ConfigFlags,
    ReadFlags,
    PrintFlags,
    Pick<TransferCommand, 'texture' | 'output' | 'report' | 'borders' | 'compress'> {
  cage?: string;
  region: Region[];
  manifest?: string;
  results?: string;
  resume?: boolean;
  failOn?: 'usable' | 'unfit';
  workers?: number;
}

/** What its help says after the flags. */
const kHelp = `
A line of a manifest, with paths relative to the manifest:
  {"target": "head.glb", "cage": "cage.glb", "output": "out/head.glb", "threshold": 0.3, "exclude": ["*eye*"]}
A line that is printed: target, output, report, key (of the job: its settings, and size and time of what it reads), status (done,
failed or skipped), ms, counts, triangles, and error, verdict and findings (codes) if there are. After the lines, a summary goes
to the standard error: a text, or with --json JSON. With --quiet, only the errors of jobs go there.
With --resume, a skipped job adds no line to --results, unless the last line about its target is of its failure, or from
a job that is not in this batch (another cage, say).
A job that fails does not stop the others, and leaves what an earlier run wrote. Files are complete or not there, even if the
batch is killed; folders that are missing are made. {name} and {dir} are for -o and --report only: cages and textures that
differ need a manifest.
Exit codes: 0 all done, 1 a job failed, 2 wrong usage, 3 no job failed, but --fail-on found a cage that does not fit as demanded.

Examples:
  cagecast batch 'in/**/*.glb' --cage cage.glb --texture paint.png -o 'out/{name}.glb'
  cagecast batch --manifest jobs.jsonl --results results.jsonl --resume --fail-on unfit`;

/** Adds the command that runs many transfers. */
export function addBatchCommand(program: Command, progress: Progress): void {
  const command = program
    .command('batch')
    .argument('[TARGETS...]', 'GLB, glTF or VRM; * in a name matches any text, ** any folders but linked ones');
  for (const add of [addCageAreaFlags, addRegionFlag, addRuleFlags, addConfigFlags, addReadFlags, addPrintFlags])
    add(command);
  command
    .description('transfer to many files, in threads; print a line of JSON for each')
    .option(
      '--manifest <JOBS.jsonl>',
      'a JSON object per line: target, cage, referenceCage, uvBounds, texture, regions, output, report, and any setting of cagecast.config.json by its name (threshold, exclude, borders, …); - for the standard input',
    )
    .option('--cage <CAGE>', 'the cage of jobs that name none; auto makes one for each target')
    .option('--texture <PAINT>', 'the texture of jobs that name none')
    .addOption(
      new Option(
        '-o, --output <OUT.glb>',
        'where to write; {name} is the name of the target, {dir} its folder',
      ).argParser(endingIn('.glb', '.vrm', '.gltf')),
    )
    .option('--report <R.json>', 'where to write reports; {name} and {dir} as above')
    .addOption(new Option('--borders <HOW>', 'as for transfer').choices(borderKinds).default('triangle'))
    .addOption(new Option('--compress <HOW>', 'as for transfer').choices(forms).default('keep'))
    .option(
      '--results <RESULTS.jsonl>',
      'add the lines to this file instead of printing them; the last line about a target counts',
    )
    .option(
      '--resume',
      'skip jobs that --results says are done, if size and time of what they read are the same, and what they wrote is there',
    )
    .addOption(
      new Option(
        '--fail-on <VERDICT>',
        'inspect each cage, and exit 3 if one is no better than this; reports have the verdict then',
      ).choices(['usable', 'unfit']),
    )
    .addOption(
      new Option('--workers <N>', 'threads; 1 to 999 (default: one per processor)').argParser(
        wholeNumberWithin(1, 999),
      ),
    )
    .addHelpText('after', kHelp)
    .action((targets: string[], flags: BatchFlags) => runBatch(command, targets, flags, progress));
}

async function runBatch(command: Command, targets: string[], flags: BatchFlags, progress: Progress): Promise<void> {
  const { manifest, results, resume = false, failOn, workers, texture, output, report, cage } = flags;
  const fault = faultOf(targets, flags);
  if (fault !== undefined) command.error(fault, { exitCode: wrongUsage });
  if (flags.quiet) progress.silence();
  const defaults = {
    cage,
    uvBounds: flags.uvBounds,
    referenceCage: flags.referenceCage,
    texture,
    regions: flags.region,
    output,
    report,
    results,
    inspects: failOn === undefined ? undefined : true,
    cuts: flags.borders === 'cut',
    settingsFor: settingsResolver(command, flags),
    reading: readingOf(flags),
  };
  const jobs =
    manifest === undefined ? await jobsOfPatterns(targets, defaults) : await jobsOfManifest(manifest, defaults);
  const summary = await batchCommand(
    { jobs, results, resume, failOn, workers, onError: flags.quiet ? printError : undefined },
    flags.quiet ? () => {} : writeStandard,
    progress,
  );
  const savesNothing =
    failOn === undefined &&
    results === undefined &&
    summary.done > 0 &&
    jobs.every((job) => writtenBy(job).length === 0);
  const text = savesNothing ? `${describeBatch(summary)}\n${kNothingSaved}` : describeBatch(summary);
  if (!flags.quiet) process.stderr.write(flags.json ? jsonText(summary) : `${text}\n`);
  process.exitCode = summary.failed > 0 ? unusable : summary.misfits > 0 ? unfit : 0;
}

const kNothingSaved = 'no model or report written; for these, add -o OUT.glb or --report R.json';

const printError = (error: string): void => void process.stderr.write(`cagecast: ${oneLine(error)}\n`);

/** What is wrong with the arguments together, if anything is. */
function faultOf(targets: readonly string[], flags: BatchFlags): string | undefined {
  const { manifest, results, resume, cage, uvBounds, referenceCage, texture, region, output, report, borders } = flags;
  if (targets.length > 0 === (manifest !== undefined)) return 'give either TARGETS or --manifest';
  if (resume && results === undefined) return '--resume needs --results, which says what is done';
  if (manifest === undefined && cage === undefined) return 'TARGETS need --cage';
  if (texture !== undefined && output === undefined && manifest === undefined) return '--texture needs -o OUT.glb';
  if (borders === 'cut' && output === undefined && manifest === undefined)
    return '--borders cut needs -o OUT.glb, the file for the cut target';
  if ([output, report, results].includes(standard)) return 'a batch writes files; the standard output has its lines';
  const ofRegions = region.flatMap((one) => [one.cage, one.texture]);
  if ([cage, referenceCage, texture, ...ofRegions, ...maskInputs(flags), ...targets].includes(standard))
    return 'a batch reads files; its jobs have no standard input';
  if (manifest === standard && flags.config === standard) return 'only one file can be the standard input';
  return placeholderFault(output, report) ?? boundsFault(texture, uvBounds);
}
