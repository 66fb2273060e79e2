import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { existsSync, mkdirSync, readdirSync, readFileSync, renameSync, rmSync, symlinkSync } from 'node:fs';
import { watch } from 'node:fs/promises';
import { test } from 'node:test';
import { fails, kProgram, ok, run } from '../../support/command.js';
import { glbOf, packGlb, unpackGlb } from '../../support/gltf.js';
import { head } from '../scenes.js';
import { png, workplace, write } from './workplace.js';

const { at, cage, target } = workplace('batch', head(6, 8));
const glb = glbOf(target);
const batch = 'batch target.glb --cage cage.glb';
write('away.glb', glbOf({ ...cage, positions: cage.positions.map((x) => x + 9) }));

interface Line {
  target: string;
  output: string | null;
  key: string;
  status: 'done' | 'failed' | 'skipped';
  error?: string;
  verdict?: string;
  note?: string;
}

const linesOf = (text: string): Line[] =>
  text
    .split('\n')
    .filter((line) => line.endsWith('}'))
    .map((line) => JSON.parse(line) as Line);
const linesIn = (name: string) => linesOf(readFileSync(name, 'utf8'));
const writeJobs = (name: string, jobs: readonly (object | string)[]) =>
  write(name, jobs.map((job) => (typeof job === 'string' ? job : JSON.stringify(job))).join('\n'));
/** Runs a batch. @returns how many jobs were done, failed and done before. */
const counted = async (line: string) => (await run(line)).stderr.replace(/;.*\n/, '');

test('jobs, some of them broken, killed in the middle and resumed: every good job once, nothing half-written', async () => {
  const [count, broken] = [40, [3, 30, 39]];
  mkdirSync('in');
  for (let i = 0; i < count; ++i) write(`in/${i}.glb`, broken.includes(i) ? glb.subarray(0, glb.length / 2) : glb);
  const line = 'batch in/*.glb --cage cage.glb -o out/{name}.glb --results results.jsonl';
  write('results.jsonl', '');
  const first = spawn(process.execPath, [kProgram, ...line.split(' '), '--workers', '2'], { stdio: 'ignore' });
  const ended = once(first, 'exit');
  for await (const _ of watch('results.jsonl')) if (linesIn('results.jsonl').length >= 10) break;
  first.kill('SIGKILL');
  await ended;
  const doneBefore = linesIn('results.jsonl').length;
  assert.ok(doneBefore < count - 5, `${doneBefore} jobs were done before it was killed`);
  write('results.jsonl', `${readFileSync('results.jsonl', 'utf8')}{"target":"cut o`); // as if killed within a line

  const { status, stdout, stderr } = await run(`${line} --resume`);
  assert.deepEqual([status, stdout], [1, '']);
  assert.match(stderr, /^40 jobs: \d+ done, 3 failed, \d+ done before; [\d.]+ s\n$/);
  const lines = linesIn('results.jsonl');
  const done = lines.filter((one) => one.status === 'done').map((one) => one.target);
  assert.deepEqual([done.length, new Set(done).size], [37, 37]);
  const failed = new Set(lines.filter((one) => one.status === 'failed').map((one) => one.target));
  assert.deepEqual([...failed].sort(), broken.map((i) => `in/${i}.glb`).sort());
  assert.ok(lines.every((one) => one.status === 'done' || /: is truncated/.test(one.error!)));
  assert.equal(readdirSync('out').length, 37, 'no file under a temporary name is left');
  for (const name of readdirSync('out')) {
    const bytes = readFileSync(`out/${name}`);
    assert.equal(bytes.readUInt32LE(8), bytes.length, name);
  }
  // What has changed is done again, and nothing else.
  write('in/5.glb', glb);
  rmSync('out/6.glb');
  const again = await run(`${line} --resume --json`);
  const { seconds: _, ...summary } = JSON.parse(again.stderr) as { seconds: number };
  assert.deepEqual(summary, { jobs: count, done: 2, failed: 3, skipped: 35, bare: 0, misfits: 0, configs: [] });
});

