import type { Command, Option } from 'commander';

/** The page about the command, in Markdown: docs/cli.md. It says what `--help` says; flags that several commands have, once. */
export function pageOf(program: Command): string {
  const { commands } = program;
  const headings = [
    ...new Set(commands.flatMap(({ options }) => options.flatMap((option) => headingOf(option) ?? []))),
  ];
  return `# The command

<!-- Made by wasm/tools/generate.mjs from wasm/src/cli. Do not edit. -->

${program.description()}

${commands.map((command) => `[${command.name()}](#cagecast-${command.name()})`).join(' · ')}

\`cagecast help COMMAND\` prints what is below, \`cagecast --version\` the version.
${helpAfter(program)}
${commands.map(sectionOf).join('\n')}
# Options of several commands

${headings.map((heading) => groupOf(heading, commands)).join('\n')}`;
}

const headingOf = ({ helpGroupHeading }: Option): string | undefined => helpGroupHeading?.slice(0, -1);

function sectionOf(command: Command): string {
  const help = command.createHelp();
  const name = command.name();
  const own = command.options.filter((option) => headingOf(option) === undefined);
  const groups = [...new Set(command.options.flatMap((option) => headingOf(option) ?? []))];
  const links = groups.map((group) => `[${group[0]!.toLowerCase()}${group.slice(1)}](#${anchorOf(group)})`);
  const arguments_ = help.visibleArguments(command).map(({ description }, i) => {
    const { required, variadic } = command.registeredArguments[i]!;
    const shown = `${command.registeredArguments[i]!.name()}${variadic ? '…' : ''}`;
    return `- \`${shown}\`${required ? '' : ', optional'}: ${description}\n`;
  });
  return `## cagecast ${name}

\`\`\`
cagecast ${name} ${help.commandUsage(command).split(' ').slice(2).join(' ')}
\`\`\`

${sentence(command.description())}

${arguments_.join('')}
${tableOf(own)}
Also: ${links.join(', ')}.
${helpAfter(command)}`;
}

function groupOf(heading: string, commands: readonly Command[]): string {
  const having = commands.filter(({ options }) => options.some((option) => headingOf(option) === heading));
  const options = having[0]!.options.filter((option) => headingOf(option) === heading);
  return `## ${heading}

Options of ${having.map((command) => `\`${command.name()}\``).join(', ')}.

${tableOf(options)}`;
}

const anchorOf = (heading: string): string => heading.toLowerCase().replaceAll(' ', '-');

const tableOf = (options: readonly Option[]): string =>
  options.length === 0
    ? ''
    : `| Option | What it does |\n|---|---|\n${options
        .map((option) => `| ${code(option.flags)} | ${inCell(sentence(described(option)))} |\n`)
        .join('')}`;

/** The text after the options, as a block: it is laid out for terminals. */
function helpAfter(command: Command): string {
  let text = '';
  const take = (more: string) => {
    text += more;
  };
  command.configureOutput({ ...command.configureOutput(), writeOut: take, writeErr: take });
  command.outputHelp();
  const help = command.helpInformation();
  const after = text.slice(text.indexOf(help) + help.length).trim();
  return after === '' ? '' : `\n\`\`\`\n${after}\n\`\`\`\n`;
}

function described({ description, argChoices, defaultValue, defaultValueDescription }: Option): string {
  const shown = defaultValueDescription ?? (defaultValue === undefined ? undefined : code(String(defaultValue)));
  return [
    description,
    argChoices && `choices: ${argChoices.map((choice) => code(choice)).join(', ')}`,
    shown !== undefined && `default: ${shown}`,
  ]
    .filter(Boolean)
    .join('; ');
}

const sentence = (text: string): string => `${text[0]!.toUpperCase()}${text.slice(1)}.`;
const code = (text: string): string => `\`${text}\``;
const inCell = (text: string): string => text.replaceAll('|', '\\|').replaceAll('<', '\\<').replaceAll('*', '\\*');
