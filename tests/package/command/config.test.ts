import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { before, test } from 'node:test';
import { PNG } from 'pngjs';
import { cagecast, glbOf, unpackGlb } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { head } from '../scenes.js';

const { at } = temporaryFolder('config');
const config = at('cagecast.config.json');
const scene = head(5, 8);
const cage = ['--cage', at('cage.glb')];

interface Options {
  preset: string;
  threshold: number;
  exclude: string[];
  config: string | null;
}

before(() => {
  mkdirSync(at('assets/heads'), { recursive: true });
  writeFileSync(at('cage.glb'), glbOf(scene.cage));
  for (const name of ['ada', 'bao'])
    writeFileSync(at('assets/heads', `${name}.glb`), glbOf({ ...scene.target, groups: undefined }));
});

const ada = at('assets/heads/ada.glb');
const set = (settings: object, path = config) => writeFileSync(path, JSON.stringify(settings));
const optionsOf = (...args: string[]): Options => {
  const { stdout, stderr } = cagecast(...args, ...cage, '--json');
  assert.equal(stderr, '');
  return (JSON.parse(stdout) as { options: Options }).options;
};

test('settings come from the nearest file above the target; characters by name win over all, and flags over both', () => {
  set({
    threshold: 0.4,
    exclude: ['no such part'],
    characters: { 'a*': { preset: 'paper', exclude: ['only'] }, 'ada.glb': { threshold: 0.3 } },
  });
  const own = optionsOf('transfer', ada);
  assert.deepEqual([own.preset, own.threshold, own.exclude], ['paper', 0.3, ['no such part', 'only']]);
  assert.equal(own.config, config);
  const other = optionsOf('inspect', at('assets/heads/bao.glb'));
  assert.deepEqual([other.preset, other.threshold], ['default', 0.4]);
  const won = optionsOf('transfer', ada, '--preset', 'default', '--threshold', '0.6');
  assert.deepEqual([won.preset, won.threshold, won.exclude.length], ['default', 0.6, 2]);
  // What a flag names must be there; what the file names need not.
  const { status, stderr } = cagecast('transfer', ada, ...cage, '--exclude', 'gone');
  assert.deepEqual([status, /--exclude gone/.test(stderr)], [1, true]);
  // Names that are numbers have their place, too.
  writeFileSync(at('assets/heads/101.glb'), readFileSync(ada));
  set({ characters: { '*': { threshold: 0.6 } } });
  writeFileSync(
    config,
    readFileSync(config, 'utf8').replace('}}}', '}, "n101": { "threshold": 0.9 }, "101" : { "threshold": 0.3 } } }'),
  );
  assert.equal(optionsOf('inspect', at('assets/heads/101.glb')).threshold, 0.3);
  rmSync(at('assets/heads/101.glb'));
});

test('--config names another file, --no-config none; the output says which file was used', () => {
  set({ threshold: 0.4 });
  set({ threshold: 0.2, borders: 'cut', compress: 'meshopt' }, at('other.json'));
  assert.equal(optionsOf('transfer', ada, '--no-config').config, null);
  assert.equal(optionsOf('transfer', ada, '--config', at('other.json')).threshold, 0.2);
  const written = cagecast('transfer', ada, ...cage, '--config', at('other.json'), '-o', at('out.glb'));
  assert.match(written.stdout, new RegExp(`settings from ${at('other.json')}\n$`));
  assert.match(written.stdout, /cut along borders/);
  assert.match(readFileSync(at('out.glb')).toString('latin1'), /EXT_meshopt_compression/);
  assert.match(cagecast('inspect', ada, ...cage).stdout, new RegExp(`settings from ${config}\n$`));
});

test('an occlusion reach without end is written as a text, in settings and in reports', () => {
  set({ occlusionReach: 'Infinity' });
  const { stdout, stderr } = cagecast('transfer', ada, ...cage, '--json');
  assert.equal(stderr, '');
  const { occlusionReach } = (JSON.parse(stdout) as { options: { occlusionReach: unknown } }).options;
  assert.equal(occlusionReach, 'Infinity');
});

test('masks are paths from the folder of the file; flags about masks replace them', () => {
  set({ alwaysMask: 'gone.png' });
  assert.match(
    cagecast('transfer', ada, ...cage).stderr,
    new RegExp(`^cagecast: ${config}: "alwaysMask": ${at('gone.png')}: no such file\n$`),
  );
  assert.match(cagecast('transfer', ada, ...cage, '--never-mask', at('other.png')).stderr, /other\.png: no such file/);
});

