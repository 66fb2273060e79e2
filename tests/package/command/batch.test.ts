import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import {
  chmodSync,
  existsSync,
  mkdirSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  symlinkSync,
  writeFileSync,
} from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { PNG } from 'pngjs';
import { cagecast, glbOf, packGlb, unpackGlb } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { head } from '../scenes.js';

const { at } = temporaryFolder('batch');
const scene = head(6, 8);
const target = glbOf({ ...scene.target, groups: undefined });

interface Line {
  target: string;
  output: string | null;
  key: string;
  status: 'done' | 'failed' | 'skipped';
  error?: string;
  verdict?: string;
  counts?: object;
}

const linesOf = (text: string): Line[] =>
  text
    .split('\n')
    .filter(Boolean)
    .map((line) => JSON.parse(line) as Line);

before(() => {
  for (const name of ['in', 'in/deep', 'out']) mkdirSync(at(name));
  writeFileSync(at('in/0.glb'), target);
  writeFileSync(at('cage.glb'), glbOf(scene.cage));
  writeFileSync(at('away.glb'), glbOf({ ...scene.cage, positions: scene.cage.positions.map((x) => x + 9) }));
});

test('200 jobs, five of them broken, killed in the middle and resumed: every good job once, nothing half-written', async () => {
  const broken = [3, 40, 77, 120, 199];
  for (let i = 0; i < 200; ++i)
    writeFileSync(at('in', `${i}.glb`), broken.includes(i) ? target.subarray(0, target.length / 2) : target);
  const results = at('results.jsonl');
  const args = ['batch', at('in/*.glb'), '--cage', at('cage.glb'), '-o', at('out/{name}.glb'), '--results', results];
  const first = spawn(process.execPath, ['dist/cli.js', ...args, '--workers', '2'], { stdio: 'ignore' });
  const written = () => (existsSync(results) ? readFileSync(results, 'utf8').split('\n').length - 1 : 0);
  const ended = once(first, 'exit');
  while (written() < 30 && first.exitCode === null && first.signalCode === null)
    await new Promise((resolve) => setTimeout(resolve, 5));
  first.kill('SIGKILL');
  await ended;
  const doneBefore = linesOf(readFileSync(results, 'utf8').replace(/[^\n]*$/, '')).length;
  assert.ok(doneBefore < 190, `${doneBefore} jobs were done before it was killed`);
  writeFileSync(results, '{"target":"cut o', { flag: 'a' }); // as if killed within a line

  const { status, stdout, stderr } = cagecast(...args, '--resume');
  assert.equal(status, 1);
  assert.equal(stdout, '');
  assert.match(stderr, /^200 jobs: \d+ done, 5 failed, \d+ done before; [\d.]+ s\n$/);
  const lines = readFileSync(results, 'utf8')
    .split('\n')
    .filter((line) => line.endsWith('}'))
    .map((line) => JSON.parse(line) as Line);
  const done = lines.filter((line) => line.status === 'done').map((line) => line.target);
  assert.equal(new Set(done).size, 195);
  assert.equal(done.length, 195);
  const failed = new Set(lines.filter((line) => line.status === 'failed').map((line) => line.target));
  assert.deepEqual([...failed].sort(), broken.map((i) => at('in', `${i}.glb`)).sort());
  assert.ok(lines.every((line) => line.status === 'done' || /: is truncated/.test(line.error!)));
  const files = readdirSync(at('out'));
  assert.equal(files.length, 195, 'no file under a temporary name is left');
  for (const name of files) {
    const bytes = readFileSync(at('out', name));
    assert.equal(bytes.readUInt32LE(8), bytes.length, name);
  }

  // What has changed is done again, and nothing else.
  writeFileSync(at('in/5.glb'), target);
  rmSync(at('out/6.glb'));
  const again = cagecast(...args, '--resume', '--json');
  const { seconds: _, ...summary } = JSON.parse(again.stderr) as { seconds: number };
  assert.deepEqual(summary, { jobs: 200, done: 2, failed: 5, skipped: 193, misfits: 0, configs: [] });
});

