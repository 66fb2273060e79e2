import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync, symlinkSync, writeFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { test } from 'node:test';
import { promisify } from 'node:util';
import { labelsOf, readJson } from '../../../bench/public/labels.js';
import { type Method, methodOf, run, writeArrays } from '../../../bench/public/methods.js';
import { findModels } from '../../../bench/public/models.js';
import { summaryOf } from '../../../bench/public/report.js';
import { serve } from '../../support/serve.js';
import { temporaryFolder } from '../../support/temporary.js';

const { folder, at } = temporaryFolder('public-benchmark');
const kLizard = resolve('examples/samples/lizard');
const kReadme = readFileSync('bench/public/README.md', 'utf8');

/** Two triangles, and a cage like them. */
const square = {
  positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0),
  indices: Uint32Array.of(0, 1, 2, 2, 1, 3),
  uvs: Float32Array.of(0, 0, 1, 0, 0, 1, 1, 1),
};
const target = { ...square, groups: Uint32Array.of(0, 0, 0, 1), names: [['Head', 'Skin'], ['EyeLeft']] };

const write = (name: string, text: string): string => {
  writeFileSync(at(name), text, { mode: 0o755 });
  return at(name);
};

/** Runs a program. @return Its exit code, and what it printed. */
const started = (...args: string[]): Promise<{ status: number; stdout: string; stderr: string }> =>
  promisify(execFile)(process.execPath, args).then(
    (done) => ({ status: 0, ...done }),
    ({ code, stdout, stderr }) => ({ status: code, stdout, stderr }),
  );

const find = (method: Method, timeout = 60) => run(method, folder, 4, { runs: 2, timeout });

test('methods in JavaScript, in Python and of a program find zones', async () => {
  writeArrays(folder, { cage: square, target });
  const js = write(
    'edge.mjs',
    `let ready = false;
    export async function prepare() { ready = true; console.log('ready'); }
    export const zones = async ({ cage, target }) => {
      if (!ready || cage.uvs.length !== 8 || cage.indices[5] !== 3) throw new Error('the cage is another');
      target.positions[0] += 1; // is given anew
      return target.groups.map((group, v) => group + 2 * target.positions[3 * v]);
    };`,
  );
  const python = write(
    'edge.py',
    `print('loaded')\ndef zones(cage, target):\n    return target["positions"][:, 0] > 0\n`,
  );
  const program = write(
    'copy.sh',
    `#!/bin/sh\necho '{"ready": true}'\nread line\ncp ${at('given.npy')} ${at('zones.npy')}\necho '{"seconds": 0.5}'\nread end\n`,
  );
  for (const [file, zones] of [
    [js, [1, 1, 0, 1]],
    [python, [0, 1, 0, 1]],
    [program, [0, 1, 0, 1]],
  ] as const) {
    const outcome = await find(methodOf(file, '/'));
    assert.ok('zones' in outcome, JSON.stringify(outcome));
    assert.deepEqual([...outcome.zones], zones, file);
    assert.equal(outcome.seconds.length, file === program ? 1 : 2);
    if (process.platform === 'linux') assert.ok(outcome.memory! >= 0 && outcome.memory! < 1e9);
    copyFileSync(at('zones.npy'), at('given.npy'));
  }
  assert.throws(
    () => methodOf('nobody.py', '/'),
    /no method, file or program "nobody.py"; included are naive, decals, by-hand, paper, default/,
  );
});

test('a method may have a name, arguments, a path with spaces, and a program that is found as others are', () => {
  mkdirSync(at('own methods'));
  const file = write('own methods/mine.py', 'def zones(cage, target): return []');
  const { name, command } = methodOf('far="own methods/mine.py"', folder);
  assert.deepEqual([name, command.at(-1)], ['far', file]);
  const shell = methodOf(`sh -c 'echo "hello"' ./a`, folder);
  assert.deepEqual([shell.name, ...shell.command.slice(1)], ['sh', '-c', 'echo "hello"', './a']);
  assert.match(shell.command[0], /^\/.*\/sh$/);
  assert.equal(shell.folder, folder); // so that its arguments may be relative paths
  writeFileSync(at('plain'), '');
  assert.throws(
    () => methodOf('plain', folder),
    /plain may not be run \(chmod \+x allows it\), and does not end in \.py/,
  );
});