test('the cage is left out of the targets that a pattern names; a target of which nothing may be painted has a note', async () => {
  mkdirSync('mixed');
  write('mixed/head.glb', glb);
  write('mixed/copy.glb', readFileSync('cage.glb'));
  symlinkSync(at('cage.glb'), 'mixed/link.glb');
  const { stdout, stderr } = await run('batch mixed/*.glb --cage cage.glb');
  assert.deepEqual(
    linesOf(stdout).map(({ target, note }) => [target, note]),
    [['mixed/head.glb', undefined]],
  );
  assert.match(
    stderr,
    /^1 job: 1 done, 0 failed; [\d.]+ s; left out, as they are cages: mixed\/copy.glb, mixed\/link.glb$/m,
  );
  await fails(1, 'mixed/c*.glb: no file but a cage has such a name', 'batch mixed/c*.glb --cage cage.glb');
  const away = await run('batch mixed/head.glb --cage away.glb');
  assert.match(linesOf(away.stdout)[0]!.note!, /^nothing may be painted: the cage lies over next to none/);
  assert.match(away.stderr, / s; next to nothing may be painted of 1, as notes in the lines say$/m);
});

test('patterns reach into folders, follow links to them, and ** does not go round in circles', async () => {
  for (const folder of ['linked/own', 'far', 'odd']) mkdirSync(folder, { recursive: true });
  for (const name of ['far/a.glb', 'linked/own/b.glb', 'linked/own/.hidden.glb']) write(name, glb);
  symlinkSync(at('far'), 'linked/link');
  symlinkSync(at('linked'), 'linked/own/round');
  symlinkSync('self', 'linked/self');
  // A name may hold {dir} or $&, and gives its output that very name.
  const odd = ['a$$b.glb', 'a$&b.glb', 'a{dir}b.glb', 'a{name}b.glb'];
  for (const name of odd) write(`odd/${name}`, glb);
  const { stdout } = await run(
    'batch linked/*/a.glb linked/**/*.glb odd/*.glb --cage cage.glb -o {dir}/out/{name}.glb --workers 1',
  );
  const found = ['linked/link/a.glb', 'linked/own/b.glb', ...odd.map((name) => `odd/${name}`)];
  assert.deepEqual(
    linesOf(stdout)
      .map((line) => [line.target, line.status])
      .sort(),
    found.map((name) => [name, 'done']),
  );
  assert.deepEqual(readdirSync('odd/out').sort(), odd.sort());
  await fails(1, 'linked/self: is a link that leads back to itself', 'batch linked/self/*.glb --cage cage.glb');
  // Where a file is given whole, a * in its name is no pattern.
  write('sta*r.glb', glb);
  await ok('transfer sta*r.glb --cage cage.glb -o star.glb --quiet');
});

test('--at-least exits 3 for a cage that does not fit, of a region too; reports have the verdict, which diff compares', async () => {
  const job = { target: 'target.glb', cage: 'cage.glb', report: 'good.json' };
  const regions = [{ cage: 'away.glb', texture: 'paint.png' }];
  writeJobs('verdicts.jsonl', [
    job,
    { ...job, cage: 'away.glb', report: 'bad.json' },
    { ...job, texture: 'paint.png', regions, output: 'region.glb', report: 'region.json' },
  ]);
  const judged = await run('batch --manifest verdicts.jsonl --at-least usable --workers 1');
  assert.equal(judged.status, 3);
  assert.match(judged.stderr, /^3 jobs: 3 done, 0 failed, 2 with a cage that does not fit as demanded; /);
  const lines = linesOf(judged.stdout).map(({ output, status, verdict }) => [output, status, verdict]);
  assert.deepEqual(lines, [
    [null, 'done', 'good'],
    [null, 'done', 'unfit'],
    [at('region.glb'), 'done', 'unfit'],
  ]);
  const { verdict, findings } = JSON.parse(readFileSync('bad.json', 'utf8')) as { verdict: string; findings: object[] };
  assert.equal(verdict, 'unfit');
  assert.ok('sentence' in findings[0]!, 'a finding has a sentence');
  const { status, stdout } = await run('diff good.json bad.json');
  assert.equal(status, 4);
  assert.match(stdout, /verdict +good +unfit +over/);
});