test('patterns reach into folders, lines are printed, and --fail-on exits 3', () => {
  writeFileSync(at('in/deep/a.glb'), target);
  writeFileSync(at('in/deep/.hidden.glb'), target);
  const found = cagecast('batch', at('**/deep/*.glb'), '--cage', at('cage.glb'), '--fail-on', 'unfit', '--quiet');
  assert.deepEqual([found.status, found.stdout, found.stderr], [0, '', '']);
  const away = cagecast('batch', at('in/deep/a.glb'), '--cage', at('away.glb'), '--fail-on', 'unfit');
  assert.equal(away.status, 3);
  const [line, ...others] = linesOf(away.stdout);
  assert.equal(others.length, 0);
  assert.deepEqual(
    [line!.target, line!.output, line!.status, line!.verdict],
    [at('in/deep/a.glb'), null, 'done', 'unfit'],
  );
  assert.match(away.stderr, /1 with a cage that does not fit as demanded/);
  // A region's cage counts, too.
  writeFileSync(at('paint.png'), PNG.sync.write(new PNG({ width: 4, height: 4 })));
  const region = [
    '--region',
    `${at('away.glb')}=${at('paint.png')}`,
    '--texture',
    at('paint.png'),
    '-o',
    at('out.glb'),
  ];
  const both = cagecast('batch', at('in/0.glb'), '--cage', at('cage.glb'), ...region, '--fail-on', 'unfit');
  assert.deepEqual([both.status, linesOf(both.stdout)[0]!.verdict], [3, 'unfit'], both.stdout);
});

test('borders that a configuration cuts are no matter where nothing is written', () => {
  const config = at('in/cagecast.config.json');
  const check = ['batch', at('in/0.glb'), '--cage', at('cage.glb'), '--fail-on', 'unfit'];
  writeFileSync(config, '{ "borders": "cut" }');
  try {
    assert.equal(cagecast(...check).status, 0);
  } finally {
    rmSync(config);
  }
  const asked = cagecast(...check, '--borders', 'cut');
  assert.deepEqual([asked.status, /--borders cut needs -o OUT\.glb/.test(asked.stderr)], [2, true]);
  writeFileSync(at('checks.jsonl'), JSON.stringify({ target: 'in/0.glb', cage: 'cage.glb' }));
  const lines = cagecast('batch', '--manifest', at('checks.jsonl'), '--borders', 'cut');
  assert.deepEqual([lines.status, /has no output/.test(lines.stdout)], [1, true]);
});

test('a manifest has a job per line, with options of its own; a wrong line is a job that fails', () => {
  const jobs = [
    { target: 'in/0.glb', cage: 'cage.glb', output: 'new/{name}/kept.glb', report: 'kept.json', exclude: ['only'] },
    { target: 'in/0.glb', cage: 'cage.glb', report: 'high.json', threshold: 1 },
    { target: 'in/0.glb', cage: 'cage.glb', treshold: 1 },
    { target: 'in/gone.glb' },
  ];
  writeFileSync(at('jobs.jsonl'), `${jobs.map((job) => JSON.stringify(job)).join('\n')}\nno JSON\n\n`);
  const { status, stdout } = cagecast('batch', '--manifest', at('jobs.jsonl'), '--workers', '1');
  assert.equal(status, 1);
  const lines = linesOf(stdout);
  const errors = lines.flatMap(({ error }) => error ?? []).sort();
  assert.equal(errors.length, 3);
  assert.match(errors[0]!, /^line 3 of .*jobs\.jsonl: "treshold" is unknown; there are: target, cage, /);
  assert.match(errors[1]!, /^line 4 of .*jobs\.jsonl: .*has no cage/);
  assert.match(errors[2]!, /^line 5 of .*jobs\.jsonl: is not JSON/);
  assert.equal(lines.filter((line) => line.status === 'done').length, 2);
  assert.ok(existsSync(at('new/0/kept.glb')), 'folders are made');
  const { counts } = JSON.parse(readFileSync(at('kept.json'), 'utf8')) as { counts: { cosmetic: number } };
  assert.equal(counts.cosmetic, 0);
  const { options } = JSON.parse(readFileSync(at('high.json'), 'utf8')) as { options: { threshold: number } };
  assert.equal(options.threshold, 1);
});