test('where a part is both kept and excluded, what is said later counts', () => {
  const { json } = unpackGlb(readFileSync(ada));
  const part = json.nodes!.find(({ mesh }) => mesh !== undefined)!.name!;
  const painted = (...args: string[]) => {
    const { status, stdout, stderr } = cagecast('transfer', ada, ...cage, '--json', ...args);
    assert.deepEqual([status, stderr], [0, '']);
    return (JSON.parse(stdout) as { counts: { cosmetic: number } }).counts.cosmetic > 0;
  };
  set({ keep: [part] });
  assert.deepEqual([painted(), painted('--exclude', part)], [true, false]);
  set({ exclude: ['*'], characters: { 'a*': { keep: [part] } } });
  assert.ok(painted());
  set({ keep: [part], exclude: ['*'] });
  assert.match(cagecast('transfer', ada, ...cage).stderr, new RegExp(`both match "${part}" \\(in ${config}\\)\n$`));
  set({ keep: [part] });
  writeFileSync(at('later.jsonl'), JSON.stringify({ target: ada, cage: 'cage.glb', exclude: [part] }));
  assert.match(cagecast('batch', '--manifest', at('later.jsonl')).stdout, /"cosmetic":0,/);
});

test('masks of a character and of a line of a manifest are added to those of the file', () => {
  const mask = (name: string, level: number) => {
    const png = Object.assign(new PNG({ width: 1, height: 1 }), { data: Buffer.from([level, level, level, 255]) });
    writeFileSync(at(name), PNG.sync.write(png));
  };
  mask('white.png', 255);
  mask('black.png', 0);
  const counts = (text: string) => (JSON.parse(text) as { counts: { cosmetic: number } }).counts.cosmetic;
  const transferred = () => counts(cagecast('transfer', ada, ...cage, '--json').stdout);
  set({});
  const all = transferred();
  set({ neverMask: 'white.png' });
  const masked = transferred(); // A vertex that no triangle has is beyond all masks.
  assert.ok(masked < all / 4);
  set({ neverMask: 'white.png', characters: { 'a*': { alwaysMask: 'black.png' } } });
  assert.equal(transferred(), masked);
  set({ neverMask: 'white.png' });
  writeFileSync(at('masks.jsonl'), JSON.stringify({ target: ada, cage: 'cage.glb', alwaysMask: 'black.png' }));
  assert.equal(counts(cagecast('batch', '--manifest', at('masks.jsonl')).stdout), masked);
});

test('a file that was found may be a stranger’s: it is a regular file, and its masks are regular files beside it', () => {
  const refused = (message: RegExp, ...flags: string[]) => {
    for (const command of ['transfer', 'inspect']) {
      const { status, stdout, stderr } = cagecast(command, ada, ...cage, ...flags);
      assert.deepEqual([status, stdout], [1, '']);
      assert.match(stderr, message);
    }
  };
  const inHeads = at('assets/heads/cagecast.config.json');
  spawnSync('mkfifo', [inHeads, at('assets/heads/pipe.png')]);
  refused(/heads\/cagecast\.config\.json: is a device or a pipe, not a file\n$/);
  assert.equal(cagecast('inspect', ada, ...cage, '--no-config').status, 0);
  rmSync(inHeads);
  const outside =
    /heads\/cagecast\.config\.json: "neverMask": .*cage\.glb: is outside the folder of the file that refers to it; --allow-outside permits it\n$/;
  for (const neverMask of ['../../cage.glb', at('cage.glb')]) {
    set({ neverMask }, inHeads);
    refused(outside);
    refused(/cage\.glb: is not a PNG/, '--allow-outside');
    // Who names the file knows what it says.
    refused(/cage\.glb: is not a PNG/, '--config', inHeads);
  }
  symlinkSync(at('cage.glb'), at('assets/heads/linked.png'));
  set({ alwaysMask: 'linked.png' }, inHeads);
  refused(/linked\.png: is outside the folder/);
  set({ alwaysMask: 'pipe.png' }, inHeads);
  refused(/pipe\.png: is a device or a pipe, not a file/);
  set({ neverMask: at('cage.glb') }, inHeads);
  const batch = cagecast('batch', ada, ...cage, '--report', at('{name}.json'));
  assert.deepEqual([batch.status, /cage\.glb: is outside the folder/.test(batch.stdout)], [1, true]);
  for (const name of ['cagecast.config.json', 'linked.png', 'pipe.png']) rmSync(at('assets/heads', name));
});

test('a batch takes the settings of each of its targets; a line of a manifest wins over them', () => {
  set({ threshold: 0.4, characters: { bao: { threshold: 0.9 } } });
  const report = ['--report', at('{name}.json')];
  const { status, stderr } = cagecast('batch', at('assets/heads/*.glb'), ...cage, ...report);
  assert.equal(status, 0);
  assert.match(stderr, new RegExp(`; settings from ${config}\n$`));
  const thresholdOf = (name: string) =>
    (JSON.parse(readFileSync(at(name), 'utf8')) as { options: Options }).options.threshold;
  assert.deepEqual(['ada.json', 'bao.json'].map(thresholdOf), [0.4, 0.9]);
  const line = { target: ada, cage: at('cage.glb'), report: at('line.json'), threshold: 0.1 };
  writeFileSync(at('jobs.jsonl'), JSON.stringify(line));
  assert.equal(cagecast('batch', '--manifest', at('jobs.jsonl'), '--threshold', '0.7').status, 0);
  assert.equal(thresholdOf('line.json'), 0.1);
});

