import { Command } from 'commander';
import type { Io } from '../io/io.js';
import { UsageError } from '../model/failures.js';
import { oneLine } from '../model/text.js';
import { addBakeCommand } from './bake-command.js';
import { addBatchCommand } from './batch-command.js';
import { addCageCommands } from './cage-commands.js';
import { insteadOf } from './common-flags.js';
import { addDiffCommand } from './diff-command.js';
import { addInspectCommand } from './inspect-command.js';
import { addRelayCommand } from './relay-command.js';
import { addThumbnailCommand } from './thumbnail-command.js';
import { addTransferCommand } from './transfer-command.js';

/** The command with all of its commands; it runs nothing yet. */
export function makeProgram(io: Io): Command {
  const program = new Command('cagecast')
    .description(
      'Transfers a texture, drawn once for a cage, to any mesh, and leaves out parts that must not be painted.',
    )
    .version(CAGECAST_VERSION, '--version', 'print the version')
    .helpOption('-h, --help', 'print help')
    .helpCommand('help [COMMAND]', 'print help for COMMAND')
    .exitOverride()
    .configureOutput({
      writeOut: (text) => io.out(text),
      writeErr: (text) => io.err(text),
      outputError: (text, write) => write(`cagecast: ${oneLine(inOneLine(text))}${insteadOf(text)}\n`),
    })
    .addHelpText(
      'after',
      `
Examples:
  cagecast make head.glb -o cage.glb
  cagecast transfer head.glb --cage cage.glb --texture paint.png -o painted.glb

Exit codes: 0 success, 1 an input cannot be used, 2 wrong usage, 3 inspect, make, fit or batch finds a cage unfit,
4 diff finds a change over the limit.`,
    );
  // An empty path would be the current folder, and nothing has an empty name.
  program.hook('preAction', (_, command) => {
    const hasEmpty = (value: unknown) => [value].flat().includes('');
    const flag = command.options.find((option) => hasEmpty(command.getOptionValue(option.attributeName())))?.long;
    const argument = command.registeredArguments.find((_, i) => hasEmpty(command.processedArgs[i]))?.name();
    if (flag ?? argument) throw new UsageError(`${flag ?? argument} is empty`);
  });
  addTransferCommand(program, io);
  addInspectCommand(program, io);
  addBakeCommand(program, io);
  addRelayCommand(program, io);
  addCageCommands(program, io);
  addBatchCommand(program, io);
  addDiffCommand(program, io);
  addThumbnailCommand(program, io);
  for (const command of program.commands) command.allowExcessArguments(false);
  return program;
}

/** A message of commander without its first word and its breaks of lines. */
const inOneLine = (text: string): string =>
  text
    .replace(/^error: /, '')
    .replace(
      /^too many arguments.*/s,
      (all) => `${all} The model is the one argument; the rest are flags, such as --cage, --texture and --template.`,
    )
    .split('\n')
    .map((line) => line.trim())
    .join(' ')
    .trim();