test('what is wrong with a method is said in a sentence', async () => {
  writeArrays(folder, { cage: square, target });
  const zones = (body: string): string => `export const zones = () => { ${body} };`;
  const script = (...lines: string[]): string => ['#!/bin/sh', ...lines].join('\n');
  for (const [name, text, expected] of [
    ['short.mjs', zones('return new Uint8Array(3)'), /^zones has the shape \(3\); 4 values are expected/],
    ['half.mjs', zones('return [0, 0, 0.5, 1]'), /^zones\[2\] is 0.5; whole numbers or booleans/],
    ['nothing.mjs', zones(''), /^Error: zones\(\) returned undefined; an array is expected: is a return missing/],
    ['throws.mjs', zones('throw new TypeError("no UVs")'), /^TypeError: no UVs/],
    ['ends.mjs', zones('process.exit(3)'), /^ended with exit code 3 before it replied/],
    ['hangs.mjs', zones('for (;;);'), /^took more than 3 s/],
    ['other.mjs', 'export const zone = 1;', /exports no function called zones/],
    ['text.py', 'def zones(cage, target): return ["a"] * 4', /^zones is of the type <U1; whole numbers/],
    ['flat.py', 'def zones(cage, target): return target["positions"]*0', /^zones has the shape \(4, 3\); 4 values/],
    ['none.py', 'def zones(cage, target): pass', /^TypeError: zones\(\) returned None; is a return missing/],
    ['object.py', 'def zones(cage, target): return [None] * 4', /^TypeError: zones\(\) returned what is no array/],
    ['broken.py', 'def zones(', /^SyntaxError/],
    ['exits.py', 'import os\nos.abort()', /^was ended by SIGABRT before it replied/],
    ['talks.sh', script('echo hello'), /^printed "hello"; a line such as \{"ready": true\} is expected/],
    [
      'lazy.sh',
      script(`echo '{"ready": 1}'`, 'read line', `echo '{"seconds": 1}'`),
      /^replied, but wrote no zones.npy/,
    ],
    ['vague.sh', script(`echo '{"ready": 1}'`, 'read line', `echo '{"seconds": "few"}'`), /^replied seconds of "few"/],
    ['sleeps.sh', script('sleep 60'), /^took more than 3 s/],
  ] as const) {
    // Only what never ends is not given all the time that a busy machine needs.
    const outcome = await find(methodOf(write(name, text), '/'), expected.source.includes('took more') ? 3 : 60);
    assert.match('failed' in outcome ? outcome.failed : 'found zones', expected, name);
  }
  const absent = await find({ name: 'absent', command: [at('absent')], folder });
  assert.match('failed' in absent ? absent.failed : '', /^cannot be started: .*ENOENT/);
});

test('labels are per vertex or by names, and an error says where it is', () => {
  const labels = (file: Record<string, unknown>) => labelsOf(file, 'a/labels.json', target);
  assert.deepEqual(labels({ ncz: ['*eye*'], ignore: '0110', offCage: [1, 0, 0, 0] }), {
    ncz: Uint8Array.of(0, 0, 0, 1),
    ignore: Uint8Array.of(0, 1, 1, 0),
    offCage: Uint8Array.of(1, 0, 0, 0),
  });
  assert.deepEqual(labels({ ncz: ['skin'] }).ncz, Uint8Array.of(1, 1, 1, 0));
  for (const [file, expected] of [
    [{}, 'ncz is missing; it says what must not be painted'],
    [{ ncz: ['Teeth'] }, 'ncz: nothing is named "Teeth"; there are Head, Skin, EyeLeft'],
    [{ ncz: '0000', ignor: [] }, 'there is no field "ignor"; there are ncz, ignore, offCage'],
    [{ ncz: '*eye*' }, 'ncz is "*eye*"; names belong in brackets, ["*eye*"], else there is a 0 or a 1 for each vertex'],
    [{ ncz: '00110' }, 'ncz has 5 values; the target has 4 vertices, and one each is expected'],
    [{ ncz: '0000', ignore: [0, 0, 2, 0] }, 'ignore[2] is 2; 0 or 1 is expected'],
    [{ ncz: [0, null, 0, 0] }, 'ncz[1] is null; 0 or 1 is expected'],
    [{ ncz: '0000', offCage: 7 }, 'offCage is 7; a string or an array is expected'],
  ] as const)
    assert.throws(() => labels(file), new RegExp(`^Error: a/labels.json: ${expected.replace(/[[\]*]/g, '\\$&')}$`));
  assert.throws(() => readJson(write('bad.json', '{"ncz"')), /bad\.json: /);
  const { properties } = readJson<{ properties: object }>('bench/public/labels.schema.json');
  assert.deepEqual(Object.keys(properties), ['ncz', 'ignore', 'offCage', 'parts']);
});

