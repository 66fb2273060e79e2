import type { Command, Option } from 'commander';

/** The page about the command, in Markdown: docs/cli.md. It says what `--help` says. */
export function pageOf(program: Command): string {
  return `# The command

<!-- Made by wasm/tools/generate.mjs from wasm/src/cli. Do not edit. -->

${program.description()}

${program.commands.map((command) => `- [\`${command.name()}\`](#cagecast-${command.name()}): ${command.description()}`).join('\n')}

\`cagecast help COMMAND\` prints what is below, \`cagecast --version\` the version.
${helpAfter(program)}
${program.commands.map(sectionOf).join('\n')}`;
}

function sectionOf(command: Command): string {
  const help = command.createHelp();
  const rows = help
    .visibleOptions(command)
    .map((option) => `| ${code(option.flags)} | ${inCell(sentence(described(option)))} |\n`);
  const arguments_ = help.visibleArguments(command).map(({ description }, i) => {
    const { required, variadic } = command.registeredArguments[i]!;
    const name = command.registeredArguments[i]!.name();
    return `- \`${name}${variadic ? '…' : ''}\`${required ? '' : ', optional'}: ${description}\n`;
  });
  return `## cagecast ${command.name()}

\`\`\`
cagecast ${command.name()} ${help.commandUsage(command).split(' ').slice(2).join(' ')}
\`\`\`

${sentence(command.description())}

${arguments_.join('')}
| Option | What it does |
|---|---|
${rows.join('')}${helpAfter(command)}`;
}

/** The text after the options, as a block: it is laid out for terminals. */
function helpAfter(command: Command): string {
  let text = '';
  const take = (more: string) => {
    text += more;
  };
  command.configureOutput({ ...command.configureOutput(), writeOut: take, writeErr: take });
  command.outputHelp();
  const after = text.slice(text.indexOf(command.helpInformation()) + command.helpInformation().length).trim();
  return after === '' ? '' : `\n\`\`\`\n${after}\n\`\`\`\n`;
}

function described(option: Option): string {
  const { description, argChoices, defaultValue, defaultValueDescription } = option;
  const shown = defaultValueDescription ?? (defaultValue === undefined ? undefined : String(defaultValue));
  return [
    description,
    argChoices && `choices: ${argChoices.map((choice) => code(choice)).join(', ')}`,
    shown !== undefined && `default: ${defaultValueDescription === undefined ? code(shown) : shown}`,
  ]
    .filter(Boolean)
    .join('; ');
}

const sentence = (text: string): string => `${text[0]!.toUpperCase()}${text.slice(1)}.`;
const code = (text: string): string => `\`${text}\``;
const inCell = (text: string): string => text.replaceAll('|', '\\|').replaceAll('<', '\\<').replaceAll('*', '\\*');
