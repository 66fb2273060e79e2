// Runs clang-tidy (.clang-tidy) over the core, one process for each core of the machine. Where files can be compiled as one
// (CMake's unity build) they are looked at as one, as most of the time goes into headers. What passed is not looked at again
// until it, a header that it includes, or the settings change: build/lint/tidy.json remembers.
import { execFile, execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { dirname, isAbsolute, join, normalize, relative } from 'node:path';

const kIncludeFolders = ['core/src', 'core/include', 'core/cages', 'core'];
const kInclude = /^\s*#\s*include\s+["<]([^">]+)[">]/gm;

/** The file and all others of the project that it includes, directly or not. */
function withIncluded(root, file, found = new Set()) {
  if (found.has(file)) return found;
  found.add(file);
  for (const [, text] of readFileSync(join(root, file), 'utf8').matchAll(kInclude)) {
    const included = isAbsolute(text) // In a unity build.
      ? relative(root, text)
      : [dirname(file), ...kIncludeFolders]
          .map((folder) => normalize(join(folder, text)))
          .find((path) => existsSync(join(root, path)));
    if (included) withIncluded(root, included, found);
  }
  return found;
}

function fingerprint(root, file, rules) {
  const sum = createHash('sha256').update(rules);
  for (const path of withIncluded(root, file)) sum.update(path).update(readFileSync(join(root, path)));
  return sum.digest('hex');
}

function tidy(root, build, file) {
  const args = ['-p', build, '--quiet', '--extra-arg=-Wno-unknown-warning-option', file];
  return new Promise((resolve) => {
    execFile('clang-tidy', args, { cwd: root, maxBuffer: 1 << 26 }, (error, stdout) =>
      resolve(error ? stdout.trim() || error.message : ''),
    );
  });
}

/**
 * @param {string} root  The repository.
 * @return {Promise<string[]>}  What clang-tidy says, each finding once.
 */
export async function checkTidy(root) {
  const build = join(root, 'build/lint');
  const settings = ['-Wno-dev', '--log-level=WARNING', '-DCAGECAST_TESTS=OFF', '-DCAGECAST_BENCH=OFF'];
  execFileSync('cmake', ['--preset', 'release', '-B', build, ...settings], { cwd: root });
  const commands = JSON.parse(readFileSync(join(build, 'compile_commands.json'), 'utf8'));
  const memory = join(root, 'build/lint/tidy.json');
  const passed = existsSync(memory) ? JSON.parse(readFileSync(memory, 'utf8')) : {};
  const rules = readFileSync(join(root, '.clang-tidy'), 'utf8') + execFileSync('clang-tidy', ['--version']);
  const waiting = commands
    .map((command) => relative(root, command.file))
    .filter((file) => /^(core|build\/lint\/core)\//.test(file))
    .map((file) => ({ file, mark: fingerprint(root, file, rules) }))
    .filter(({ file, mark }) => passed[file] !== mark);
  const findings = new Set();
  const work = async () => {
    for (let next = waiting.pop(); next; next = waiting.pop()) {
      const output = await tidy(root, build, next.file);
      if (output === '') passed[next.file] = next.mark;
      // A header's findings come with every file that includes it.
      for (const [line] of output.matchAll(/^\S+: (?:error|warning): .*$/gm))
        findings.add(line.replace(`${root}/`, ''));
      if (output !== '' && findings.size === 0) findings.add(output);
    }
  };
  await Promise.all(Array.from({ length: availableParallelism() }, work));
  mkdirSync(dirname(memory), { recursive: true });
  writeFileSync(memory, JSON.stringify(passed, null, 1));
  return [...findings].sort();
}
