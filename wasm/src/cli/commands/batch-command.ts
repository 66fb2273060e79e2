import { type Command, Option } from 'commander';
import type { Verdict } from '../../inspect/finding.js';
import { counted } from '../../inspect/finding.js';
import { standard } from '../io/files.js';
import type { Io } from '../io/io.js';
import { kExit, UsageError } from '../model/failures.js';
import type { Region } from '../model/sources.js';
import { jsonText, oneLine } from '../model/text.js';
import { boundsFault } from '../model/uv-bounds.js';
import { jobsOfManifest, jobsOfPatterns, placeholderFault, writtenBy } from './batch-jobs.js';
import { type BatchSummary, runJobs } from './batch-run.js';
import * as common from './common-flags.js';

interface BatchFlags extends common.SettingFlags, common.AroundFlags, common.ReadFlags, common.PrintFlags {
  texture?: string;
  output?: string;
  report?: string;
  region: Region[];
  manifest?: string;
  results?: string;
  resume?: boolean;
  atLeast?: Verdict;
  workers?: number;
}

/** What its help says after the flags. */
const kHelp = `
A line of a manifest, with paths relative to the manifest:
  {"target": "head.glb", "cage": "cage.glb", "output": "out/head.glb", "threshold": 0.3, "exclude": ["*eye*"]}
Its members: target, cage, template, cageUvs, referenceCage, uvBounds, texture, regions, output, report, and any setting of
cagecast.config.json.
A line that is printed: target, output, report, key (of the job: its settings, and size and time of what it reads), status (done,
failed or skipped), ms, counts, triangles; if there are, also error, verdict, findings (codes), note (why next to nothing may be
painted), isTurned (the cage was turned by half), otherUvSets (of the cage: any may be meant) and template (what --template came to,
or made). Then a summary goes to the standard error; with --quiet, only errors go there.
The cages of a batch are left out of the files that a pattern names. Missing folders are made.
A job that fails does not stop the others. Files are complete or not there, even if the batch is killed.
With --resume, a skipped job adds no line to --results, unless the last line about its target is of a failure or another batch.
Exit codes: 1 a job failed, 3 none failed, but --at-least found a cage that does not fit as demanded.

Examples:
  cagecast batch "in/**/*.glb" --cage cage.glb --texture paint.png -o "out/{name}.glb"
  cagecast batch --manifest jobs.jsonl --results results.jsonl --resume --at-least usable`;

/** Adds the command that runs many transfers. */
export function addBatchCommand(program: Command, io: Io): void {
  const command = program
    .command('batch')
    .argument(
      '[TARGETS...]',
      'GLB, glTF, VRM, FBX, OBJ, PLY, STL or USDZ; * in a name matches any text, ** any folders but linked ones',
    )
    .description('transfer to many files, in threads; print a line of JSON for each')
    .option('--manifest <JOBS.jsonl>', 'a JSON object per line, for a job each; - for the standard input')
    .option(
      '--cage <CAGE>',
      'the cage of jobs that name none; auto makes one for each target (default: as of transfer)',
    )
    .addOption(common.templateFlag())
    .option('--texture <PAINT>', 'the texture of jobs that name none; {template} stands for what --template came to')
    .addOption(
      common.parsed(
        '-o, --output <OUT.glb>',
        'where to write; {name} is the name of the target, {dir} its folder',
        common.endingIn('.glb', '.vrm', '.gltf'),
      ),
    )
    .option('--report <R.json>', 'where to write reports; {name} and {dir} as above')
    .option(
      '--results <RESULTS.jsonl>',
      'add the lines to this file instead of printing them; the last one about a target counts',
    )
    .option(
      '--resume',
      'skip jobs that --results says are done, if what they read is unchanged and what they wrote is there',
    )
    .addOption(
      new Option(
        '--at-least <VERDICT>',
        'inspect each cage, and exit 3 if one is worse than this; reports have the verdict then',
      ).choices(['good', 'usable']),
    )
    .addOption(
      common.parsed(
        '--workers <N>',
        'threads; 1 to 999 (default: one per processor)',
        common.wholeNumberWithin(1, 999),
      ),
    );
  common.addFlags(command, ...common.transferGroups);
  command.addHelpText('after', kHelp).action((targets: string[], flags: BatchFlags) => runBatch(targets, flags, io));
}

async function runBatch(targets: string[], flags: BatchFlags, io: Io): Promise<void> {
  const { manifest, results, resume = false, atLeast, workers, quiet, json } = flags;
  const { cage, template, texture, region: regions, output, report } = flags;
  const { cageUvs, uvBounds, referenceCage } = flags.set ?? {};
  const fault = faultOf(targets, flags);
  if (fault !== undefined) throw new UsageError(fault);
  if (quiet) io.silence();
  const defaults = {
    ...{ cage, template, cageUvs, uvBounds, referenceCage, texture, regions, output, report, results },
    inspects: atLeast === undefined ? undefined : true,
    layersFor: common.layersFor(flags),
    reading: common.readingOf(flags),
  };
  const { jobs, leftOut = [] } =
    manifest === undefined
      ? await jobsOfPatterns(targets, defaults)
      : { jobs: await jobsOfManifest(manifest, defaults) };
  const summary = await runJobs({ jobs, results, resume, atLeast, workers, quiet }, io);
  const savesNothing = !atLeast && !results && summary.done > 0 && jobs.every((job) => writtenBy(job).length === 0);
  const without = leftOut.length > 0 ? `; left out, as they are cages: ${leftOut.join(', ')}` : '';
  const text = `${oneLine(describe(summary) + without)}${savesNothing ? kNothingSaved : ''}\n`;
  if (!quiet) io.err(json ? jsonText({ ...summary, ...(without && { leftOut }) }) : text);
  io.exitCode = summary.failed > 0 ? kExit.unusable : summary.misfits > 0 ? kExit.unfit : 0;
}

const kNothingSaved = '\nno model or report written; for these, add -o OUT.glb or --report R.json';

/** What is wrong with the arguments together, if anything is. */
function faultOf(targets: readonly string[], flags: BatchFlags): string | undefined {
  const { manifest, results, resume, texture, output, report } = flags;
  if (targets.length > 0 === (manifest !== undefined)) return 'give either TARGETS or --manifest';
  if (resume && results === undefined) return '--resume needs --results, which says what is done';
  if ([output, report, results].includes(standard)) return 'a batch writes files; the standard output has its lines';
  if ([...common.inputsOf({ ...flags, config: undefined }), ...targets].includes(standard))
    return 'a batch reads files; its jobs have no standard input';
  if (manifest === standard && flags.config === standard) return 'only one file can be the standard input';
  if (flags.cage !== undefined && flags.template !== undefined) return common.eitherCage;
  const withoutOutput = manifest === undefined ? common.outputFault(flags) : undefined;
  return withoutOutput ?? placeholderFault(output, report) ?? boundsFault(texture, flags.set?.uvBounds);
}

/** A summary for people. */
function describe({ jobs, done, failed, skipped, bare, misfits, configs, seconds }: BatchSummary): string {
  const parts = [
    `${done} done`,
    `${failed} failed`,
    ...(skipped > 0 ? [`${skipped} done before`] : []),
    ...(misfits > 0 ? [`${misfits} with a cage that does not fit as demanded`] : []),
  ];
  const from = configs.length > 0 ? `; settings from ${configs.join(', ')}` : '';
  const notes = bare > 0 ? `; next to nothing may be painted of ${bare}, as notes in the lines say` : '';
  return `${counted(jobs, 'job')}: ${parts.join(', ')}; ${seconds.toFixed(1)} s${from}${notes}`;
}
