// The command as a process: pipes, devices, signals, exit codes, and what the system refuses.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { chmodSync, cpSync, existsSync, mkdirSync, mkdtempSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { cagecastProcess, kProgram, ok } from '../../support/command.js';
import { glbOf } from '../../support/gltf.js';
import { workplace, write } from './workplace.js';

const { target } = workplace('process');
const glb = readFileSync('target.glb');
const transfer = ['transfer', 'target.glb', '--cage', 'cage.glb'];
write('far.glb', glbOf({ ...target, positions: target.positions.map((x) => x + 9) }));

/** Runs the command by a script of bash, in which "$@" is the command. */
const shell = (script: string, ...args: string[]) => {
  const { status, stdout, stderr } = cagecastProcess(args, { by: ['bash', '-c', script, 'bash'] });
  return { status, stdout: stdout.toString(), stderr };
};

test('exit codes are those of the process', () => {
  for (const [args, status] of [
    [['--version'], 0],
    [['transfer'], 2],
  ] as const)
    assert.equal(cagecastProcess(args).status, status, args.join(' '));
});

test('- is the standard input and output; the summary goes beside it', async () => {
  await ok('transfer target.glb --cage cage.glb -o named.glb');
  const piped = cagecastProcess(['transfer', '-', '--cage', 'cage.glb', '-o', '-'], { input: glb });
  assert.equal(piped.status, 0, piped.stderr);
  assert.deepEqual(piped.stdout, readFileSync('named.glb'));
  assert.match(piped.stderr, /^-: [\d,]+ vertices/);
  const empty = cagecastProcess(['inspect', '-', '--cage', 'cage.glb'], { input: Buffer.alloc(0) });
  assert.deepEqual([empty.status, empty.stderr], [1, 'cagecast: -: the file is empty\n']);
  const line = `{"target": "target.glb", "cage": "cage.glb", "output": "of-line.glb"}`;
  const batch = cagecastProcess(['batch', '--manifest', '-'], { input: Buffer.from(line) });
  assert.match(batch.stdout.toString(), /"status":"done"/);
  assert.deepEqual(readFileSync('of-line.glb'), readFileSync('named.glb'));
});

test('a standard output that does not take all of it is one line and exit code 1', {
  skip: !existsSync('/dev/full') && 'there is no such device',
}, () => {
  const line = (reason: string) => `cagecast: the standard output: cannot be written (${reason}, write)\n`;
  for (const args of [[...transfer, '-o', '-'], ['help']]) {
    const full = shell('"$@" > /dev/full', ...args);
    assert.deepEqual([full.status, full.stderr], [1, line('ENOSPC: no space left on device')], args.join(' '));
  }
  const cut = shell('ulimit -f 1; "$@" > cut', ...transfer, '-o', '-'); // takes the first bytes
  assert.deepEqual([cut.status, cut.stderr], [1, line('EFBIG: file too large')]);
  assert.equal(shell('"$@" > /dev/full', 'batch', 'target.glb', '--cage', 'cage.glb').status, 1);
  assert.equal(shell('"$@" > /dev/full', ...transfer, '-o', '-', '--report', 'beside.json').status, 1);
  assert.ok(!existsSync('beside.json'), 'all files are written, or none');
});

test('a descriptor and a pipe are written to, not replaced', { skip: !existsSync('/proc/self/fd') }, () => {
  for (const [redirection, path] of [
    ['', '/dev/stdout'],
    ['3', '/dev/fd/3'],
    ['4', '/proc/self/fd/4'],
  ] as const) {
    write('log', 'before\n');
    shell(`"$@" ${redirection}>> log`, ...transfer, '--quiet', '--report', path);
    const text = readFileSync('log', 'utf8');
    assert.ok(text.startsWith('before\n{'), `${path}: ${text.slice(0, 20)}`);
    assert.ok((JSON.parse(text.slice(7)) as { counts: object }).counts, path);
  }
  const script = 'mkfifo pipe && { cat pipe > copy.json & "$@" && test -p pipe && wait; }';
  const { status, stderr } = shell(script, ...transfer, '--report', 'pipe');
  assert.equal(status, 0, stderr);
  assert.equal((JSON.parse(readFileSync('copy.json', 'utf8')) as { parts: object[] }).parts.length, 1);
});

test('a reader that closes the pipe early changes neither the exit code nor what is written', () => {
  const { status, stderr } = shell('set -o pipefail; "$@" | true', 'inspect', 'far.glb', '--cage', 'cage.glb');
  assert.deepEqual([status, stderr], [3, '']);
  const batch = ['batch', 'target.glb', 'far.glb', '--cage', 'cage.glb', '-o', 'read-{name}.glb', '--workers', '1'];
  assert.equal(shell('set -o pipefail; "$@" | true', ...batch).status, 0);
  assert.deepEqual(
    readdirSync('.')
      .filter((name) => name.startsWith('read-'))
      .sort(),
    ['read-far.glb', 'read-target.glb'],
  );
});