test('a manifest has a job per line, with settings of its own; a wrong line is a job that fails', async () => {
  const job = { target: 'target.glb', cage: 'cage.glb' };
  const region = { cage: 'cage.glb', texture: 'other.png' };
  write('other.png', png(90));
  write('half.glb', glbOf({ ...cage, indices: cage.indices.slice(0, 3 * Math.floor(cage.indices.length / 6)) }));
  const wrong: [line: object | string, message: RegExp][] = [
    ['no JSON', /^is not JSON/],
    [{ cage: 'cage.glb' }, /^has no "target"$/],
    [{ ...job, treshold: 1 }, /^"treshold" is unknown; there are: target, cage, /],
    [{ ...job, threshold: 2 }, /^"threshold" is 2, not a number within 0\.\.1$/],
    ...['target', 'cage', 'report', 'neverMask'].map((name): [object, RegExp] => [
      { ...job, [name]: '' },
      new RegExp(`^"${name}" is empty$`),
    ]),
    [{ ...job, output: 'o.fbx' }, /^its output .*o\.fbx does not end in \.glb, \.vrm or \.gltf$/],
    [{ ...job, output: 'o/{foo}.glb' }, /^\{foo\} is unknown; paths may hold \{name\} and \{dir\}$/],
    [{ ...job, report: '{nmae}.json' }, /^\{nmae\} is unknown/],
    ...[{ texture: 'paint.png' }, { borders: 'cut' }, { regions: [region] }].map((more): [object, RegExp] => [
      { ...job, ...more },
      /^has no output, where its texture or its cut target would be written$/,
    ]),
    [
      { ...job, texture: 'p.<UDIM>.png', uvBounds: [0, 0, 1, 1], output: 'o.glb' },
      /cannot be given with a texture of <UDIM>/,
    ],
    [{ ...job, uvBounds: [0, 0] }, /^"uvBounds" is \[0,0\], not an array of four numbers/],
    [{ ...job, regions: {} }, /^"regions" is \{\}, not an array of \{"cage": …, "texture": …\}$/],
    [{ ...job, regions: ['cage.glb'] }, /^regions\[0\]: is "cage\.glb", not \{"cage": …, "texture": …\}$/],
    [{ ...job, regions: [region, { cage: 'cage.glb' }] }, /^regions\[1\]: has no "texture"$/],
    [{ ...job, regions: [{ ...region, texture: '' }] }, /^regions\[0\]: "texture" is empty$/],
  ];
  const all = { texture: 'paint.png', referenceCage: 'cage.glb', uvBounds: [0, 0, 1, 1], threshold: 0, minCovered: 0 };
  const right = [
    { ...job, output: 'new/{name}/kept.glb', report: 'kept.json', exclude: ['only'] },
    { ...job, ...all, cage: 'half.glb', regions: [region], output: 'all.gltf', report: 'all.json' },
  ];
  writeJobs('jobs.jsonl', [...wrong.map(([line]) => line), ...right, '']);
  const { status, stdout, stderr } = await run('batch --manifest jobs.jsonl --workers 1');
  assert.equal(status, 1);
  assert.match(stderr, new RegExp(`^${wrong.length + 2} jobs: 2 done, ${wrong.length} failed; `));
  const errors = linesOf(stdout).flatMap(({ error }) => error ?? []);
  assert.equal(errors.length, wrong.length);
  for (const [i, [, message]] of wrong.entries()) {
    const [place, ...others] = [`line ${i + 1} of jobs.jsonl: `].flatMap((place) =>
      errors.filter((error) => error.startsWith(place)),
    );
    assert.deepEqual(others, []);
    assert.match(place!.replace(/^.*?: /, ''), message);
  }
  assert.ok(existsSync('new/target/kept.glb'), 'folders are made');
  const reports = ['kept', 'all'].map((name) => JSON.parse(readFileSync(`${name}.json`, 'utf8')));
  assert.equal(reports[0].counts.cosmetic, 0);
  assert.deepEqual([reports[1].options.threshold, reports[1].regions[0].uvSet], [0, 'TEXCOORD_2']);
  assert.deepEqual(
    readdirSync('.').filter((name) => name.startsWith('all')),
    ['all-image0.png', 'all-image1.png', 'all.bin', 'all.gltf', 'all.json'],
  );
});

