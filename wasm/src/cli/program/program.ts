import { Command } from 'commander';
import { addBakeCommand } from '../bake/flags.js';
import { addBatchCommand } from '../batch-flags.js';
import { addCageCommands } from '../cage-flags.js';
import { writeStandard } from '../output.js';
import { oneLine } from '../print.js';
import type { Progress } from '../progress.js';
import { wrongUsage } from '../usage.js';
import { addCompletionCommand } from './completion.js';
import { addDiffCommand } from './diff-flags.js';
import { addInspectCommand } from './inspect-flags.js';
import { addTransferCommand } from './transfer-flags.js';

/** The command with all of its commands, which show their progress; it runs nothing yet. */
export function makeProgram(progress: Progress): Command {
  const program = new Command('cagecast')
    .description(
      'Transfers a texture, drawn once for a cage, to any mesh, and leaves out parts that must not be painted.',
    )
    .version(CAGECAST_VERSION, '--version', 'print the version')
    .helpOption('-h, --help', 'print help')
    .helpCommand('help [COMMAND]', 'print help for COMMAND')
    .exitOverride()
    .configureOutput({
      writeOut: writeStandard,
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
  cagecast bake head.glb cage.glb paint.png -o painted.glb
  cagecast inspect head.glb --cage cage.glb
  cagecast make head.glb -o cage.glb
  cagecast fit template.glb head.glb -o cage.glb
  cagecast batch 'heads/*.glb' --cage cage.glb --texture paint.png -o 'out/{name}.glb'

Exit codes: 0 success, 1 an input cannot be used, 2 wrong usage, 3 inspect, make, fit or batch finds a cage unfit,
4 diff finds a change over the limit.`,
    );

  // An empty path would be the current folder.
  program.hook('preAction', (_, command) => {
    const flag = command.options.find((option) => command.getOptionValue(option.attributeName()) === '')?.long;
    const argument = command.registeredArguments.find((_, i) => [command.processedArgs[i]].flat().includes(''))?.name();
    if (flag ?? argument) command.error(`${flag ?? argument} is empty`, { exitCode: wrongUsage });
  });
  addTransferCommand(program, progress);
  addInspectCommand(program, progress);
  addBakeCommand(program, progress);
  addCageCommands(program, progress);
  addBatchCommand(program, progress);
  addDiffCommand(program);
  addCompletionCommand(program);
  return program;
}
