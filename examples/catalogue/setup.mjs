// What npm start needs: Redis by apt, the packages of this folder and Cagecast itself, if they are not there yet.
import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('../..', import.meta.url));
const run = (command, ...args) => execFileSync(command, args, { cwd: root, stdio: ['ignore', 'inherit', 'inherit'] });

run(process.execPath, 'wasm/tools/setup.mjs', 'catalogue');
if (!existsSync(`${root}dist/index.js`)) run('npm', 'run', '--silent', 'build');