test('a batch that cannot be right does not begin', async () => {
  // The second target's buffer is named as what the first job would write beside its output.
  mkdirSync('beside');
  const { json, bin } = unpackGlb(glb);
  json.buffers![0]!.uri = '0.bin';
  write('beside/second.gltf', JSON.stringify(json));
  write('beside/0.bin', bin);
  write('beside/0.glb', glb);
  const line = '{"target": "target.glb", "cage": "cage.glb"}';
  write('clash.jsonl', line);
  write('clash.json', '{}');
  write('empty.jsonl', '\n\n');
  writeJobs(
    'twins.jsonl',
    ['gltf', 'GLTF'].map((ending) => ({ ...JSON.parse(line), output: `e.${ending}` })),
  );
  const manifest = 'batch --manifest clash.jsonl';
  for (const [line, status, message] of [
    ['batch in/*.gltf --cage cage.glb', 1, /in\/\*\.gltf: no file has such a name/],
    ['batch --manifest gone.jsonl', 1, /gone\.jsonl: no such file/],
    ['batch --manifest empty.jsonl', 1, /empty\.jsonl: has no jobs: each line is one, as a JSON object/],
    [`${batch} --results in`, 1, /in: cannot be written \(is a folder\)/],
    ['batch in/*.glb --cage cage.glb -o same.glb', 2, /same\.glb: is written for .* and .*; use \{name\}/],
    ['batch in/*.glb --cage cage.glb -o in/{name}.glb', 2, /: is read and written by this batch/],
    [
      'batch beside/0.glb beside/second.gltf --cage cage.glb -o beside/{name}.gltf',
      2,
      /0\.gltf: is written beside a file of its name that this batch reads/,
    ],
    ['batch --manifest twins.jsonl', 2, /e\.bin: is written for .* and /],
    [`${manifest} --report clash.jsonl`, 2, /clash\.jsonl: is read and written by this batch/],
    [`${manifest} --results clash.jsonl`, 2, /clash\.jsonl: is read by this batch/],
    [`${batch} --results cage.glb`, 2, /cage\.glb: is read by this batch/],
    [`${batch} --config clash.json --report clash.json`, 2, /clash\.json: is read and written by this batch/],
    [`${batch} --results r.json --report r.json`, 2, /r\.json: is written for the results and /],
    [`${batch} -o {name}-x.glb --report {name}-x.glb`, 2, /target-x\.glb: is both output and report of target\.glb;/],
  ] as const)
    await fails(status, message, line);
  assert.deepEqual([readFileSync('clash.jsonl', 'utf8'), readFileSync('clash.json', 'utf8')], [line, '{}']);
  assert.deepEqual(readFileSync('cage.glb'), glbOf(cage));
});

test('borders that a configuration cuts are no matter where nothing is written; wrong settings fail their own jobs only', async () => {
  for (const folder of ['cut', 'wrong']) mkdirSync(folder);
  for (const name of ['cut/a.glb', 'wrong/b.glb']) write(name, glb);
  write('cut/cagecast.config.json', '{ "borders": "cut" }');
  write('wrong/cagecast.config.json', '{ "treshold": 1 }');
  const { status, stdout, stderr } = await run('batch cut/a.glb wrong/b.glb --cage cage.glb');
  assert.equal(status, 1);
  assert.match(stderr, /\nno model or report written; for these, add -o OUT\.glb or --report R\.json\n$/);
  const lines = linesOf(stdout).map((line) => [line.target, line.status]);
  assert.deepEqual(lines.sort(), [
    ['cut/a.glb', 'done'],
    ['wrong/b.glb', 'failed'],
  ]);
  const quiet = await run('batch wrong/b.glb --cage cage.glb --quiet');
  assert.deepEqual([quiet.status, quiet.stdout], [1, '']);
  assert.match(quiet.stderr, /^cagecast: wrong\/b\.glb: wrong\/cagecast\.config\.json: "treshold" is unknown[^\n]*\n$/);
});

test('results that cannot be written end the batch at once; their folder is made', async () => {
  const some = Array.from({ length: 12 }, (_, i) => `in/${i + 10}.glb`).join(' ');
  if (existsSync('/dev/full')) {
    const full = `batch ${some} --cage cage.glb --workers 2 -o full/{name}.glb --results /dev/full`;
    await fails(1, /^cagecast: \/dev\/full: cannot be written /, full);
    assert.ok(readdirSync('full').length < 9, 'no thread goes on with what is waiting');
  }
  const { stderr } = await run(`${batch} --results made/for/results.jsonl`);
  assert.match(stderr, /^1 job: 1 done, .*\n$/);
  assert.equal(linesIn('made/for/results.jsonl').length, 1);
});

