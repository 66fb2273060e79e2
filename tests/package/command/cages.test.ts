import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { before, describe, test } from 'node:test';
import { cagecast, GlbMaker, glbOf, packGlb, unpackGlb, validate } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { ball } from '../scenes.js';

const { folder, at } = temporaryFolder('cages');
const write = (name: string, data: Uint8Array | string) => {
  writeFileSync(at(name), data);
  return at(name);
};

const skin = () => ball([0, 0, 0], (_, theta) => 1 + 0.1 * Math.cos(theta), 12, 24);
const eye = (x: number) => ball([x, -0.85, 0.2], () => 0.18, 8, 16);

/** A head of three nodes, whose eyes are known by the names of a node and of a material. */
function headFile(): Buffer {
  const maker = new GlbMaker();
  maker.json.materials = [{ name: 'EyeWhite' }];
  maker.node({ name: 'skin', mesh: maker.mesh(skin()) });
  maker.node({ name: 'Eye.L', mesh: maker.mesh(eye(0.35)) });
  maker.node({ name: 'ball', mesh: maker.mesh(eye(-0.35), { material: 0 }) });
  return maker.finish();
}

before(() => {
  write('head.glb', headFile());
  write('plain.glb', glbOf(skin()));
});

/** The files of the folder, to show that a command has written none. */
const files = () => readdirSync(folder).sort();

