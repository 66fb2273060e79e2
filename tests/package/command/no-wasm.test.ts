// A host on which no WebAssembly starts, as its address space is limited: what does not need it works, all else is one clear error.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { cagecastProcess, ok } from '../../support/command.js';
import { inRepository, workplace } from './workplace.js';

workplace('no-wasm');
const options = { skip: process.platform !== 'linux' && 'address space can be limited on Linux only' };

/** KiB: enough for Node and its threads, but not for a module of WebAssembly, for which it sets aside 10 GB. */
const kAddresses = 4_000_000;
const by = ['sh', '-c', `ulimit -v ${kAddresses}; exec "$@"`, 'sh'];
const reason =
  /this host cannot run the WebAssembly\b.* \(RangeError: [^()]*\(\): Out of memory: .*\); .* raise ulimit -v/;

const models = 'target.glb --cage cage.glb';
/** The commands, and whether they need WebAssembly. */
const commands: Record<string, { args: string; works?: true }> = {
  transfer: { args: `${models} -o out.glb` },
  inspect: { args: models },
  bake: { args: 'target.glb --cage cage.glb --texture paint.png -o out.glb' },
  relay: { args: 'target.glb --cage cage.glb --texture paint.png --to cage.glb -o out.png' },
  make: { args: 'target.glb -o out.glb' },
  fit: { args: 'target.glb --template human-head -o out.glb' },
  batch: { args: `${models} --quiet` },
  diff: { args: 'report.json report.json', works: true },
  thumbnail: { args: 'target.glb -o out.png', works: true },
  help: { args: 'transfer', works: true },
};

before(async () => {
  for (const form of ['meshopt', 'draco']) await ok(`transfer ${models} --compress ${form} -o ${form}.glb`);
  writeFileSync('report.json', await ok(`inspect ${models} --json`));
});

const run = (args: string) => cagecastProcess(args.split(' ').filter(Boolean), { by });

test('every command says so in one line, or does not need it', options, () => {
  const listed = [
    ...run('--help')
      .stdout.toString()
      .matchAll(/^ {2}([a-z]+)(?: \[| <)/gm),
  ].map(([, name]) => name);
  assert.deepEqual(Object.keys(commands).sort(), listed.sort());
  for (const [name, { args, works }] of Object.entries(commands)) {
    const { status, stderr } = run(`${name} ${args}`);
    if (works) assert.deepEqual([status, stderr], [0, ''], name);
    else {
      assert.equal(status, 1, name);
      assert.match(stderr, new RegExp(`^cagecast: .*${reason.source}\n$`), name);
    }
  }
});

test('what needs no command works, and wrong usage is told as ever', options, () => {
  for (const [args, expected] of [
    ['--version', 0],
    ['--help', 0],
    ['', 2],
    ['nonsense', 2],
    ['transfer', 2],
  ] as const) {
    const { status, stderr } = run(args);
    assert.equal(status, expected, args);
    assert.doesNotMatch(stderr, /RangeError|WebAssembly|^ +at /m, args);
  }
});

test('files that are compressed need a decoder', options, () => {
  for (const form of ['meshopt', 'draco']) {
    const { status, stderr } = run(`thumbnail ${form}.glb -o out.png`);
    assert.equal(status, 1, form);
    assert.match(stderr, new RegExp(`^cagecast: .*${reason.source}\n$`, ''), form);
  }
});

test('each entry of the package can be imported, and what needs it is rejected as unsupported', options, () => {
  const { exports } = JSON.parse(readFileSync(inRepository('package.json'), 'utf8')) as {
    exports: Record<string, string | { default: string }>;
  };
  const entries = Object.values(exports)
    .flatMap((entry) => (typeof entry === 'string' ? [] : entry.default))
    .filter((path) => path.endsWith('.js'));
  assert.equal(entries.length, 10);
  const addresses = entries.map((path) => [path, pathToFileURL(inRepository(path)).href]);
  const script = `
    import { readFileSync } from 'node:fs';
    import { setTimeout } from 'node:timers/promises';
    const entries = {};
    for (const [path, address] of ${JSON.stringify(addresses)}) entries[path] = await import(address);
    await setTimeout(300); // for promises that nobody awaits to be rejected
    const [index, slim, cages, gltf, worker] =
      ['index', 'slim', 'cages', 'gltf', 'worker'].map((name) => entries['./dist/' + name + '.js']);
    const bytes = (name) => new Uint8Array(readFileSync(name));
    const mesh = { positions: new Float32Array(9), indices: new Uint32Array([0, 1, 2]) };
    const calls = {
      index: () => index.init(),
      slim: () => slim.init(),
      here: () => cages.makeCage(mesh, { worker: false }),
      cages: () => cages.makeCage(mesh),
      worker: () => worker.init(),
      paint: () => gltf.paintGlb(bytes('target.glb'), { cage: bytes('cage.glb'), texture: bytes('paint.png') }),
      meshopt: () => gltf.thumbnail(bytes('meshopt.glb')),
    };
    for (const [name, call] of Object.entries(calls)) {
      const error = await call().then(() => 'works', (error) => error);
      console.log(name, error.code, error.message ?? error);
    }
    process.exit();`;
  writeFileSync('entries.mjs', script);
  const { status, stdout, stderr } = cagecastProcess([], {
    by: [...by, process.execPath, '--no-deprecation', 'entries.mjs'],
  });
  assert.deepEqual([status, stderr], [0, ''], stdout.toString());
  const lines = stdout.toString().trimEnd().split('\n');
  for (const line of lines) assert.match(line, new RegExp(`^\\w+ unsupported .*${reason.source}$`));
  assert.equal(lines.length, 7);
});
