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
${commands.map((command, i) => sectionOf(command, commands.slice(0, i))).join('\n')}
# Options of several commands

${headings.map((heading) => groupOf(heading, commands)).join('\n')}`;
}

const headingOf = ({ helpGroupHeading }: Option): string | undefined => helpGroupHeading?.slice(0, -1);

/** @param earlier  The commands before it: what one of them says in the same words is not said again. */
function sectionOf(command: Command, earlier: readonly Command[]): string {
  const help = command.createHelp();
  const name = command.name();
  const own = command.options.filter((option) => headingOf(option) === undefined);
  const whatItDoes = (option: Option) => {
    const same = earlier.find(({ options }) => options.some((other) => rowOf(other) === rowOf(option)));
    return same ? asOf(same) : described(option);
  };
  const groups = [...new Set(command.options.flatMap((option) => headingOf(option) ?? []))];
  const links = groups.map((group) => `[${group[0]!.toLowerCase()}${group.slice(1)}](#${anchorOf(group)})`);
  const arguments_ = help.visibleArguments(command).map(({ description }, i) => {
    const { required, variadic } = command.registeredArguments[i]!;
    const shown = `${command.registeredArguments[i]!.name()}${variadic ? '…' : ''}`;
    const same = earlier.find((other) => help.visibleArguments(other)[i]?.description === description);
    return `- \`${shown}\`${required ? '' : ', optional'}: ${same ? asOf(same) : description}\n`;
  });
  return `## cagecast ${name}

\`\`\`
cagecast ${name} ${help.commandUsage(command).split(' ').slice(2).join(' ')}
\`\`\`

${sentence(command.description())}

${arguments_.join('')}
${tableOf(own, whatItDoes)}
Also: ${links.join(', ')}.
${helpAfter(command)}`;
}

function groupOf(heading: string, commands: readonly Command[]): string {
  const having = commands.find(({ options }) => options.some((option) => headingOf(option) === heading));
  return `## ${heading}\n\n${tableOf(having!.options.filter((option) => headingOf(option) === heading))}`;
}

const anchorOf = (heading: string): string => heading.toLowerCase().replaceAll(' ', '-');

const tableOf = (options: readonly Option[], whatItDoes = described): string =>
  options.length === 0
    ? ''
    : `| Option | What it does |\n|---|---|\n${options.map((option) => rowOf(option, whatItDoes)).join('')}`;

const rowOf = (option: Option, whatItDoes = described): string =>
  `| ${code(option.flags)} | ${inCell(sentence(whatItDoes(option)))} |\n`;

const asOf = (command: Command): string => `as of [${command.name()}](#cagecast-${command.name()})`;

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
