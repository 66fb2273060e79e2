import { isMainThread } from 'node:worker_threads';
import { Command, CommanderError, Option } from 'commander';
import { forms } from '../gltf/glb-writer.js';
import { firstLine, InputError } from '../gltf/input-error.js';
import { CagecastError } from '../index.js';
import { addBatchCommand } from './batch-flags.js';
import { serveBatch } from './batch-worker.js';
import { addCageCommands } from './cage-flags.js';
import { diffCommand } from './diff-command.js';
import { inspectCommand } from './inspect-command.js';
import { addRuleFlags, numberWithin, type RuleFlags, rulesOf } from './options.js';
import { addPrintFlags, oneLine, type PrintFlags, print } from './print.js';
import { Progress } from './progress.js';
import { addReadFlags, type ReadFlags, readingOf } from './read-flags.js';
import { autoCage } from './run.js';
import { type TransferCommand, transferCommand } from './transfer-command.js';
import { changed, endingIn, refuseOverwriting, unfit, unusable, wrongUsage } from './usage.js';

const progress = new Progress();

interface CommonFlags extends RuleFlags, ReadFlags, PrintFlags {
  cage: string;
}

const common = (command: Command): Command =>
  addPrintFlags(
    addReadFlags(
      addRuleFlags(
        command
          .argument('<TARGET>', 'GLB, glTF or VRM that receives the texture')
          .requiredOption(
            '--cage <CAGE>',
            'GLB or glTF that the texture was drawn for; it must have UVs; auto makes one',
          )
          .allowExcessArguments(false),
      ),
    ),
  );

const program = new Command('cagecast')
  .description(
    'Transfers a texture, drawn once for a cage, to any mesh, and leaves out parts that must not be painted.',
  )
  .version(CAGECAST_VERSION, '--version', 'print the version')
  .helpOption('-h, --help', 'print help')
  .helpCommand('help [COMMAND]', 'print help for COMMAND')
  .exitOverride()
  .configureOutput({
    outputError: (text, write) =>
      write(
        `cagecast: ${oneLine(
          text
            .replace(/^error: /, '')
            .replace(/\s*\n\s*/g, ' ')
            .trim(),
        )}\n`,
      ),
  })
  .addHelpText(
    'after',
    `
Examples:
  cagecast transfer head.glb --cage cage.glb --texture paint.png -o painted.glb
  cagecast transfer head.glb --cage cage.glb -o head-with-uvs.glb --report report.json
  cagecast inspect head.glb --cage cage.glb
  cagecast make head.glb -o cage.glb
  cagecast fit template.glb head.glb -o cage.glb
  cagecast batch 'heads/*.glb' --cage cage.glb --texture paint.png -o 'out/{name}.glb'

Exit codes: 0 success, 1 an input cannot be used, 2 wrong usage, 3 inspect, make, fit or batch finds a cage unfit,
4 diff finds a change over the limit.`,
  );

common(program.command('transfer'))
  .description('write TARGET with a new UV set and the attribute _NCZ, otherwise unchanged')
  .option(
    '--texture <PAINT>',
    "PNG, JPEG or WebP in the cage's UV space, shown as an overlay on the triangles that may be painted",
  )
  .addOption(
    new Option('-o, --output <OUT.glb>', 'where to write the GLB or VRM; - for the standard output').argParser(
      endingIn('.glb', '.vrm'),
    ),
  )
  .addOption(
    new Option(
      '--borders <HOW>',
      'triangle: the paint ends at existing triangle edges; cut: triangles are cut at holes and seams',
    )
      .choices(['triangle', 'cut'])
      .default('triangle'),
  )
  .addOption(
    new Option('--compress <HOW>', 'how the geometry of OUT is compressed; keep: as in TARGET')
      .choices(forms)
      .default('keep'),
  )
  .option('--report <R.json>', 'where to write counts, areas, segments and timings as JSON')
  .addHelpText(
    'after',
    `
_NCZ is 0 for a vertex that may be painted. Other values say why it must not be painted:
  1  occluded: another surface of the target lies over it
  2  uncovered: the cage has a hole over it, or it lies outside the cage
  3  culled: the cage covers too little of its segment (connected part), or has a hole meant for that segment
If the triangles at a vertex need different UVs, copies of the vertex with all its attributes are added after the
existing vertices; --seams vertex adds none. --borders cut also adds vertices, which blend existing ones. Draco changes
the order of vertices.
A file may be - for the standard input or output; if OUT is, the summary goes to the standard error.
--cage auto makes a cage for TARGET on the way, as cagecast make does; for a file named auto, write ./auto.

Examples:
  cagecast transfer head.glb --cage cage.glb --texture paint.png -o painted.glb
  cagecast transfer head.glb --cage cage.glb --threshold 0.3 --report report.json
  cagecast transfer body.glb --cage cage.glb --keep skin --exclude 'eye*' -o painted.glb`,
  )
  .action(
    async (
      target: string,
      flags: CommonFlags & Pick<TransferCommand, 'texture' | 'output' | 'report' | 'borders' | 'compress'>,
      command: Command,
    ) => {
      const { cage, texture, output, report, borders, compress } = flags;
      if (flags.quiet) progress.silence();
      if (texture !== undefined && output === undefined)
        command.error('--texture needs -o OUT.glb, the file to add it to', { exitCode: wrongUsage });
      if (borders === 'cut' && output === undefined)
        command.error('--borders cut needs -o OUT.glb, the file for the cut target', { exitCode: wrongUsage });
      refuseOverwriting(command, [target, cage === autoCage ? undefined : cage, texture], [output, report]);
      const found = await transferCommand(
        { target, cage, texture, output, report, borders, compress, rules: rulesOf(flags), reading: readingOf(flags) },
        progress,
      );
      progress.clear();
      print(found, flags, [output, report]);
    },
  );

