// Gives the avatars of avatars.json to every door and judges what comes out: README.md.

import { spawnSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { parseArgs } from 'node:util';
import { root } from '../native.js';
import { percent } from '../percent.js';
import { table } from '../table.js';
import type { Row } from './door.js';
import { type Avatar, avatars, type Door, kDoors } from './labels.js';

/** How far holes of a face that is right may be off, in distances from eyes to mouth. */
const kRight = 0.2;
/** After how many seconds a process is ended. */
const kTimeout = 300;

type Rows = Record<string, Partial<Record<Door, Row>>>;

/** Why a file cannot be used. */
function faultOf(path: string, { sha256 }: Avatar): string | undefined {
  if (!existsSync(path)) return 'is absent';
  const found = createHash('sha256').update(readFileSync(path)).digest('hex');
  return found === sha256 ? undefined : `is another file: its SHA-256 is ${found}, not ${sha256}`;
}

function through(path: string, door: Door, to: string, avatar: Avatar, isMarked = false): Row {
  const script = join(root, 'bench/avatars/door.ts');
  const args = ['--import', 'tsx', script, path, door, to, JSON.stringify(avatar), ...(isMarked ? ['marked'] : [])];
  // By a file, as what the process started may hold a pipe open after its end.
  rmSync(`${to}.json`, { force: true });
  const { signal, status } = spawnSync(process.execPath, args, {
    timeout: 1000 * kTimeout,
    killSignal: 'SIGKILL',
    cwd: root,
    stdio: 'ignore',
  });
  if (existsSync(`${to}.json`)) return JSON.parse(readFileSync(`${to}.json`, 'utf8')) as Row;
  return { failed: signal ? `ended by ${signal} (after at most ${kTimeout} s)` : `crashed with exit code ${status}` };
}

const isRight = ({ face, verdict, failed }: Row): boolean =>
  !failed && (face ?? Infinity) <= kRight && verdict !== 'unfit';

/** How many faces are right, for each half and door. */
function sumsOf(all: readonly Avatar[], rows: Rows): string {
  const lines = (['open', 'held'] as const).map((half) => {
    const faces = all.filter((avatar) => avatar.half === half && avatar.face && rows[avatar.file]);
    const right = (door: Door): string =>
      `${faces.filter(({ file }) => isRight(rows[file]?.[door] ?? {})).length} of ${faces.length}`;
    return [half, ...kDoors.map(right)];
  });
  return table(['Faces right', ...kDoors], lines);
}

/** How many of each door, and of each verdict, ship by eye, of those that were looked at. */
function verdictsOf(all: readonly Avatar[], rows: Rows): string {
  const seen = all.flatMap(({ file, ships }) =>
    kDoors.flatMap((door) => {
      const { verdict, template } = rows[file]?.[door] ?? {};
      const same = template === undefined ? door : template === 'made' ? 'make' : (`fit ${template}` as Door);
      return ships && verdict ? [{ door, verdict, isShipped: ships.includes(same) }] : [];
    }),
  );
  const shipped = kDoors.map((door) => {
    const own = seen.filter((one) => one.door === door);
    return `${own.filter(({ isShipped }) => isShipped).length} of ${own.length}`;
  });
  const count = (verdict: string, isShipped: boolean): string =>
    `${seen.filter((one) => one.verdict === verdict && one.isShipped === isShipped).length}`;
  const lines = ['good', 'usable', 'unfit'].map((verdict) => [verdict, count(verdict, true), count(verdict, false)]);
  return `${table(['Ships by eye', ...kDoors], [['', ...shipped]])}\n${table(['Verdict', 'Ships', 'Does not'], lines)}`;
}

/** @param half  The half whose avatars are shown one by one. */
function linesOf(all: readonly Avatar[], rows: Rows, half: string): string {
  const number = (value: number | null | undefined, digits: number): string => value?.toFixed(digits) ?? '–';
  const share = (value: number | null | undefined): string => percent(value ?? NaN);
  const lines = all
    .filter((avatar) => avatar.half === half)
    .flatMap(({ file }) =>
      Object.entries(rows[file] ?? {}).map(([door, row]) => [
        ...[file, door, row.verdict ?? '–', number(row.face, 2), isRight(row) ? 'right' : ''],
        ...[share(row.bare), share(row.eyes), share(row.clothes), number(row.seconds, 1), row.failed ?? ''],
      ]),
    );
  const head = [
    'File',
    'Door',
    'Verdict',
    'Face',
    '',
    'Bare face',
    'Painted eyes',
    'Painted clothes',
    'CPU s',
    'Failed',
  ];
  return table(head, lines);
}

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    only: { type: 'string' },
    door: { type: 'string' },
    output: { type: 'string' },
    half: { type: 'string', default: 'open' },
    marked: { type: 'boolean', default: false },
  },
});
const here = process.env['INIT_CWD'] ?? process.cwd();
const [folder, output] = [resolve(here, positionals[0] ?? '.'), resolve(here, values.output ?? 'build/avatars')];
const wanted = values.only?.split(',');
const all = avatars().filter(({ file }) => !wanted || wanted.some((name) => file.startsWith(name)));
mkdirSync(output, { recursive: true });
const rows: Rows = {};
for (const avatar of all) {
  const path = join(folder, avatar.file);
  const fault = faultOf(path, avatar);
  if (fault) {
    console.error(`${avatar.file} ${fault}`);
    process.exitCode = 1;
    continue;
  }
  rows[avatar.file] = {};
  for (const door of kDoors.filter((one) => one.includes(values.door ?? ''))) {
    const to = join(output, `${avatar.file.replace(/\.\w+$/, '')}.${door.split(' ').at(-1)}`);
    rows[avatar.file]![door] = through(path, door, to, avatar, values.marked);
    console.error(
      `${avatar.file} ${door}${avatar.half === values.half ? `: ${JSON.stringify(rows[avatar.file]![door])}` : ''}`,
    );
  }
  writeFileSync(join(output, 'rows.json'), `${JSON.stringify(rows, null, 1)}\n`);
}
const text = `${sumsOf(all, rows)}\n${verdictsOf(all, rows)}\n${linesOf(all, rows, values.half)}`;
writeFileSync(join(output, 'table.md'), text);
console.log(text);