test('a batch that cannot be right does not begin', () => {
  const cage = ['--cage', at('cage.glb')];
  // The second target's buffer is named as what the first job would write beside its output.
  mkdirSync(at('beside'));
  const { json, bin } = unpackGlb(target);
  json.buffers![0]!.uri = '0.bin';
  writeFileSync(at('beside/second.gltf'), JSON.stringify(json));
  writeFileSync(at('beside/0.bin'), bin);
  writeFileSync(at('beside/0.glb'), target);
  const cases: [string[], number, RegExp][] = [
    [['batch'], 2, /give either TARGETS or --manifest/],
    [['batch', at('in/*.glb')], 2, /TARGETS need --cage/],
    [['batch', at('in/*.glb'), '--cage', '-', '-o', at('{name}.glb')], 2, /its jobs have no standard input/],
    [['batch', at('in/*.glb'), '--cage', at('cage.glb'), '--region', '-=p.png'], 2, /its jobs have no standard input/],
    [['batch', at('in/*.glb'), ...cage, '--never-mask', '-'], 2, /its jobs have no standard input/],
    [['batch', at('in/*.glb'), ...cage, '--results', '-'], 2, /the standard output has its lines/],
    [['batch', at('in/*.glb'), ...cage, '--results', at('out')], 1, /out: cannot be written \(is a folder\)/],
    [['batch', at('in/*.glb'), ...cage, '--resume'], 2, /--resume needs --results/],
    [['batch', at('in/*.gltf'), ...cage], 1, /in\/\*\.gltf: no file has such a name/],
    [['batch', at('in/*.glb'), ...cage, '-o', at('same.glb')], 2, /same\.glb: is written for .* and .*; use \{name\}/],
    [['batch', at('in/*.glb'), ...cage, '-o', at('in/{name}.glb')], 2, /: is read and written by this batch/],
    [
      ['batch', at('beside/0.glb'), at('beside/second.gltf'), ...cage, '-o', at('beside/{name}.gltf')],
      2,
      /0\.gltf: is written beside a file of its name that this batch reads/,
    ],
  ];
  // Two outputs that share what is beside them.
  const twins = at('twins.jsonl');
  const jobs = ['gltf', 'GLTF'].map((ending) => ({ target: 'in/0.glb', cage: 'cage.glb', output: `out/e.${ending}` }));
  writeFileSync(twins, jobs.map((job) => JSON.stringify(job)).join('\n'));
  cases.push([['batch', '--manifest', twins], 2, /e\.bin: is written for .* and /]);
  // What the batch itself reads and writes.
  const manifest = at('clash.jsonl');
  const line = `{"target": "beside/0.glb", "cage": "cage.glb"}\n`;
  writeFileSync(manifest, line);
  const config = at('clash.config.json');
  writeFileSync(config, '{}');
  const one = ['batch', at('beside/0.glb'), ...cage];
  cases.push(
    [['batch', '--manifest', manifest, '--report', manifest], 2, /clash\.jsonl: is read and written by this batch/],
    [['batch', '--manifest', manifest, '--results', manifest], 2, /clash\.jsonl: is read by this batch/],
    [[...one, '--results', at('cage.glb')], 2, /cage\.glb: is read by this batch/],
    [[...one, '--config', config, '--report', config], 2, /clash\.config\.json: is read and written by this batch/],
    [[...one, '--results', at('r.json'), '--report', at('r.json')], 2, /r\.json: is written for the results and /],
    [
      [...one, '-o', at('{name}.glb'), '--report', at('{name}.glb')],
      2,
      /\/0\.glb: is both output and report of .*beside\/0\.glb;/,
    ],
    [[...one, '-o', at('{foo}.glb')], 2, /\{foo\} is unknown; paths may hold \{name\} and \{dir\}/],
    [[...one, '--report', at('{name}{stem}.json')], 2, /\{stem\} is unknown/],
    [[...one, '-o', '-'], 2, /the standard output has its lines/],
    [
      [...one, '--texture', 'p.<UDIM>.png', '--uv-bounds', '0,0,1,1', '-o', at('{name}.glb')],
      2,
      /bounds of UVs cannot be given with a texture of <UDIM> tiles/,
    ],
  );
  for (const [args, code, message] of cases) {
    const { status, stdout, stderr } = cagecast(...args);
    assert.deepEqual([status, stdout], [code, ''], args.join(' '));
    assert.match(stderr, message);
    assert.match(stderr, /^cagecast: [^\n]+\n$/);
  }
  assert.equal(readFileSync(manifest, 'utf8'), line);
  assert.equal(readFileSync(config, 'utf8'), '{}');
  assert.deepEqual(readFileSync(at('cage.glb')), Buffer.from(glbOf(scene.cage)));
});