test('a run makes a table and a page with pictures; what cannot be measured is told', async () => {
  mkdirSync(at('models', 'nothing'), { recursive: true });
  mkdirSync(at('models', 'bald'));
  for (const file of ['target.glb', 'truth.json']) copyFileSync(`${kLizard}/${file}`, at('models', 'bald', file));
  symlinkSync(kLizard, at('models', 'lizard'));
  mkdirSync(at('models', 'text'));
  for (const file of ['target.glb', 'cage.glb', 'labels.json']) write(`models/text/${file}`, '{}');
  const example = /```py\n([\s\S]*?)```/.exec(kReadme)![1]!;
  const [mine, bad] = [write('mine.py', example), write('bad<b>.mjs', 'export const zones = () => []')];
  const args = [
    at('models'),
    kLizard,
    '--method',
    `naive,decals,by-hand,default,${mine},${bad}`,
    '--runs',
    '1',
    '--output',
    at('out'),
  ];
  const { status, stderr } = await started('--import', 'tsx', 'bench/public/run.ts', ...args);
  assert.equal(status, 1, stderr);
  assert.match(stderr, /skipped .*nothing: has no target.glb/);
  assert.match(
    stderr,
    /skipped .*bald: has no cage.glb; make one, in the folder of the project, by: npx cagecast make/,
  );
  assert.match(stderr, /skipped .*text\/target.glb: is no GLB file/);
  assert.match(stderr, /lizard: bad<b> failed: zones has the shape \(0\); 4141 values/);
  const { models, summary } = JSON.parse(readFileSync(at('out', 'results.json'), 'utf8'));
  assert.deepEqual(Object.keys(models), ['lizard']);
  const { naive, decals, default: ours, mine: example1, 'by-hand': byHand } = models.lizard.methods;
  assert.deepEqual([naive.suppressed, naive.kept, ours.suppressed], [0, 1, 1]);
  assert.ok(decals.suppressed < 0.01 && decals.kept > 0.99, 'a decal goes through all that is in its box');
  assert.ok(byHand.suppressed > 0.8 && byHand.kept > 0.9 && byHand.suppressed < ours.suppressed);
  assert.ok(example1.suppressed > 0.5 && example1.kept > 0.5, 'the example of the page does something');
  assert.deepEqual(Object.keys(summary).slice(0, 2), ['default', 'by-hand']);
  assert.match(
    readFileSync(at('out', 'results.md'), 'utf8'),
    /\| default +\| +100 % \| +100 % \|[\s\S]*- bad<b> failed: /,
  );
  const page = readFileSync(at('out', 'results.html'), 'utf8');
  assert.equal(page.match(/<img src="data:image\/png;base64,/g)!.length, 6, 'truth and five methods');
  assert.match(page, /forbidden paint[\s\S]*bad&#60;b&#62; failed/);
  assert.doesNotMatch(page, /<script|https?:/);
  for (const [args, expected] of [
    [['--runs', 'many'], /^--runs is "many"; a whole number above 0 is expected\n$/],
    [[at('nowhere')], /^there is no folder .*nowhere\n$/],
    [['--methods', 'a'], /Unknown option '--methods'[\s\S]*--method a,\.\/b\.py {2}/],
  ] as const) {
    const wrong = await started('--import', 'tsx', 'bench/public/run.ts', ...args);
    assert.equal(wrong.status, 2);
    assert.match(wrong.stderr, expected);
  }
});

test('methods are ordered by the lesser of both; a model that one fails at counts as 0', () => {
  const row = (suppressed: number, kept: number) => ({ suppressed, kept, seconds: 1 });
  const model = (methods: object) => ({ vertices: 1, triangles: 1, methods }) as never;
  const a = model({ all: row(1, 0), fair: row(0.5, 0.7), frail: row(1, 1) });
  const b = model({ all: row(1, 0), fair: row(0.8, 0.75), frail: { failed: 'it fell' } });
  const { fair, frail, ...others } = summaryOf({ models: { a, b } });
  assert.deepEqual(
    [fair!.lesser, frail!.lesser, frail!.failed],
    [{ mean: 0.625, worst: 0.5 }, { mean: 0.5, worst: 0 }, 1],
  );
  assert.deepEqual(others['all']!.lesser, { mean: 0, worst: 0 });
  assert.deepEqual(Object.keys(summaryOf({ models: { a, b } })), ['fair', 'frail', 'all']);
});

test('models are fetched whole or not at all', async () => {
  const glb = readFileSync(`${kLizard}/target.glb`);
  mkdirSync(at('served'));
  copyFileSync(`${kLizard}/target.glb`, at('served', 'lizard.glb'));
  write('served/page.glb', '<!doctype html>');
  const server = await serve(at('served'));
  const sha256 = createHash('sha256').update(glb).digest('hex');
  const model = (name: string, url: string, more = {}) => ({
    ...{ name, title: name, author: 'somebody', licence: 'CC0-1.0', page: 'https://example.org' },
    ...{ url, labels: { ncz: ['*eye*', '*teeth*', '*tongue*'] }, cage: 'make', ...more },
  });
  const models = [
    model('good', `${server.origin}/lizard.glb`, { sha256 }),
    model('changed', `${server.origin}/lizard.glb`, { sha256: '0'.repeat(64) }),
    model('gone', `${server.origin}/gone.glb`),
    model('page', `${server.origin}/page.glb`),
    model('offline', 'http://127.0.0.1:9/lizard.glb'),
    model('caged', `${server.origin}/lizard.glb`, { cage: 'fit nobody' }),
  ];
  const list = write('list.json', JSON.stringify({ models }));
  const names = [...models.map(({ name }) => name), 'unknown'];
  const args = ['bench/public/fetch.mjs', ...names, '--models', list, '--to', at('fetched')];
  const { status, stdout, stderr } = await started(...args);
  server.close();
  assert.equal(status, 1);
  assert.equal(stdout, `good is in ${at('fetched', 'good')}\n`);
  const lines = stderr.trim().split('\n');
  for (const [i, expected] of [
    /^changed is another file than expected at http.*: its SHA-256 is [\da-f]{64}, not 0{64}$/,
    /^gone is not at http.*: the server answers 404$/,
    /^page is no GLB at http/,
    /^offline cannot be reached at http.*: /,
    /^caged gets no cage by fit nobody: /,
    /^unknown is not in the list, which has good, changed, /,
  ].entries())
    assert.match(lines[i] ?? '', expected);
  assert.deepEqual(readdirSync(at('fetched')), ['good'], 'nothing half-written');
  assert.match(readFileSync(at('fetched', 'good', 'LICENCE.txt'), 'utf8'), /by somebody\nLicence: CC0-1.0\n/);
  assert.equal(findModels([at('fetched')]).models.length, 1);
  const listed = await started('bench/public/fetch.mjs', '--list');
  assert.match(listed.stdout, /^kaykit-rogue +Rogue.*CC0-1.0$/m);
  for (const { url } of readJson<{ models: { url: string }[] }>('bench/public/models.json').models)
    assert.match(
      url,
      /^https:\/\/raw\.githubusercontent\.com\/[^/]+\/[^/]+\/[\da-f]{40}\//,
      'a commit does not change',
    );
  assert.ok(existsSync(at('fetched', 'good', 'cage.glb')));
});
