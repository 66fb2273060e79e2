import { type Command, Option } from 'commander';
import { settingsResolver } from '../config/config-flags.js';
import { inspectCommand } from '../inspect-command.js';
import { maskInputs } from '../options.js';
import { print } from '../print.js';
import type { Progress } from '../progress.js';
import { readingOf } from '../read-flags.js';
import { endingIn, refuseOverwriting, unfit } from '../usage.js';
import { addCommonFlags, type CommonFlags } from './common-flags.js';

/** Adds the command that judges a cage. */
export function addInspectCommand(program: Command, progress: Progress): void {
  addCommonFlags(program.command('inspect'))
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
      const { cage, uvBounds, referenceCage, html } = flags;
      if (flags.quiet) progress.silence();
      const inputs = [target, cage, referenceCage, ...maskInputs(flags), flags.config || undefined];
      refuseOverwriting(command, inputs, [html]);
      const found = await inspectCommand(
        {
          target,
          cage,
          uvBounds,
          referenceCage,
          html,
          rules: (await settingsResolver(command, flags)(target)).rules,
          reading: readingOf(flags),
        },
        progress,
      );
      progress.clear();
      print(found, flags, [html]);
      if (found.verdict === 'unfit') process.exitCode = unfit;
    });
}