describe('cagecast make', () => {
  test('writes a cage with holes over the eyes, a report, and the verdict', async () => {
    const { status, stdout, stderr } = cagecast(
      'make',
      at('head.glb'),
      '-o',
      at('cage.glb'),
      '--html',
      at('page.html'),
    );
    assert.equal(stderr, '');
    assert.equal(status, 0, stdout);
    assert.match(stdout, /^wrote .*cage\.glb: \d+ vertices, [\d,]+ triangles, \d+ charts?, 2 holes\n/);
    assert.match(stdout, /^(GOOD|USABLE): the cage fits/m);
    assert.match(stdout, /^wrote .*page\.html$/m);
    assert.match(readFileSync(at('page.html'), 'utf8'), /<h2>Holes<\/h2>/);
    assert.deepEqual(await validate(at('cage.glb')), []);
    const { json } = unpackGlb(readFileSync(at('cage.glb')));
    assert.equal(json.nodes![0]!.name, 'cage');
    assert.deepEqual(Object.keys(json.nodes![0]!.extras!).sort(), ['holes', 'kind', 'landmarks']);
    const inspected = cagecast('inspect', at('head.glb'), '--cage', at('cage.glb'));
    assert.equal(inspected.status, 0, inspected.stdout);
  });

  test('--exclude replaces the list of names, --triangles sets the size', () => {
    const { status, stdout, stderr } = cagecast(
      ...['make', at('head.glb'), '--exclude', 'eye.*', '--triangles', '300', '-o', at('one.glb')],
    );
    assert.equal(status, 0, stderr);
    assert.match(stdout, /, 1 hole$/m);
    // A word of a name is enough: Eye.L, EyeWhite.
    const words = cagecast(...['make', at('head.glb'), '--exclude', 'eye', '--triangles', '300', '-o', at('two.glb')]);
    assert.equal(words.status, 0, words.stderr);
    assert.match(words.stdout, /, 2 holes$/m);
    const { json, bin } = unpackGlb(headFile());
    json.scenes![0]!.nodes = [0, json.nodes!.push({ name: 'The Lookers', children: [1, 2] }) - 1];
    const held = write('held.glb', packGlb({ json, bin }));
    const all = cagecast(...['make', held, '--exclude', 'lookers', '--triangles', '300', '-o', at('held-cage.glb')]);
    assert.deepEqual([all.stderr, /, 2 holes$/m.test(all.stdout)], ['', true], 'names of nodes above them are known');
    const none = cagecast(...['make', at('head.glb'), '--exclude', '', '--triangles', '300', '-o', at('none.glb')]);
    assert.deepEqual([none.stderr, /, 0 holes$/m.test(none.stdout)], ['', true]);
    const triangles = unpackGlb(readFileSync(at('one.glb'))).json.accessors![2]!.count / 3;
    assert.ok(triangles > 200 && triangles < 400, `${triangles}`);
  });

  test('--kind and --closing are those of the model', () => {
    const { status, stderr } = cagecast(
      ...['make', at('head.glb'), '--kind', 'prop', '--closing', '0.03', '--triangles', '300', '-o', at('kind.glb')],
    );
    assert.equal(status, 0, stderr);
    assert.equal(unpackGlb(readFileSync(at('kind.glb'))).json.nodes![0]!.extras!['kind'], 'prop');
    // Two balls are one model if the gap between them may be bridged.
    const two = new GlbMaker();
    for (const x of [0, 3.4]) two.node({ name: 'ball', mesh: two.mesh(ball([x, 0, 0], () => 1, 12, 24)) });
    write('two.glb', two.finish());
    const apart = cagecast('make', at('two.glb'), '-o', at('apart.glb'));
    assert.equal(apart.status, 1, apart.stdout);
    assert.match(
      apart.stderr,
      /two\.glb: model is in pieces that lie too far apart for one cage: .*, or bridge wider gaps\n$/,
    );
    const bridged = cagecast('make', at('two.glb'), '--closing', '0.15', '-o', at('bridged.glb'));
    assert.equal(bridged.status, 0, bridged.stderr);
  });

  test('exits 3 and still writes the cage if it is unfit', () => {
    // Everything is to be left out: nothing may be painted.
    const { status, stdout, stderr } = cagecast('make', at('plain.glb'), '--exclude', 'only', '-o', at('unfit.glb'));
    if (status === 1) assert.match(stderr, /^cagecast: .*plain\.glb: /);
    else {
      assert.equal(status, 3, stdout);
      assert.ok(existsSync(at('unfit.glb')));
    }
  });

  test('errors are one line that names the file, and write nothing', () => {
    const nan = skin();
    nan.positions[3] = Number.NaN;
    write('nan.glb', glbOf(nan));
    write('empty.glb', new Uint8Array(0));
    write('text.glb', 'this is no model');
    write('points.glb', glbOf({ ...skin(), mode: 0 }));
    const out = at('never.glb');
    const before = files();
    for (const [args, status, says] of [
      [['make'], 2, /missing required argument 'TARGET'|required option/],
      [['make', at('head.glb')], 2, /required option '-o, --output <CAGE\.glb>' not specified/],
      [['make', at('head.glb'), '-o', at('cage.obj')], 2, /Its name must end in \.glb/],
      [['make', at('head.glb'), '-o', out, '--triangles', '7'], 2, /not a whole number within 50\.\.20000/],
      [['make', at('head.glb'), '-o', out, '--closing', '0.3'], 2, /It is not a number within 0\.0005\.\.0\.2/],
      [['make', at('head.glb'), '-o', out, '--closing', ''], 2, /It is not a number within 0\.0005\.\.0\.2/],
      [['make', at('head.glb'), '-o', out, '--kind', 'hand'], 2, /Allowed choices are automatic, head, body, prop/],
      [['make', at('head.glb'), '-o', out, '--html', at('page.txt')], 2, /Its name must end in \.html/],
      [
        ['make', at('head.glb'), '-o', at('head.glb')],
        2,
        /head\.glb would overwrite .*head\.glb, which this command reads/,
      ],
      [['make', at('missing.glb'), '-o', out], 1, /missing\.glb: no such file/],
      [['make', at('empty.glb'), '-o', out], 1, /empty\.glb: the file is empty/],
      [['make', at('text.glb'), '-o', out], 1, /text\.glb: is neither a GLB nor a glTF file/],
      [['make', at('points.glb'), '-o', out], 1, /points\.glb: has no triangles in its scene/],
      [['make', at('nan.glb'), '-o', out], 1, /nan\.glb: meshes\[0\]\.primitives\[0\]: POSITION of vertex 1 has NaN/],
      [
        ['make', at('head.glb'), '--exclude', 'nose*', '-o', out],
        1,
        /head\.glb: --exclude nose\*: no node or material has this name; there are: skin, Eye\.L, ball, EyeWhite/,
      ],
      [
        ['make', at('head.glb'), '-o', join(folder, 'no/such.glb')],
        1,
        /such\.glb: cannot be written \(its folder does not exist\)/,
      ],
    ] satisfies [string[], number, RegExp][]) {
      const done = cagecast(...args);
      assert.equal(done.status, status, `${args.join(' ')}: ${done.stderr}`);
      assert.match(done.stderr, says);
      assert.match(done.stderr, /^cagecast: [^\n]+\n$/);
      assert.equal(done.stdout, '');
    }
    assert.deepEqual(files(), before);
  });
});