test('a job with a wrong output, or none where it writes something, fails', () => {
  const jobs = [
    { output: 'o.fbx' },
    { output: 'o/{foo}.glb' },
    { report: '{nmae}.json' },
    { texture: 'paint.png' },
    { borders: 'cut' },
    { regions: [{ cage: 'cage.glb', texture: 'paint.png' }] },
  ];
  const lines = jobs.map((job) => JSON.stringify({ target: 'in/0.glb', cage: 'cage.glb', ...job }));
  writeFileSync(at('wrong.jsonl'), lines.join('\n'));
  const { status, stdout } = cagecast('batch', '--manifest', at('wrong.jsonl'));
  assert.equal(status, 1);
  assert.deepEqual(
    linesOf(stdout).map(({ error }) => error?.replace(/^.*0\.glb: /, '').replace(/ \/.*\//, ' ')),
    [
      'its output o.fbx does not end in .glb, .vrm or .gltf',
      'line 2 of wrong.jsonl: {foo} is unknown; paths may hold {name} and {dir}',
      'line 3 of wrong.jsonl: {nmae} is unknown; paths may hold {name} and {dir}',
      ...Array<string>(3).fill('has no output, where its texture or its cut target would be written'),
    ],
  );
});

test('patterns follow links to folders, and ** does not go round in circles', () => {
  mkdirSync(at('linked/own'), { recursive: true });
  mkdirSync(at('far'));
  writeFileSync(at('far/a.glb'), target);
  writeFileSync(at('linked/own/b.glb'), target);
  symlinkSync(at('far'), at('linked/link'));
  symlinkSync(at('linked'), at('linked/own/round'));
  symlinkSync('self', at('linked/self'));
  const targets = (pattern: string) =>
    linesOf(cagecast('batch', at(pattern), '--cage', at('cage.glb')).stdout).map((line) => line.target);
  assert.deepEqual(targets('linked/*/a.glb'), [at('linked/link/a.glb')]);
  assert.deepEqual(targets('linked/**/*.glb'), [at('linked/own/b.glb')]);
  const round = cagecast('batch', at('linked/self/*.glb'), '--cage', at('cage.glb'));
  assert.deepEqual([round.status, round.stdout], [1, '']);
  assert.match(round.stderr, /^cagecast: [^\n]*linked\/self: is a link that leads back to itself\n$/);
});

test('a folder that may not be read is an error that names it, of batch and of diff', (context) => {
  const closed = mkdtempSync(join(tmpdir(), 'cagecast-closed-'));
  context.after(() => rmSync(closed, { recursive: true }));
  chmodSync(closed, 0o755);
  for (const name of ['a', 'b']) {
    mkdirSync(join(closed, name, 'deep'), { recursive: true });
    writeFileSync(join(closed, name, 'a.glb'), target);
    writeFileSync(join(closed, name, 'a.json'), '{}');
  }
  chmodSync(join(closed, 'b/deep'), 0);
  // Root may read everything, so another user is asked.
  const as = process.getuid?.() === 0 ? { uid: 65534 } : {};
  const node = (...args: string[]) => spawnSync(process.execPath, args, { encoding: 'utf8', timeout: 60_000, ...as });
  if (node('dist/cli.js', '--version').status !== 0) return context.skip('another user may not read the package');
  if (node('-e', 'fs.readdirSync(process.argv[1])', join(closed, 'b/deep')).status === 0)
    return context.skip('this system lets everybody read it');
  const calls = [
    ['batch', join(closed, '**/*.glb'), '--cage', at('cage.glb')],
    ['diff', join(closed, 'a'), join(closed, 'b')],
  ];
  for (const args of calls) {
    const { status, stdout, stderr } = node('dist/cli.js', ...args);
    assert.deepEqual([status, stdout], [1, ''], stderr);
    assert.match(stderr, /^cagecast: [^\n]*\/b\/deep: cannot be read: permission denied\n$/);
  }
});

test('a * in the name of a file that is given whole is no pattern', () => {
  writeFileSync(at('sta*r.glb'), target);
  writeFileSync(at('star.glb'), target);
  const args = ['transfer', at('sta*r.glb'), '--cage', at('cage.glb'), '-o', at('star.glb'), '--quiet'];
  assert.deepEqual(cagecast(...args), { status: 0, stdout: '', stderr: '' });
});

test('results that cannot be written end the batch at once; their folder is made', () => {
  mkdirSync(at('some'));
  for (let i = 0; i < 12; ++i) writeFileSync(at('some', `${i}.glb`), target);
  const batch = (results: string, out: string) =>
    spawnSync(
      process.execPath,
      [
        ...['dist/cli.js', 'batch', at('some/*.glb'), '--cage', at('cage.glb'), '--workers', '2'],
        ...['-o', at(out, '{name}.glb'), '--results', results],
      ],
      { encoding: 'utf8', timeout: 60_000 },
    );
  const refused = batch(at('some'), 'refused');
  assert.deepEqual([refused.status, refused.stdout, existsSync(at('refused'))], [1, '', false]);
  assert.match(refused.stderr, /^cagecast: [^\n]*some: cannot be written [^\n]*\n$/);
  if (existsSync('/dev/full')) {
    const full = batch('/dev/full', 'full');
    assert.equal(full.status, 1);
    assert.match(full.stderr, /^cagecast: \/dev\/full: cannot be written [^\n]*\n$/);
    assert.ok(readdirSync(at('full')).length < 9, 'no thread goes on with what is waiting');
  }
  batch(at('made/for/results.jsonl'), 'made');
  assert.equal(linesOf(readFileSync(at('made/for/results.jsonl'), 'utf8')).length, 12);
});

test('--resume does again what another job has overwritten since, and the last line about a target is true', () => {
  const results = at('there-and-back.jsonl');
  const output = at('there-and-back.glb');
  const batch = (...more: string[]) =>
    cagecast(
      'batch',
      at('in/0.glb'),
      '--cage',
      at('cage.glb'),
      '-o',
      output,
      '--results',
      results,
      '--resume',
      ...more,
    );
  const last = () => linesOf(readFileSync(results, 'utf8')).at(-1)!;
  assert.equal(batch().status, 0);
  const first = readFileSync(output);
  batch('--threshold', '1');
  assert.notDeepEqual(readFileSync(output), first);
  assert.match(batch().stderr, /^1 job: 1 done, 0 failed;/);
  assert.deepEqual(readFileSync(output), first);
  assert.match(batch().stderr, /1 done before/);

  // A job that failed, and then is as it was: the file is still its own.
  const config = at('in/cagecast.config.json');
  writeFileSync(config, '{ "treshold": 1 }');
  try {
    assert.equal(batch().status, 1);
    assert.deepEqual([last().status, last().target], ['failed', at('in/0.glb')]);
    assert.match(last().error!, /cagecast\.config\.json: "treshold" is unknown/);
  } finally {
    rmSync(config);
  }
  assert.equal(batch().status, 0);
  assert.deepEqual([last().status, last().target], ['skipped', at('in/0.glb')]);

  // The same job fails, and then its file is there again.
  const inFolder = [
    'batch',
    at('in/0.glb'),
    '--cage',
    at('cage.glb'),
    '-o',
    at('once/{name}.glb'),
    '--results',
    results,
  ];
  assert.equal(cagecast(...inFolder).status, 0);
  renameSync(at('once'), at('twice'));
  writeFileSync(at('once'), '');
  assert.equal(cagecast(...inFolder).status, 1);
  rmSync(at('once'));
  renameSync(at('twice'), at('once'));
  assert.equal(cagecast(...inFolder, '--resume').status, 0);
  assert.equal(last().status, 'skipped');
});

test('--resume adds no line for jobs of the same target that are all done', () => {
  writeFileSync(at('other-cage.glb'), glbOf(scene.cage));
  const jobs = ['cage', 'other-cage'].map((name) =>
    JSON.stringify({ target: 'in/0.glb', cage: `${name}.glb`, output: `${name}-out.glb` }),
  );
  writeFileSync(at('same-target.jsonl'), jobs.join('\n'));
  const results = at('same-target-results.jsonl');
  for (const done of ['2 done', '0 done', '0 done']) {
    const { stderr } = cagecast('batch', '--manifest', at('same-target.jsonl'), '--results', results, '--resume');
    assert.match(stderr, new RegExp(`^2 jobs: ${done}, 0 failed`));
    assert.equal(linesOf(readFileSync(results, 'utf8')).length, 2, done);
  }
});

test('--resume minds what a glTF has beside it, as it is read and as it is written', () => {
  mkdirSync(at('text'));
  for (const [name, bytes] of [
    ['head', target],
    ['cage', glbOf(scene.cage)],
  ] as const) {
    const { json, bin } = unpackGlb(bytes);
    json.buffers![0]!.uri = `${name}%20mesh.bin`;
    writeFileSync(at('text', `${name}.gltf`), JSON.stringify(json));
    writeFileSync(at('text', `${name} mesh.bin`), bin);
  }
  writeFileSync(at('text/wrong.gltf'), '{ "buffers": 1');
  const names = [at('text/head.gltf'), at('text/wrong.gltf')];
  const files = [
    '--cage',
    at('text/cage.gltf'),
    '-o',
    at('text/out/{name}.gltf'),
    '--results',
    at('text/results.jsonl'),
  ];
  const batch = () => cagecast('batch', ...names, ...files, '--resume').stderr.replace(/;.*\n/, '');
  assert.equal(batch(), '2 jobs: 1 done, 1 failed');
  assert.equal(batch(), '2 jobs: 0 done, 1 failed, 1 done before');
  for (const read of ['head mesh.bin', 'cage mesh.bin']) {
    writeFileSync(at('text', read), readFileSync(at('text', read)));
    assert.equal(batch(), '2 jobs: 1 done, 1 failed', read);
  }
  assert.equal(batch(), '2 jobs: 0 done, 1 failed, 1 done before');
  // A GLB may name files, too.
  const { json, bin } = unpackGlb(target);
  json.images = [{ uri: 'skin.png' }];
  writeFileSync(at('text/named.glb'), packGlb({ json, bin }));
  const skin = (red: number) => {
    const png = Object.assign(new PNG({ width: 1, height: 1 }), { data: Buffer.from([red, 0, 0, 255]) });
    writeFileSync(at('text/skin.png'), PNG.sync.write(png));
  };
  skin(1);
  names[1] = at('text/named.glb');
  assert.equal(batch(), '2 jobs: 1 done, 0 failed, 1 done before');
  assert.equal(batch(), '2 jobs: 0 done, 0 failed, 2 done before');
  skin(2);
  assert.equal(batch(), '2 jobs: 1 done, 0 failed, 1 done before');
  rmSync(at('text/out/head.bin'));
  assert.equal(batch(), '2 jobs: 1 done, 0 failed, 1 done before');
  assert.ok(existsSync(at('text/out/head.bin')));
});

test('a glTF gets its name after what it has beside it', () => {
  const stopped = at('stop.mjs');
  writeFileSync(
    stopped,
    `import fs from 'node:fs';
    import { syncBuiltinESMExports } from 'node:module';
    const { renameSync } = fs;
    fs.renameSync = (...paths) => {
      renameSync(...paths);
      process.kill(process.pid, 'SIGKILL');
    };
    syncBuiltinESMExports();`,
  );
  mkdirSync(at('killed'));
  spawnSync(process.execPath, [
    ...['--import', pathToFileURL(stopped).href, 'dist/cli.js', 'transfer', at('in/0.glb')],
    ...['--cage', at('cage.glb'), '-o', at('killed/head.gltf')],
  ]);
  const renamed = readdirSync(at('killed')).filter((name) => !name.endsWith('.tmp'));
  assert.deepEqual(renamed, ['head.bin']);
});

test('a target whose name holds {dir} or $& gives its outputs that very name', () => {
  mkdirSync(at('odd'));
  const names = ['a$$b.glb', 'a$&b.glb', 'a{dir}b.glb', 'a{name}b.glb'];
  for (const name of names) writeFileSync(at('odd', name), target);
  const { stderr } = cagecast(
    'batch',
    at('odd/*.glb'),
    '--cage',
    at('cage.glb'),
    '-o',
    '{dir}/out/{name}.glb',
    '--quiet',
  );
  assert.equal(stderr, '');
  assert.deepEqual(readdirSync(at('odd/out')).sort(), names.sort());
});

test('settings that are wrong fail the jobs that they are for, and no other', () => {
  mkdirSync(at('one'));
  mkdirSync(at('two'));
  for (const name of ['one/a.glb', 'two/b.glb']) writeFileSync(at(name), target);
  writeFileSync(at('two/cagecast.config.json'), '{ "treshold": 1 }');
  const { status, stdout } = cagecast('batch', at('one/a.glb'), at('two/b.glb'), '--cage', at('cage.glb'));
  assert.equal(status, 1);
  const lines = linesOf(stdout).sort((a, b) => a.target.localeCompare(b.target));
  assert.deepEqual(
    lines.map((line) => [line.target, line.status]),
    [
      [at('one/a.glb'), 'done'],
      [at('two/b.glb'), 'failed'],
    ],
  );
  writeFileSync(at('wrong.jsonl'), JSON.stringify({ target: 'one/a.glb', cage: 'cage.glb', treshold: 1 }));
  const [line] = linesOf(cagecast('batch', '--manifest', at('wrong.jsonl')).stdout);
  assert.deepEqual([line!.target, line!.status], [at('one/a.glb'), 'failed']);
  assert.match(line!.error!, /^line 1 of /);
  const quiet = cagecast('batch', at('one/a.glb'), at('two/b.glb'), '--cage', at('cage.glb'), '--quiet');
  assert.deepEqual([quiet.status, quiet.stdout], [1, '']);
  assert.match(quiet.stderr, /^cagecast: [^\n]*two\/cagecast\.config\.json: "treshold" is unknown[^\n]*\n$/);
});

test('an empty path fails its job, which names the member', () => {
  const job = { target: 'in/0.glb', cage: 'cage.glb' };
  const regions = [{ cage: 'cage.glb', texture: '' }];
  const wrong = [{ target: '' }, { cage: '' }, { report: '' }, { neverMask: '' }, { regions }];
  writeFileSync(at('empty.jsonl'), [{}, ...wrong].map((one) => JSON.stringify({ ...job, ...one })).join('\n'));
  const { status, stdout, stderr } = cagecast('batch', '--manifest', at('empty.jsonl'));
  assert.equal(status, 1);
  assert.match(stderr, /^6 jobs: 1 done, 5 failed; /);
  const errors = linesOf(stdout).flatMap(({ error }) => error ?? []);
  const members = errors.map((error) => /^line (\d) of [^:]*: (.+) is empty/.exec(error)?.slice(1));
  const empty = ['"target"', '"cage"', '"report"', '"neverMask"', 'regions[0]: "texture"'];
  assert.deepEqual(
    members.sort(),
    empty.map((name, i) => [String(i + 2), name]),
  );
  const nothing = (...more: string[]) => cagecast('batch', at('in/0.glb'), '--cage', at('cage.glb'), ...more).stderr;
  assert.match(
    nothing(),
    /^1 job: 1 done, .*\nno model or report written; for these, add -o OUT\.glb or --report R\.json\n$/,
  );
  assert.match(nothing('--results', at('nothing.jsonl')), /^1 job: 1 done, .*\n$/);
});

test('--resume does again what should have a verdict in the results, and has none', () => {
  const results = at('verdicts.jsonl');
  const batch = () => {
    const files = [at('in/0.glb'), '--cage', at('cage.glb'), '--results', results];
    return cagecast('batch', ...files, '--resume', '--fail-on', 'unfit').stderr.replace(/;.*\n/, '');
  };
  assert.equal(batch(), '1 job: 1 done, 0 failed');
  const text = readFileSync(results, 'utf8');
  for (const wrong of ['"verdict":7', '"other":"good"']) {
    writeFileSync(results, text.replace(/"verdict":"\w+"/, wrong));
    assert.equal(batch(), '1 job: 1 done, 0 failed', wrong);
  }
});

test('with --fail-on reports have the verdict, which diff compares', () => {
  const report = (cage: string) => {
    const path = at(`${cage}.json`);
    cagecast('batch', at('in/0.glb'), '--cage', at(`${cage}.glb`), '--report', path, '--fail-on', 'unfit');
    return path;
  };
  const [good, bad] = [report('cage'), report('away')];
  const { verdict, findings } = JSON.parse(readFileSync(bad, 'utf8')) as {
    verdict: string;
    findings: { sentence: string }[];
  };
  assert.equal(verdict, 'unfit');
  assert.ok(findings[0]!.sentence);
  const { status, stdout } = cagecast('diff', good, bad);
  assert.equal(status, 4);
  assert.match(stdout, /verdict +good +unfit +over/);
});