test('a glTF gets its name after what it has beside it', () => {
  write(
    'stop.mjs',
    `import fs from 'node:fs';
    import { syncBuiltinESMExports } from 'node:module';
    const { renameSync } = fs;
    fs.renameSync = (...paths) => {
      renameSync(...paths);
      process.kill(process.pid, 'SIGKILL');
    };
    syncBuiltinESMExports();`,
  );
  mkdirSync('killed');
  const node = ['--import', pathToFileURL('stop.mjs').href];
  cagecastProcess([...transfer, '-o', 'killed/head.gltf'], { node });
  assert.deepEqual(
    readdirSync('killed').filter((name) => !name.endsWith('.tmp')),
    ['head.bin'],
  );
});

test('files that vanish or shrink while they are read are plain errors', () => {
  const happens = (what: string) =>
    write(
      'happens.mjs',
      `import fs from 'node:fs';
      import { syncBuiltinESMExports } from 'node:module';
      const { open } = fs.promises;
      fs.promises.open = async (path, ...how) => {
        if (!String(path).includes('short-lived')) return open(path, ...how);
        ${what}
      };
      syncBuiltinESMExports();`,
    );
  const gone = 'fs.rmSync(path, { force: true }); return open(path, ...how);';
  const gonePart = 'const file = await open(path, ...how); fs.rmSync(path, { force: true }); return file;';
  const shrinks =
    'const file = await open(path, ...how); const { stat } = file; file.stat = async () => { const found = await stat.call(file); fs.truncateSync(path, 100); return found; }; return file;';
  const noFolder = 'fs.rmSync("folder", { recursive: true, force: true }); return open(path, ...how);';
  const node = ['--import', pathToFileURL('happens.mjs').href];
  for (const [what, says] of [
    [gone, /short-lived\.glb: no such file/],
    [gonePart, undefined], // it is open already
    [shrinks, /short-lived\.glb: is truncated|short-lived\.glb: .*100 bytes/],
    [noFolder, /short-lived\.glb: no such file/],
  ] as const) {
    mkdirSync('folder', { recursive: true });
    write('folder/short-lived.glb', glb);
    happens(what);
    const single = cagecastProcess(['inspect', 'folder/short-lived.glb', '--cage', 'cage.glb'], { node });
    assert.equal(single.status, says ? 1 : 0, single.stderr);
    if (says) assert.match(single.stderr, says);
    assert.doesNotMatch(single.stderr, /unexpectedly/);
  }
});

test('a template and a file of another user are found and refused', (context) => {
  const closed = mkdtempSync(join(tmpdir(), 'cagecast-closed-'));
  context.after(() => rmSync(closed, { recursive: true }));
  chmodSync(closed, 0o755);
  for (const name of ['a', 'b']) {
    mkdirSync(join(closed, name, 'deep'), { recursive: true });
    cpSync('target.glb', join(closed, name, 'a.glb'));
    write(join(closed, name, 'a.json'), '{}');
  }
  cpSync('cage.glb', join(closed, 'cage.glb'));
  chmodSync(join(closed, 'b/deep'), 0);
  // Root may read everything, so another user is asked.
  const as = process.getuid?.() === 0 ? { uid: 65534 } : {};
  const node = (...args: string[]) => spawnSync(process.execPath, args, { encoding: 'utf8', timeout: 60_000, ...as });
  if (node(kProgram, '--version').status !== 0) return context.skip('another user may not read the package');
  if (node('-e', 'fs.readdirSync(process.argv[1])', join(closed, 'b/deep')).status === 0)
    return context.skip('this system lets everybody read it');
  for (const args of [
    ['batch', join(closed, '**/*.glb'), '--cage', join(closed, 'cage.glb')],
    ['diff', join(closed, 'a'), join(closed, 'b')],
  ]) {
    const { status, stdout, stderr } = node(kProgram, ...args);
    assert.deepEqual([status, stdout], [1, ''], stderr);
    assert.match(stderr, /^cagecast: [^\n]*\/b\/deep: cannot be read: permission denied\n$/);
  }
  const out = join(closed, 'b/out.glb');
  const { status, stderr } = node(kProgram, 'make', join(closed, 'a/a.glb'), '-o', out);
  assert.deepEqual([status, stderr], [1, `cagecast: ${out}: cannot be written (permission denied)\n`]);
});