describe('cagecast transfer --cage auto', () => {
  test('makes a cage on the way', () => {
    const { status, stdout, stderr } = cagecast('transfer', at('head.glb'), '--cage', 'auto', '-o', at('auto.glb'));
    assert.equal(status, 0, stderr);
    assert.match(stdout, /3 segments \(2 culled\)/);
    const { meshes } = unpackGlb(readFileSync(at('auto.glb'))).json;
    assert.ok(meshes!.every(({ primitives }) => primitives[0]!.attributes['TEXCOORD_1'] !== undefined));
  });

  test('paints nothing of the parts that the cage is made without, unless they are to be kept', () => {
    const lizard = 'examples/samples/lizard/target.glb';
    const { status, stdout, stderr } = cagecast(
      'transfer',
      lizard,
      '--cage',
      'auto',
      '--keep',
      'upper-teeth',
      '--json',
    );
    assert.deepEqual([status, stderr], [0, '']);
    const { parts, cage } = JSON.parse(stdout) as {
      parts: { name: string; counts: { cosmetic: number } }[];
      cage: { excluded: string[] };
    };
    const painted = parts.filter(({ counts }) => counts.cosmetic > 0).map(({ name }) => name);
    assert.deepEqual(painted, ['skin', 'upper-teeth']);
    const others = parts.map(({ name }) => name).filter((name) => !painted.includes(name));
    assert.deepEqual(cage.excluded, others, 'the report says which');
  });

  test('says which parts it is made without', () => {
    const lizard = (name: string) => `examples/samples/lizard/${name}.glb`;
    for (const command of ['transfer', 'inspect']) {
      const { stdout } = cagecast(command, at('head.glb'), '--cage', 'auto');
      assert.match(stdout, /^excluded from the cage by their names: Eye\.L, ball$/m, command);
      const kept = cagecast(command, at('head.glb'), '--cage', 'auto', '--keep', 'Eye*');
      assert.doesNotMatch(kept.stdout, /excluded/, command);
      const own = cagecast(command, lizard('target'), '--cage', lizard('cage'), '--json');
      const { cage } = JSON.parse(own.stdout) as { cage: object };
      assert.deepEqual(Object.keys(cage), ['file', 'vertices', 'triangles'], command);
    }
  });
});

