import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, symlinkSync } from 'node:fs';
import { test } from 'node:test';
import { fails, json, ok, run } from '../../support/command.js';
import { glbOf } from '../../support/gltf.js';
import { head } from '../scenes.js';
import { png, workplace, write } from './workplace.js';

const { at, target } = workplace('config', head(5, 8));
const config = 'cagecast.config.json';
const transfer = 'transfer heads/ada.glb --cage cage.glb';
const inspect = 'inspect heads/ada.glb --cage cage.glb';

interface Report {
  counts: { cosmetic: number };
  options: { preset: string; threshold: number; exclude: string[]; config: string | null; occlusionReach: unknown };
}

mkdirSync('heads');
for (const name of ['ada', 'bao', '101']) write(`heads/${name}.glb`, glbOf(target));

const set = (settings: object, path = config) => write(path, JSON.stringify(settings));
const optionsOf = async (line: string) => (await json<Report>(line)).options;
const painted = async (flags = '') => (await json<Report>(`${transfer}${flags}`)).counts.cosmetic;
/** Runs a batch of one job. @returns its line. */
const lineOf = async (job: object) => {
  write('job.jsonl', JSON.stringify({ target: 'heads/ada.glb', cage: 'cage.glb', ...job }));
  return JSON.parse((await run('batch --manifest job.jsonl')).stdout) as Report;
};

test('settings come from the nearest file above the target; characters by name win over all, and flags over both', async () => {
  set({
    threshold: 0.4,
    exclude: ['no such part'],
    characters: { 'a*': { preset: 'paper', exclude: ['only'] }, 'ada.glb': { threshold: 0.3 } },
  });
  const own = await optionsOf(transfer);
  assert.deepEqual([own.preset, own.threshold, own.exclude], ['paper', 0.3, ['no such part', 'only']]);
  assert.equal(own.config, config);
  const other = await optionsOf('inspect heads/bao.glb --cage cage.glb');
  assert.deepEqual([other.preset, other.threshold], ['default', 0.4]);
  const won = await optionsOf(`${transfer} --set preset=default --threshold 0.6`);
  assert.deepEqual([won.preset, won.threshold, won.exclude.length], ['default', 0.6, 2]);
  assert.deepEqual(
    (await optionsOf(`${transfer} --exclude only`)).exclude,
    ['only'],
    'a list of flags replaces others',
  );
  // What a flag names must be there; what the file names need not.
  await fails(1, /--exclude gone: nothing has this name/, `${transfer} --exclude gone`);
  // Names that are numbers have their place, too.
  write(config, '{ "characters": { "*": { "threshold": 0.6 }, "n101": {}, "101" : { "threshold": 0.3 } } }');
  assert.equal((await optionsOf('transfer heads/101.glb --cage cage.glb')).threshold, 0.3);
});

test('--config names another file, --config none none; the output says which file was used', async () => {
  set({ threshold: 0.4, occlusionReach: 'Infinity' });
  set({ threshold: 0.2, borders: 'cut', compress: 'meshopt' }, 'other.json');
  assert.equal((await optionsOf(transfer)).occlusionReach, 'Infinity');
  assert.equal((await optionsOf(`${transfer} --config none`)).config, null);
  assert.equal((await optionsOf(`${transfer} --config other.json`)).threshold, 0.2);
  const written = await ok(`${transfer} --config other.json -o out.glb`);
  assert.match(written, /settings from other\.json\n$/);
  assert.match(written, /cut along borders/);
  assert.match(readFileSync('out.glb').toString('latin1'), /EXT_meshopt_compression/);
  assert.match(await ok(inspect), /settings from cagecast\.config\.json\n$/);
  assert.match(
    await ok('bake heads/ada.glb --cage cage.glb --texture paint.png -o b.png --size 8'),
    /settings from cagecast\.config\.json\n$/,
  );
});

test('a list of names to ignore; --ignore replaces it', async () => {
  set({ ignore: ['no such part', 'only'] });
  await fails(1, /^cagecast: heads\/ada\.glb: all parts are left out: "only" \(ignored\);/, transfer);
  await fails(1, /--ignore nose: nothing has this name/, `${transfer} --ignore nose`);
  set({ ignore: 'only' });
  await fails(1, `${config}: "ignore" is "only", not an array of names`, transfer);
});

test('where a part is both kept and excluded, what is said later counts, else keep', async () => {
  set({ keep: ['only'] });
  assert.ok((await painted()) > 0);
  assert.equal(await painted(' --exclude only'), 0);
  assert.equal((await lineOf({ exclude: ['only'] })).counts.cosmetic, 0);
  set({ exclude: ['*'], characters: { 'a*': { keep: ['only'] } } });
  assert.ok((await painted()) > 0);
  set({ keep: ['only'], exclude: ['*'] });
  assert.ok((await painted()) > 0, 'said together, keep counts');
});

test('masks are paths from the folder of the file; those of characters and lines are added, and flags replace them', async () => {
  set({ alwaysMask: 'gone.png' });
  await fails(1, `${config}: "alwaysMask": ${at('gone.png')}: no such file`, transfer);
  await fails(1, 'other.png: no such file', `${transfer} --mask never=other.png`);
  write('white.png', png(255, 1));
  write('black.png', png(0, 1));
  set({});
  const all = await painted();
  set({ neverMask: 'white.png' });
  const masked = await painted(); // A vertex that no triangle has is beyond all masks.
  assert.ok(masked < all / 4);
  assert.equal(await painted(' --mask always=black.png'), all);
  assert.equal((await lineOf({ alwaysMask: 'black.png' })).counts.cosmetic, masked);
  set({ neverMask: 'white.png', characters: { 'a*': { alwaysMask: 'black.png' } } });
  assert.equal(await painted(), masked);
});