test('what is wrong in the file is one line that names file, member and value', () => {
  const cases: [string, RegExp][] = [
    ['{', /is not JSON/],
    ['[]', /is not a JSON object/],
    [
      '{"treshold": 1}',
      /"treshold" is unknown; there are: preset, borders, compress, keep, exclude, neverMask, alwaysMask, maskColors, threshold, /,
    ],
    ['{"threshold": 3}', /"threshold" is 3, not a number within 0\.\.1/],
    ['{"seams": "edge"}', /"seams" is "edge", not one of vertex, corner/],
    ['{"preset": 1}', /"preset" is 1, not one of default, paper/],
    ['{"exclude": "eye"}', /"exclude" is "eye", not an array of names/],
    ['{"threshold": 1e999}', /"threshold" is Infinity, not a number within 0\.\.1/],
    ['{"occlusionReach": "far"}', /"occlusionReach" is "far", not a number within 0\.\.Infinity/],
    ['{"threshold": "Infinity"}', /"threshold" is "Infinity", not a number within 0\.\.1/],
    ['{"neverMask": 1}', /"neverMask" is 1, not a path/],
    ['{"neverMask": ""}', /"neverMask" is empty/],
    ['{"maskColors": "NORMAL"}', /"maskColors" is "NORMAL", not COLOR_0, COLOR_1, … or an attribute of an own name/],
    ['{"characters": []}', /"characters" is \[\], not an object of patterns and settings/],
    ['{"characters": {"a*": 1}}', /"characters" "a\*": is 1, not an object of settings/],
    [
      '{"characters": {"a*": {"borders": "soft"}}}',
      /"characters" "a\*": "borders" is "soft", not one of triangle, cut/,
    ],
  ];
  for (const [text, message] of cases) {
    writeFileSync(config, text);
    const { status, stdout, stderr } = cagecast('inspect', ada, ...cage);
    assert.deepEqual([status, stdout], [1, ''], text);
    assert.match(stderr, message);
    assert.match(stderr, /^cagecast: [^\n]*cagecast\.config\.json: [^\n]+\n$/);
  }
  const gone = cagecast('inspect', ada, ...cage, '--config', at('gone.json'));
  assert.match(gone.stderr, /gone\.json: no such file\n$/);
  rmSync(config);
});

test('completion offers the commands, their flags and the choices of a flag; docs/cli.md lists the same', () => {
  const script = cagecast('completion', 'bash').stdout;
  const completed = (...words: string[]) => {
    const run = `${script}\nCOMP_WORDS=(${words.map((word) => `'${word}'`).join(' ')}); COMP_CWORD=${words.length - 1}\n_cagecast; printf '%s\\n' "\${COMPREPLY[@]}"`;
    const { status, stdout, stderr } = spawnSync('bash', ['-c', run], { encoding: 'utf8' });
    assert.deepEqual([status, stderr], [0, '']);
    return stdout.split('\n').filter(Boolean);
  };
  assert.deepEqual(completed('cagecast', 'tr'), ['transfer']);
  assert.deepEqual(completed('cagecast', 'transfer', '--borders', ''), ['triangle', 'cut']);
  assert.deepEqual(completed('cagecast', 'batch', '--res'), ['--results', '--resume']);
  assert.deepEqual(completed('cagecast', 'transfer', 'fi'), [], 'files are offered by the shell itself');
  const [zsh, fish] = [cagecast('completion', 'zsh').stdout, cagecast('completion', 'fish').stdout];
  const page = readFileSync('docs/cli.md', 'utf8');
  const flags = cagecast('help', 'batch')
    .stdout.match(/^ +(-\w, )?--[\w-]+/gm)!
    .map((line) => line.trim().split(' ').at(-1)!);
  assert.ok(flags.length > 15);
  for (const flag of flags) {
    assert.ok(zsh.includes(`*${flag}[`), flag);
    assert.ok(fish.includes(` -l ${flag.slice(2)} `), flag);
    assert.ok(page.slice(page.indexOf('## cagecast batch')).includes(flag), flag);
  }
  const wrong = cagecast('completion', 'tcsh');
  assert.deepEqual([wrong.status, /There are: bash, zsh, fish\./.test(wrong.stderr)], [2, true]);
});

test('a configuration that is a link to nothing is an error', () => {
  rmSync(config, { force: true });
  symlinkSync('gone.json', config);
  const { status, stdout, stderr } = cagecast('transfer', ada, ...cage);
  rmSync(config);
  assert.deepEqual([status, stdout], [1, '']);
  assert.match(stderr, /^cagecast: [^\n]*cagecast\.config\.json: no such file\n$/);
});

test('of a path through a file, the target is at fault, not its configuration', () => {
  const { status, stdout, stderr } = cagecast('transfer', join(ada, 'x.glb'), ...cage);
  assert.deepEqual([status, stdout], [1, '']);
  assert.match(stderr, /^cagecast: [^\n]*x\.glb: [^\n]*\n$/);
});
