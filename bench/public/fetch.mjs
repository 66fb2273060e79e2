// Downloads openly licensed models and makes cages for them: README.md.
//
//   node bench/public/fetch.mjs --list
//   node bench/public/fetch.mjs NAME … [--to FOLDER] [--models LIST.json]

import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import {
  chmodSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readFileSync,
  renameSync,
  rmSync,
  writeFileSync,
} from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const root = fileURLToPath(new URL('../..', import.meta.url));
const program = join(root, 'dist/cli.js');

/** Downloads a file. @throws {Error} if it does not come, or is another. */
async function download({ url, sha256 }) {
  const response = await fetch(url).catch((error) => {
    throw new Error(`cannot be reached at ${url}: ${error.cause?.code ?? error.cause?.message ?? error.message}`);
  });
  if (!response.ok) throw new Error(`is not at ${url}: the server answers ${response.status}`);
  const bytes = Buffer.from(await response.arrayBuffer());
  if (bytes.toString('latin1', 0, 4) !== 'glTF') throw new Error(`is no GLB at ${url}`);
  const found = createHash('sha256').update(bytes).digest('hex');
  if (sha256 && found !== sha256)
    throw new Error(`is another file than expected at ${url}: its SHA-256 is ${found}, not ${sha256}`);
  return { bytes, found };
}

/** Puts a model into a folder, whole or not at all. @throws {Error} */
async function fetchModel(model, to) {
  const { name, title, author, licence, page, url, sha256, labels, cage } = model;
  const home = join(to, name);
  if (existsSync(home)) return `is in ${home} already`;
  const { bytes, found } = await download(model);
  mkdirSync(to, { recursive: true });
  const part = mkdtempSync(join(to, '.part-'));
  try {
    const at = (file) => join(part, file);
    writeFileSync(at('target.glb'), bytes);
    writeFileSync(at('labels.json'), `${JSON.stringify(labels, null, 2)}\n`);
    writeFileSync(
      at('LICENCE.txt'),
      `${title}\nby ${author}\nLicence: ${licence}\n${page}\n${url}\nSHA-256: ${found}\n`,
    );
    const [command, template] = cage.split(' ');
    // What must not be painted is what the author of a cage would leave holes over.
    const holes = template ? [] : labels.ncz.flatMap((pattern) => ['--exclude', pattern]);
    const args = [
      command,
      at('target.glb'),
      ...(template ? ['--template', template] : []),
      ...holes,
      '-o',
      at('cage.glb'),
      '--quiet',
    ];
    try {
      execFileSync(process.execPath, [program, ...args], { encoding: 'utf8', stdio: ['ignore', 'ignore', 'pipe'] });
    } catch (error) {
      throw new Error(`gets no cage by ${cage}: ${error.stderr?.trim() || error.message}`);
    }
    chmodSync(part, 0o755); // a temporary folder is its owner's alone
    renameSync(part, home);
  } finally {
    rmSync(part, { recursive: true, force: true });
  }
  return `is in ${home}${sha256 ? '' : `; its SHA-256, which the list does not know, is ${found}`}`;
}

function readOptions() {
  try {
    return parseArgs({
      allowPositionals: true,
      options: { list: { type: 'boolean' }, to: { type: 'string' }, models: { type: 'string' } },
    });
  } catch (error) {
    console.error(error.message);
    process.exit(2);
  }
}

const { values, positionals } = readOptions();
const { models } = JSON.parse(readFileSync(values.models ?? new URL('models.json', import.meta.url), 'utf8'));
if (values.list || positionals.length === 0)
  for (const { name, title, author, licence } of models)
    console.log(`${name.padEnd(16)}${title}, by ${author}, ${licence}`);
else if (!existsSync(program)) {
  console.error('The package makes the cages: npm run build, then this again.');
  process.exitCode = 2;
}
for (const name of process.exitCode ? [] : positionals) {
  const model = models.find((one) => one.name === name);
  try {
    if (!model) throw new Error(`is not in the list, which has ${models.map((one) => one.name).join(', ')}`);
    console.log(`${name} ${await fetchModel(model, values.to ?? join(root, 'build/bench/models'))}`);
  } catch (error) {
    console.error(`${name} ${error.message}`);
    process.exitCode = 1;
  }
}