describe('cagecast fit', () => {
  const target = 'examples/samples/human/target.glb';

  test('writes the template moved onto the model, and what it was moved by', async () => {
    const { status, stdout, stderr } = cagecast(
      'fit',
      'human-head',
      target,
      '-o',
      at('fit.glb'),
      '--html',
      at('fit.html'),
    );
    assert.equal(stderr, '');
    assert.equal(status, 0, stdout);
    assert.match(
      stdout,
      /^wrote .*fit\.glb: \d+ vertices, \d+ triangles, 1 chart, 4 holes\nlandmarks: \d+ used, 0 of them given\nfound, but not certain \(1 would be\): forehead \(0\.\d\d\), /,
    );
    assert.match(stdout, /^(GOOD|USABLE): the cage fits/m);
    // Of a cage that is good, nothing is asked for.
    assert.equal(/^give these for a better fit: --landmarks L\.json$/m.test(stdout), !/^GOOD/m.test(stdout));
    assert.ok(existsSync(at('fit.html')));
    assert.deepEqual(await validate(at('fit.glb')), []);
    // What was written is a template itself.
    const again = cagecast('fit', at('fit.glb'), target, '-o', at('again.glb'));
    assert.equal(again.status, 0, again.stderr);
  });

  test('takes landmarks of the template and of the model from files', () => {
    const { extras } = unpackGlb(readFileSync('examples/samples/templates/human-head.glb')).json.meshes![0]!;
    const { landmarks } = extras as { landmarks: Record<string, number[]> };
    write('landmarks.json', JSON.stringify(landmarks));
    const { nose_tip, chin } = landmarks;
    write('some.json', JSON.stringify({ nose_tip, chin }));
    const bare = unpackGlb(readFileSync('examples/samples/templates/human-head.glb'));
    delete bare.json.meshes![0]!.extras;
    write('bare.glb', packGlb(bare));
    const { status, stdout, stderr } = cagecast(
      ...['fit', at('bare.glb'), target, '-o', at('given.glb')],
      ...['--template-landmarks', at('landmarks.json'), '--landmarks', at('some.json')],
    );
    assert.equal(status, 0, stderr);
    assert.match(stdout, /^landmarks: \d+ used, 2 of them given$/m);
    // A program gets all of them, and the parts that are left out can be chosen.
    const listed = cagecast('fit', 'human-head', target, '-o', at('listed.glb'), '--exclude', '*eye*', '--json');
    assert.equal(listed.status, 0, listed.stderr);
    const report = JSON.parse(listed.stdout) as { landmarks: { used: object; confidence: object; missing: string[] } };
    assert.ok(Object.keys(report.landmarks.used).length > 12);
    assert.deepEqual(Object.keys(report.landmarks.confidence), Object.keys(report.landmarks.used));
    assert.ok(Array.isArray(report.landmarks.missing));
  });

  test('a template may come from the standard input', () => {
    const { status, stderr } = spawnSync(
      process.execPath,
      ['dist/cli.js', 'fit', '-', target, '-o', at('piped.glb'), '--quiet'],
      { input: readFileSync('dist/templates/human-head.glb'), encoding: 'utf8' },
    );
    assert.equal(stderr, '');
    assert.equal(status, 0);
    assert.equal(cagecast('fit', 'human-head', target, '-o', at('named.glb'), '--quiet').status, 0);
    assert.deepEqual(readFileSync(at('piped.glb')), readFileSync(at('named.glb')));
  });

  test('a folder with the name of a template does not hide it', () => {
    mkdirSync(at('human-head'));
    const { status, stderr } = spawnSync(
      process.execPath,
      [resolve('dist/cli.js'), 'fit', 'human-head', resolve(target), '-o', at('beside-folder.glb'), '--quiet'],
      { cwd: folder, encoding: 'utf8' },
    );
    assert.deepEqual([status, stderr], [0, '']);
  });

  test('errors are one line that names the file, and write nothing', () => {
    write('no.json', '{');
    write('list.json', '[1, 2]');
    write('flat.json', '{ "chin": 3 }');
    write('empty.json', '{}');
    const bare = unpackGlb(readFileSync('examples/samples/templates/human-head.glb'));
    delete bare.json.meshes![0]!.extras;
    write('bare.glb', packGlb(bare));
    bare.json.meshes![0]!.extras = { landmarks: { chin: [0, 0, 0] } };
    write('few.glb', packGlb(bare));
    bare.json.meshes![0]!.extras = { landmarks: { chin: [0] } };
    write('odd.glb', packGlb(bare));
    const { uvs: _, ...noUvs } = skin();
    write('no-uvs.glb', glbOf(noUvs));
    const out = at('never.glb');
    const before = files();
    for (const [args, status, says] of [
      [['human-head'], 2, /missing required argument 'TARGET'|required option/],
      [['human', target, '-o', out], 1, /human: no such file, and no template of the package: there are human-head, /],
      [['human-head', target], 2, /required option '-o, --output <CAGE\.glb>' not specified/],
      [[at('bare.glb'), target, '-o', at('bare.glb')], 2, /would overwrite .*bare\.glb, which this command reads/],
      [
        [at('bare.glb'), target, '-o', out],
        1,
        /bare\.glb: has no landmarks in the extras of its nodes and meshes; give at least 4 .*--template-landmarks T\.json/,
      ],
      [
        [at('few.glb'), target, '-o', out],
        1,
        /few\.glb: has 1 landmark in the extras .*; give at least 4 .*--template-landmarks T\.json/,
      ],
      [[at('odd.glb'), target, '-o', out], 1, /odd\.glb: meshes\[0\]\.extras\.landmarks\.chin is not 3 finite numbers/],
      [
        [at('no-uvs.glb'), target, '-o', out],
        1,
        /no-uvs\.glb: meshes\[0\]\.primitives\[0\] \("only"\) has no TEXCOORD_0/,
      ],
      [['human-head', at('missing.glb'), '-o', out], 1, /missing\.glb: no such file/],
      [
        ['human-head', target, '--exclude', 'antler', '-o', out],
        1,
        /target\.glb: --exclude antler: no node or material/,
      ],
      [['human-head', target, '--landmarks', at('missing.json'), '-o', out], 1, /missing\.json: no such file/],
      [['human-head', target, '--landmarks', at('no.json'), '-o', out], 1, /no\.json: is not JSON \(/],
      [['human-head', target, '--landmarks', at('list.json'), '-o', out], 1, /list\.json: is not a JSON object/],
      [
        ['human-head', target, '--landmarks', at('flat.json'), '-o', out],
        1,
        /flat\.json: "chin" is .+, not 3 numbers \[x, y, z\]/,
      ],
      [
        ['human-head', target, '--template-landmarks', at('empty.json'), '-o', out],
        1,
        /empty\.json: has no landmarks; at least 4 are needed\n$/,
      ],
    ] satisfies [string[], number, RegExp][]) {
      const done = cagecast('fit', ...args);
      assert.equal(done.status, status, `${args.join(' ')}: ${done.stderr}`);
      assert.match(done.stderr, says);
      assert.match(done.stderr, /^cagecast: [^\n]+\n$/);
      assert.equal(done.stdout, '');
    }
    assert.deepEqual(files(), before);
  });
});
