import { type Command, Option } from 'commander';
import { type CageVerdict, type FitCommand, fitCommand, type MakeCommand, makeCommand } from './cage-command.js';
import { numberWithin, wholeNumberWithin } from './options.js';
import { addPrintFlags, type PrintFlags, print } from './print.js';
import type { Progress } from './progress.js';
import { addReadFlags, type ReadFlags, readingOf } from './read-flags.js';
import { endingIn, refuseOverwriting, unfit } from './usage.js';

/** The fewest and the most triangles that a cage can be asked to have. */
const kTriangleRange = [50, 20_000] as const;

/** The least and the most that gaps can be closed by, as a share of the diagonal. */
const kClosingRange = [0.0005, 0.2] as const;

/** Adds the flags that both commands have. */
const addOutputFlags = (command: Command): Command =>
  addPrintFlags(addReadFlags(command))
    .addOption(
      new Option('-o, --output <CAGE.glb>', 'where to write the cage; - for the standard output')
        .argParser(endingIn('.glb'))
        .makeOptionMandatory(),
    )
    .addOption(
      new Option('--html <REPORT.html>', 'where to write a page with pictures of the cage').argParser(
        endingIn('.html'),
      ),
    )
    .allowExcessArguments(false);

/** Of which parts a cage takes no notice. */
const exclusion = (): Option =>
  new Option(
    '--exclude <NAME>',
    'do not paint parts whose node or material has this name, or this word in its name (* matches any text, case does not matter); a node that holds others means all below it; may be repeated; replaces the default list, such as eyes, teeth and hair; an empty name excludes nothing',
  ).argParser((name: string, before: string[] = []) => (name === '' ? before : [...before, name]));

/** Adds the commands that make and fit cages. */
export function addCageCommands(program: Command, progress: Progress): void {
  addMakeCommand(program, progress);
  addFitCommand(program, progress);
}

function addMakeCommand(program: Command, progress: Progress): void {
  addOutputFlags(program.command('make').argument('<TARGET>', 'GLB or glTF of a head, a figure or a thing'))
    .description('make a cage for TARGET: a hull with holes over what is not painted, and UVs; print a verdict')
    .addOption(exclusion())
    .addOption(
      new Option(
        '--triangles <N>',
        `triangles of the cage, about; ${kTriangleRange[0]} to ${kTriangleRange[1]} (default: by kind)`,
      ).argParser(wholeNumberWithin(...kTriangleRange)),
    )
    .addOption(
      new Option('--kind <KIND>', 'what TARGET is, which decides how tight the cage is and where its seams are')
        .choices(['automatic', 'head', 'body', 'prop'])
        .default('automatic'),
    )
    .addOption(
      new Option(
        '--closing <SHARE>',
        `bridge gaps narrower than twice this share of TARGET's diagonal; ${kClosingRange[0]} to ${kClosingRange[1]} (default: by kind)`,
      ).argParser(numberWithin(...kClosingRange)),
    )
    .addHelpText(
      'after',
      `
The cage has a hole over each part that is not painted. Draw the texture for the cage's UVs.
Exit codes: 0 good or usable, 1 an input cannot be used, 2 wrong usage, 3 unfit.

Examples:
  cagecast make head.glb -o cage.glb
  cagecast make head.glb --exclude 'eye*' --exclude '*teeth' --triangles 800 -o cage.glb --html report.html`,
    )
    .action(
      async (
        target: string,
        flags: Omit<MakeCommand, 'target' | 'reading'> & ReadFlags & PrintFlags,
        command: Command,
      ) => {
        if (flags.quiet) progress.silence();
        refuseOverwriting(command, [target], [flags.output, flags.html]);
        const found = await makeCommand({ ...flags, target, reading: readingOf(flags) }, progress);
        progress.clear();
        show(found, flags);
      },
    );
}

function addFitCommand(program: Command, progress: Progress): void {
  addOutputFlags(
    program
      .command('fit')
      .argument(
        '<TEMPLATE>',
        'GLB or glTF of a cage with UVs, made for another model; or human-head, human-body, animal-head or car',
      )
      .argument('<TARGET>', 'GLB or glTF of the model that gets the cage'),
  )
    .description('move a template cage onto TARGET, so that one texture fits both; print a verdict')
    .option(
      '--template-landmarks <T.json>',
      'landmarks of the model that TEMPLATE was made for; default: those in the file (extras.landmarks)',
    )
    .option('--landmarks <L.json>', 'landmarks of TARGET; they override those that are found')
    .addOption(exclusion())
    .addHelpText(
      'after',
      `
Files of landmarks are JSON, name → [x, y, z] in the model's space: { "nose_tip": [0, 1.52, 0.11], … }
Exit codes: 0 good or usable, 1 an input cannot be used, 2 wrong usage, 3 unfit.

Examples:
  cagecast fit human-head head.glb -o cage.glb
  cagecast fit template.glb head.glb --landmarks head.json -o cage.glb --html report.html`,
    )
    .action(
      async (
        template: string,
        target: string,
        flags: Omit<FitCommand, 'template' | 'target' | 'reading'> & ReadFlags & PrintFlags,
        command: Command,
      ) => {
        const { templateLandmarks, landmarks, output, html } = flags;
        if (flags.quiet) progress.silence();
        refuseOverwriting(command, [template, target, templateLandmarks, landmarks], [output, html]);
        const found = await fitCommand({ ...flags, template, target, reading: readingOf(flags) }, progress);
        progress.clear();
        show(found, flags);
      },
    );
}

/** Prints what `inspect` says of a cage. */
function show(found: CageVerdict, flags: PrintFlags & { output: string; html?: string | undefined }): void {
  print(found, flags, [flags.output, flags.html]);
  if (found.verdict === 'unfit') process.exitCode = unfit;
}
