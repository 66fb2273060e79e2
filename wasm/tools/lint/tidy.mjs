// Runs clang-tidy (.clang-tidy) over the core, one process for each core of the machine. A file that passed is not looked at
// again until it, a header that it includes, or the settings change: build/lint/tidy.json remembers.
import { execFile, execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { availableParallelism } from 'node:os';
import { dirname, join, normalize } from 'node:path';

const kIncludeFolders = ['core/src', 'core/include', 'core/cages', 'core'];
const kInclude = /^\s*#\s*include\s+["<]([^">]+)[">]/gm;

/** The file and all headers of the project that it includes, directly or not. */
function withHeaders(root, file, found = new Set()) {
  if (found.has(file)) return found;
  found.add(file);
  for (const [, text] of readFileSync(join(root, file), 'utf8').matchAll(kInclude)) {
    const header = [dirname(file), ...kIncludeFolders]
      .map((folder) => normalize(join(folder, text)))
      .find((path) => existsSync(join(root, path)));
    if (header) withHeaders(root, header, found);
  }
  return found;
}

function fingerprint(root, file, settings) {
  const sum = createHash('sha256').update(settings);
  for (const path of withHeaders(root, file)) sum.update(path).update(readFileSync(join(root, path)));
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
 * @param {string[]} files  Paths from there.
 * @return {Promise<string[]>}  What clang-tidy says, each finding once.
 */
export async function checkTidy(root, files) {
  const build = join(root, 'build/release');
  execFileSync('cmake', ['--preset', 'release', '-Wno-dev', '--log-level=WARNING'], { cwd: root, stdio: 'ignore' });
  const commands = JSON.parse(readFileSync(join(build, 'compile_commands.json'), 'utf8'));
  const compiled = new Set(commands.map((command) => command.file));
  const memory = join(root, 'build/lint/tidy.json');
  const passed = existsSync(memory) ? JSON.parse(readFileSync(memory, 'utf8')) : {};
  const settings = readFileSync(join(root, '.clang-tidy'), 'utf8') + execFileSync('clang-tidy', ['--version']);
  const waiting = files
    .filter((file) => /^core\/.*\.cpp$/.test(file) && compiled.has(join(root, file)))
    .map((file) => ({ file, mark: fingerprint(root, file, settings) }))
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