test('a file that was found may be a stranger’s: it is a regular file, and its masks are regular files beside it', async () => {
  const found = 'heads/cagecast.config.json';
  const refused = async (message: RegExp, flags = '') => {
    for (const line of [transfer, inspect]) await fails(1, message, `${line}${flags}`);
  };
  execFileSync('mkfifo', [found, 'heads/pipe.png']);
  await refused(/heads\/cagecast\.config\.json: is a device or a pipe, not a file\n$/);
  await ok(`${inspect} --config none`);
  rmSync(found);
  const outside =
    /heads\/cagecast\.config\.json: "neverMask": .*cage\.glb: is outside the folder of the file that refers to it; --allow-outside permits it\n$/;
  for (const neverMask of ['../cage.glb', at('cage.glb')]) {
    set({ neverMask }, found);
    await refused(outside);
    await refused(/cage\.glb: is not a PNG/, ' --allow-outside');
    // Who names the file knows what it says.
    await refused(/cage\.glb: is not a PNG/, ` --config ${found}`);
  }
  const batch = await run('batch heads/ada.glb --cage cage.glb --report {name}.json');
  assert.deepEqual([batch.status, /cage\.glb: is outside the folder/.test(batch.stdout)], [1, true]);
  symlinkSync(at('cage.glb'), 'heads/linked.png');
  set({ alwaysMask: 'linked.png' }, found);
  await refused(/linked\.png: is outside the folder/);
  set({ alwaysMask: 'pipe.png' }, found);
  await refused(/pipe\.png: is a device or a pipe, not a file/);
  rmSync(found);
  symlinkSync('gone.json', found);
  await refused(/^cagecast: heads\/cagecast\.config\.json: no such file\n$/);
  rmSync(found);
});

test('a batch takes the settings of each of its targets; a line of a manifest wins over them, and over flags', async () => {
  set({ threshold: 0.4, characters: { bao: { threshold: 0.9 } } });
  const { status, stderr } = await run('batch heads/ada.glb heads/bao.glb --cage cage.glb --report {name}.json');
  assert.equal(status, 0);
  assert.match(stderr, /; settings from cagecast\.config\.json\n$/);
  const job = { target: 'heads/ada.glb', cage: 'cage.glb', report: 'line.json', threshold: 0.1 };
  write('jobs.jsonl', JSON.stringify(job));
  assert.equal((await run('batch --manifest jobs.jsonl --threshold 0.7')).status, 0);
  const thresholds = ['ada', 'bao', 'line'].map((name) => JSON.parse(readFileSync(`${name}.json`, 'utf8')) as Report);
  assert.deepEqual(
    thresholds.map(({ options }) => options.threshold),
    [0.4, 0.9, 0.1],
  );
});

test('what is wrong in the file is one line that names file, member and value', async () => {
  for (const [text, message] of [
    ['{', /is not JSON/],
    ['[]', /is not a JSON object/],
    [
      '{"treshold": 1}',
      /"treshold" is unknown; there are: preset, borders, compress, keep, exclude, ignore, neverMask, alwaysMask, maskColors, .*threshold/,
    ],
    ['{"threshold": 3}', /"threshold" is 3, not a number within 0\.\.1/],
    ['{"threshold": 1e999}', /"threshold" is Infinity, not a number within 0\.\.1/],
    ['{"threshold": "Infinity"}', /"threshold" is "Infinity", not a number within 0\.\.1/],
    ['{"occlusionReach": "far"}', /"occlusionReach" is "far", not a number within 0\.\.Infinity/],
    ['{"seams": "edge"}', /"seams" is "edge", not one of vertex, corner/],
    ['{"preset": 1}', /"preset" is 1, not one of default, paper/],
    ['{"exclude": "eye"}', /"exclude" is "eye", not an array of names/],
    ['{"exclude": ["eye", ""]}', /"exclude" is \["eye",""\], not an array of names/],
    ['{"neverMask": 1}', /"neverMask" is 1, not a path/],
    ['{"neverMask": ""}', /"neverMask" is empty/],
    ['{"maskColors": "NORMAL"}', /"maskColors" is "NORMAL", not COLOR_0, COLOR_1, … or an attribute of an own name/],
    ['{"characters": []}', /"characters" is \[\], not an object of patterns and settings/],
    ['{"characters": {"a*": 1}}', /"characters" "a\*": is 1, not an object of settings/],
    [
      '{"characters": {"a*": {"borders": "soft"}}}',
      /"characters" "a\*": "borders" is "soft", not one of triangle, cut/,
    ],
  ] as const) {
    write(config, text);
    await fails(1, new RegExp(`^cagecast: cagecast\\.config\\.json: .*${message.source}`), inspect);
  }
  rmSync(config);
  await fails(1, 'gone.json: no such file', `${inspect} --config gone.json`);
  // Of a path through a file, the target is at fault, not its configuration.
  await fails(1, 'heads/ada.glb/x.glb: no such file', 'transfer heads/ada.glb/x.glb --cage cage.glb');
});
