import { type Command, InvalidArgumentError, type Option } from 'commander';
import { writeStandard } from '../output.js';

/** The shells for which there is completion. */
const shells = ['bash', 'zsh', 'fish'] as const;
type Shell = (typeof shells)[number];

/** What a shell offers: the commands, and the flags of each. */
interface Known {
  name: string;
  description: string;
  options: readonly Option[];
}

const knownOf = (program: Command): Known[] =>
  program.commands.map((command) => ({
    name: command.name(),
    description: command.description(),
    options: command.createHelp().visibleOptions(command),
  }));

const flagsOf = ({ short, long }: Option): string[] => [short, long].filter((flag) => flag !== undefined);

/** Whether a flag has a value that is one of some words. */
const withChoices = (options: readonly Option[]) => options.filter(({ argChoices }) => argChoices !== undefined);

/** A text within single quotes of a shell. */
const quoted = (text: string): string => `'${text.replaceAll("'", "'\\''")}'`;

/** A script by which a shell completes the command. All of them offer files where no flag begins. */
function completion(program: Command, shell: Shell): string {
  return { bash, zsh, fish }[shell](knownOf(program));
}

function bash(commands: readonly Known[]): string {
  const cases = commands.map(({ name, options }) => {
    const choices = withChoices(options).map(
      (option) => `        ${flagsOf(option).join('|')}) words=${quoted(option.argChoices!.join(' '))} ;;`,
    );
    return [
      `    ${name})`,
      '      case $before in',
      ...choices,
      `        *) [[ $word == -* ]] && words=${quoted(options.flatMap(flagsOf).join(' '))} ;;`,
      '      esac ;;',
    ].join('\n');
  });
  const names = [...commands.map(({ name }) => name), 'help', '--help', '--version'].join(' ');
  return `# Completion of cagecast for bash. In ~/.bashrc: source <(cagecast completion bash)
_cagecast() {
  local word=\${COMP_WORDS[COMP_CWORD]} before=\${COMP_WORDS[COMP_CWORD-1]} words=''
  COMPREPLY=()
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W ${quoted(names)} -- "$word"))
    return
  fi
  case \${COMP_WORDS[1]} in
${cases.join('\n')}
    help) words=${quoted(commands.map(({ name }) => name).join(' '))} ;;
  esac
  [[ -n $words ]] && COMPREPLY=($(compgen -W "$words" -- "$word"))
}
complete -o default -F _cagecast cagecast
`;
}

function zsh(commands: readonly Known[]): string {
  const escaped = (text: string) => text.replace(/[[\]:\\]/g, '\\$&');
  const spec = (option: Option): string[] => {
    const action = option.argChoices ? `:value:(${option.argChoices.join(' ')})` : ':value:_files';
    const value = option.required || option.optional ? action : '';
    return flagsOf(option).map((flag) => quoted(`*${flag}[${escaped(option.description)}]${value}`));
  };
  const cases = commands.map(({ name, options }) =>
    [
      `    ${name}) _arguments \\`,
      ...options.flatMap(spec).map((one) => `      ${one} \\`),
      "      '*:file:_files' ;;",
    ].join('\n'),
  );
  return `#compdef cagecast
# Completion of cagecast for zsh. In ~/.zshrc, after compinit: source <(cagecast completion zsh)
_cagecast() {
  local -a commands=(
${commands.map(({ name, description }) => `    ${quoted(`${name}:${escaped(description)}`)}`).join('\n')}
    'help:print help for a command'
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
${cases.join('\n')}
    help) _describe command commands ;;
  esac
}
compdef _cagecast cagecast
`;
}

function fish(commands: readonly Known[]): string {
  const lines = commands.flatMap(({ name, description, options }) => [
    `complete -c cagecast -n __fish_use_subcommand -f -a ${name} -d ${quoted(description)}`,
    ...options.map(({ short, long, description: text, argChoices, required, optional }) =>
      [
        `complete -c cagecast -n '__fish_seen_subcommand_from ${name}'`,
        ...(short ? [`-s ${short.slice(1)}`] : []),
        ...(long ? [`-l ${long.slice(2)}`] : []),
        ...(argChoices ? [`-x -a ${quoted(argChoices.join(' '))}`] : required || optional ? ['-r'] : []),
        `-d ${quoted(text)}`,
      ].join(' '),
    ),
  ]);
  return `# Completion of cagecast for fish: cagecast completion fish > ~/.config/fish/completions/cagecast.fish
${lines.join('\n')}
`;
}

/** Adds the command that prints a script of completion. */
export function addCompletionCommand(program: Command): void {
  program
    .command('completion')
    .argument('<SHELL>', `one of ${shells.join(', ')}`, (text: string): Shell => {
      const shell = shells.find((one) => one === text);
      if (shell === undefined) throw new InvalidArgumentError(`There are: ${shells.join(', ')}.`);
      return shell;
    })
    .allowExcessArguments(false)
    .description('print a script by which a shell completes commands and flags')
    .addHelpText(
      'after',
      `
bash, in ~/.bashrc:                source <(cagecast completion bash)
zsh, in ~/.zshrc after compinit:   source <(cagecast completion zsh)
fish:                              cagecast completion fish > ~/.config/fish/completions/cagecast.fish`,
    )
    .action((shell: Shell) => {
      writeStandard(completion(program, shell));
    });
}
