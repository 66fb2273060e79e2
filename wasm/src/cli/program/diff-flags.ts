import { type Command, Option } from 'commander';
import { diffCommand } from '../diff/command.js';
import { numberWithin } from '../options.js';
import { addPrintFlags, type PrintFlags, print } from '../print.js';
import { changed } from '../usage.js';

/** Adds the command that compares reports. */
export function addDiffCommand(program: Command): void {
  addPrintFlags(
    program
      .command('diff')
      .argument('<BEFORE>', 'a report of transfer, or of inspect --json, or a folder of reports, with its subfolders')
      .argument('<AFTER>', 'another; in a folder, reports of the same names are compared'),
  )
    .description(
      'show what changed between two reports: zones, coverage of parts, regions, stretch, distances, borders, verdict',
    )
    .addOption(
      new Option('--tolerance <SHARE>', 'how much a share, or the stretch of the texture, may change; 0 to 1')
        .argParser(numberWithin(0, 1))
        .default(0.01),
    )
    .addHelpText(
      'after',
      `
Exit codes: 0 nothing changed by more than the tolerance, 1 a file cannot be used, 2 wrong usage, 4 a share changed by
more, the verdict is worse, a part or a region is new or gone, or a report is gone.

Examples:
  cagecast diff approved/head.json build/head.json --tolerance 0.005
  cagecast diff approved build`,
    )
    .action(async (before: string, after: string, flags: PrintFlags & { tolerance: number }) => {
      const found = await diffCommand({ before, after, tolerance: flags.tolerance });
      print(found, flags);
      if (found.over > 0) process.exitCode = changed;
    });
}