common(program.command('inspect'))
  .description('check whether the cage fits TARGET; print a verdict, reasons and advice')
  .addOption(new Option('--html <REPORT.html>', 'where to write a page with pictures').argParser(endingIn('.html')))
  .addHelpText(
    'after',
    `
The verdict is good, usable (fits, with reservations) or unfit. The most important reasons come first.
Exit codes: 0 good or usable, 1 an input cannot be used, 2 wrong usage, 3 unfit.

Examples:
  cagecast inspect head.glb --cage cage.glb
  cagecast inspect head.glb --cage cage.glb --html report.html
  cagecast inspect head.glb --cage cage.glb --json`,
  )
  .action(async (target: string, flags: CommonFlags & { html?: string }, command: Command) => {
    const { cage, html } = flags;
    if (flags.quiet) progress.silence();
    refuseOverwriting(command, [target, cage], [html]);
    const found = await inspectCommand(
      { target, cage, html, rules: rulesOf(flags), reading: readingOf(flags) },
      progress,
    );
    progress.clear();
    print(found, flags, [html]);
    if (found.verdict === 'unfit') process.exitCode = unfit;
  });

addCageCommands(program, progress);
addBatchCommand(program, progress);

addPrintFlags(
  program
    .command('diff')
    .argument('<BEFORE.json>', 'a report of transfer, or of inspect --json')
    .argument('<AFTER.json>', 'another'),
)
  .description('show what changed between two reports: zones, coverage of parts, distances, borders, verdict')
  .addOption(
    new Option('--tolerance <SHARE>', 'how much a share may change').argParser(numberWithin(0, 1)).default(0.01),
  )
  .addHelpText(
    'after',
    `
Exit codes: 0 nothing changed by more than the tolerance, 1 a file cannot be used, 2 wrong usage, 4 a share changed by
more, the verdict is worse, or a part is new or gone.

Example:
  cagecast diff approved/head.json build/head.json --tolerance 0.005`,
  )
  .action(async (before: string, after: string, flags: PrintFlags & { tolerance: number }) => {
    const found = await diffCommand({ before, after, tolerance: flags.tolerance });
    print(found, flags);
    if (found.over > 0) process.exitCode = changed;
  });

// A reader that closes the pipe early, such as `head`, is not an error.
process.stdout.on('error', (error: NodeJS.ErrnoException) => process.exit(error.code === 'EPIPE' ? 0 : unusable));

/** Runs the command that the arguments say. */
async function main(): Promise<void> {
  try {
    await program.parseAsync();
  } catch (error) {
    progress.clear();
    if (error instanceof CommanderError) {
      // Help that is printed because no command was given is wrong usage.
      process.exitCode = error.exitCode === 0 ? 0 : wrongUsage;
    } else {
      const known = error instanceof InputError || error instanceof CagecastError;
      const text = known ? (error as Error).message : `failed unexpectedly (${firstLine(error)}); please report it`;
      process.stderr.write(`cagecast: ${oneLine(text)}\n`);
      process.exitCode = unusable;
    }
  }
}

// A batch runs this file in its threads.
if (isMainThread) await main();
else serveBatch();