test('--resume does again what another job has overwritten since, and the last line about a target is true', async () => {
  const line = `${batch} -o once/{name}.glb --results back.jsonl --resume`;
  const last = () => linesIn('back.jsonl').at(-1)!;
  assert.equal((await run(line)).status, 0);
  const first = readFileSync('once/target.glb');
  await run(`${line} --threshold 1`);
  assert.notDeepEqual(readFileSync('once/target.glb'), first);
  assert.equal(await counted(line), '1 job: 1 done, 0 failed');
  assert.deepEqual(readFileSync('once/target.glb'), first);
  assert.equal(await counted(line), '1 job: 0 done, 0 failed, 1 done before');
  // A job that failed, and then is as it was: the file is still its own.
  write('cagecast.config.json', '{ "treshold": 1 }');
  assert.equal((await run(line)).status, 1);
  assert.match(last().error!, /cagecast\.config\.json: "treshold" is unknown/);
  rmSync('cagecast.config.json');
  assert.equal((await run(line)).status, 0);
  assert.deepEqual([last().status, last().target], ['skipped', 'target.glb']);
  // The same job fails, and then its file is there again.
  renameSync('once', 'twice');
  write('once', '');
  assert.equal((await run(line.replace(' --resume', ''))).status, 1);
  rmSync('once');
  renameSync('twice', 'once');
  assert.equal((await run(line)).status, 0);
  assert.equal(last().status, 'skipped');
});

test('--resume adds no line for jobs of one target that are all done, and does again what has no verdict', async () => {
  write('other-cage.glb', glbOf(cage));
  const cages = ['cage', 'other-cage'];
  writeJobs(
    'same.jsonl',
    cages.map((name) => ({ target: 'target.glb', cage: `${name}.glb`, output: `${name}-out.glb` })),
  );
  const line = 'batch --manifest same.jsonl --results same-results.jsonl --resume --workers 1';
  assert.equal(await counted(`${line} --at-least usable`), '2 jobs: 2 done, 0 failed');
  assert.equal(await counted(`${line} --at-least usable`), '2 jobs: 0 done, 0 failed, 2 done before');
  assert.equal(linesIn('same-results.jsonl').length, 2);
  const text = readFileSync('same-results.jsonl', 'utf8');
  write(
    'same-results.jsonl',
    text.replace(/"verdict":"\w+"/, '"verdict":7').replace(/"verdict":"\w+"/, '"other":"good"'),
  );
  assert.equal(await counted(`${line} --at-least usable`), '2 jobs: 2 done, 0 failed');
});

test('--resume minds what a glTF has beside it, as it is read and as it is written', async () => {
  for (const [name, bytes] of Object.entries({ head: glb, cage: glbOf(cage) })) {
    const { json, bin } = unpackGlb(bytes);
    json.buffers![0]!.uri = `${name}%20mesh.bin`;
    write(`${name}.gltf`, JSON.stringify(json));
    write(`${name} mesh.bin`, bin);
  }
  const { json, bin } = unpackGlb(glb);
  json.images = [{ uri: 'skin.png' }]; // a GLB may name files, too
  write('named.glb', packGlb({ json, bin }));
  write('skin.png', png(1, 1));
  write('wrong.gltf', '{ "buffers": 1');
  const line =
    'batch head.gltf named.glb wrong.gltf --cage cage.gltf -o text/{name}.gltf --results text.jsonl --resume --workers 1';
  assert.equal(await counted(line), '3 jobs: 2 done, 1 failed');
  assert.equal(await counted(line), '3 jobs: 0 done, 1 failed, 2 done before');
  for (const [change, done] of [
    [() => write('head mesh.bin', readFileSync('head mesh.bin')), 1],
    [() => write('skin.png', png(2, 1)), 1],
    [() => write('cage mesh.bin', readFileSync('cage mesh.bin')), 2],
    [() => rmSync('text/head.bin'), 1],
  ] as const) {
    change();
    const before = done < 2 ? `, ${2 - done} done before` : '';
    assert.equal(await counted(line), `3 jobs: ${done} done, 1 failed${before}`, String(change));
  }
  assert.ok(existsSync('text/head.bin'));
});
