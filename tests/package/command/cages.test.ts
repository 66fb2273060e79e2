// make, fit, and cages that transfer makes on its way.
import assert from 'node:assert/strict';
import { copyFileSync, existsSync, mkdirSync, readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { fails, json, ok, run } from '../../support/command.js';
import { type GlbMaker, glbOf, unpackGlb, validate } from '../../support/gltf.js';
import { ball } from '../scenes.js';
import { inRepository, jsonOf, workplace, write, writeChanged, writeMade } from './workplace.js';

workplace('cages');
const human = inRepository('examples/samples/human/target.glb');
const template = readFileSync(inRepository('examples/samples/templates/human-head.glb'));
const skin = () => ball([0, 0, 0], (_, theta) => 1 + 0.1 * Math.cos(theta), 12, 24);
const eye = (x: number) => ball([x, -0.85, 0.2], () => 0.18, 8, 16);

/** A head of three nodes, whose eyes are known by the names of a node and of a material. */
function makeHead(maker: GlbMaker): void {
  maker.json.materials = [{ name: 'EyeWhite' }];
  maker.node({ name: 'skin', mesh: maker.mesh(skin()) });
  maker.node({ name: 'Eye.L', mesh: maker.mesh(eye(0.35)) });
  maker.node({ name: 'ball', mesh: maker.mesh(eye(-0.35), { material: 0 }) });
}
writeMade('head.glb', makeHead);

test('make writes a cage with holes over the eyes, a report, and the verdict', async () => {
  const stdout = await ok('make head.glb -o cage.glb --report page.html --triangles 300');
  assert.match(stdout, /^wrote cage\.glb: \d+ vertices, [\d,]+ triangles, \d+ charts?, 2 holes\n/);
  assert.match(stdout, /^(GOOD|USABLE): the cage fits/m);
  assert.match(stdout, /^wrote page\.html$/m);
  assert.match(readFileSync('page.html', 'utf8'), /<h2>Holes<\/h2>/);
  assert.deepEqual(await validate('cage.glb'), []);
  const [{ name, extras }] = jsonOf('cage.glb').nodes as [{ name: string; extras: object }];
  assert.deepEqual([name, Object.keys(extras).sort()], ['cage', ['bare', 'holes', 'kind', 'landmarks']]);
  assert.deepEqual((extras as { bare: string[] }).bare, ['Eye.L', 'ball', 'EyeWhite']);
});

test('make: --exclude and --keep say more than names, and --closing, --kind and --triangles say what is made', async () => {
  writeMade('held.glb', (maker) => {
    makeHead(maker);
    maker.json.scenes![0]!.nodes = [0, maker.node({ name: 'The Lookers', children: [1, 2] })];
  });
  const stdout = await ok('make held.glb --triangles 300 -o out.glb --exclude', 'the lookers');
  assert.match(stdout, /, 2 holes$/m, 'names of nodes above parts are known');
  const { target } = await json<{ target: { bare: string[] } }>('transfer held.glb --cage out.glb');
  assert.deepEqual(target.bare, ['Eye.L', 'ball'], 'and still by who uses the cage');
  writeMade('eyes.glb', (maker) => {
    for (const x of [0, 3.4]) maker.node({ name: 'eye', mesh: maker.mesh(ball([x, 0, 0], () => 1, 12, 24)) });
  });
  // Apart, they are no single model.
  const bridged = await ok('make eyes.glb --closing 0.15 --kind prop --triangles 300 -o out.glb --keep *');
  assert.match(bridged, /, 0 holes$/m, 'all is kept');
  const { nodes, accessors } = jsonOf('out.glb');
  assert.equal(nodes![0]!.extras!['kind'], 'prop');
  const triangles = accessors![2]!.count / 3;
  assert.ok(triangles > 200 && triangles < 400, `${triangles}`);
});

test('transfer and inspect --cage auto: they say which parts the cage is made without, unless those are kept', async () => {
  const stdout = await ok('transfer head.glb --cage auto --keep EyeWhite -o auto.glb --report auto.json');
  assert.match(stdout, /^bare by their names, unless --keep names them: Eye\.L$/m);
  const { parts } = JSON.parse(readFileSync('auto.json', 'utf8')) as {
    parts: { name: string; counts: { cosmetic: number }; uvSet: string }[];
  };
  assert.deepEqual(
    parts.map(({ name, counts, uvSet }) => [name, counts.cosmetic > 0, uvSet]),
    [
      ['skin', true, 'TEXCOORD_1'],
      ['Eye.L', false, 'TEXCOORD_1'],
      ['ball', true, 'TEXCOORD_1'],
    ],
  );
  const inspected = await run('inspect head.glb --cage auto');
  assert.match(inspected.stdout, /^bare by their names, unless --keep names them: Eye\.L, ball$/m);
  // A file named auto is read if its path says so.
  copyFileSync('cage.glb', 'auto');
  assert.match(
    await ok('transfer head.glb --cage ./auto'),
    /^bare by their names, unless --keep names them: Eye\.L, ball$/m,
  );
});

test('fit writes the template moved onto the model, and says what it was moved by', async () => {
  mkdirSync('human-head'); // a folder with the name of a template does not hide it
  const stdout = await ok(`fit ${human} --template human-head -o fit.glb --report fit.html`);
  assert.match(
    stdout,
    /^wrote fit\.glb: \d+ vertices, \d+ triangles, 1 chart, 4 holes\nlandmarks: \d+ used, 0 of them given\nfound, but not certain \(1 would be\): forehead \(0\.\d\d\), /,
  );
  assert.match(stdout, /^(GOOD|USABLE): the cage fits/m);
  // Of a cage that is good, nothing is asked for.
  assert.equal(/^give these for a better fit: --landmarks L\.json$/m.test(stdout), !/^GOOD/m.test(stdout));
  assert.deepEqual(await validate('fit.glb'), []);
});

test('fit takes landmarks of the template and of the model from files', async () => {
  const { landmarks } = unpackGlb(template).json.meshes![0]!.extras as { landmarks: Record<string, number[]> };
  write('landmarks.json', JSON.stringify(landmarks));
  write('some.json', JSON.stringify({ nose_tip: landmarks['nose_tip'], chin: landmarks['chin'] }));
  writeChanged('bare.glb', template, (json) => delete json.meshes![0]!.extras);
  const files = '--landmarks template=landmarks.json --landmarks some.json';
  assert.match(
    await ok(`fit ${human} --template bare.glb -o given.glb ${files}`),
    /^landmarks: \d+ used, 2 of them given$/m,
  );
});

test('a cage that is unfit is written, too, and the exit code is 3; a program gets all landmarks', async () => {
  write('plain.glb', glbOf(skin()));
  // A face within the ball.
  const eyes = { eye_centre_left: [0.3, 0, 0.1], eye_centre_right: [-0.3, 0, 0.1] };
  const wrong = { ...eyes, nose_tip: [0, -0.1, 0.2], lip_lower: [0, -0.3, 0.1], chin: [0, -0.5, 0.125] };
  write('wrong.json', JSON.stringify(wrong));
  // What fit has written is a template itself.
  const { landmarks, verdict } = await json<{
    landmarks: { used: Record<string, number[]>; confidence: object; missing: string[] };
    verdict: string;
  }>('fit plain.glb --template fit.glb --landmarks wrong.json -o unfit.glb', 3);
  assert.deepEqual([verdict, existsSync('unfit.glb')], ['unfit', true]);
  assert.deepEqual(landmarks.used['chin'], wrong.chin);
  assert.deepEqual(Object.keys(landmarks.confidence), Object.keys(landmarks.used));
  assert.ok(landmarks.missing.length > 12, 'more than a text would list');
});

test('errors are one line that names the file, and write nothing', async () => {
  for (const [name, text] of Object.entries({ no: '{', list: '[1, 2]', flat: '{ "chin": 3 }', none: '{}' }))
    write(`${name}.json`, text);
  for (const [name, chin] of [['few', [0, 0, 0]] as const, ['odd', [0]] as const])
    writeChanged(`${name}.glb`, template, (json) => (json.meshes![0]!.extras = { landmarks: { chin } }));
  const files = readdirSync('.').sort();
  const fit = (path: string, flags = '') => `fit ${human} --template ${path} -o never.glb${flags}`;
  for (const [line, message] of [
    ['make missing.glb -o never.glb', /missing\.glb: no such file/],
    [
      `transfer ${human} --cage human-head`,
      /human-head: no such file; to fit the template of this name, give --template human-head/,
    ],
    ['make no.json -o never.glb', /no\.json: is neither a GLB or glTF file nor one of FBX|no\.json: is /],
    ['fit missing.glb --template human-head -o never.glb', /missing\.glb: no such file/],
    [fit('human'), /human: no such file, and no template of the package: there are human-head, /],
    [fit('bare.glb'), /bare\.glb: has no landmarks in the extras .*; give at least 4 .*--landmarks template=T\.json/],
    [fit('few.glb'), /few\.glb: has 1 landmark in the extras .*; give at least 4 .*--landmarks template=T\.json/],
    [fit('odd.glb'), /odd\.glb: meshes\[0\]\.extras\.landmarks\.chin is not 3 finite numbers/],
    [fit('human-head', ' --exclude antler'), /target\.glb: --exclude antler: nothing has this name/],
    [fit('human-head', ' --landmarks missing.json'), /missing\.json: no such file/],
    [fit('human-head', ' --landmarks no.json'), /no\.json: is not JSON \(/],
    [fit('human-head', ' --landmarks list.json'), /list\.json: is not a JSON object/],
    [fit('human-head', ' --landmarks flat.json'), /flat\.json: "chin" is 3, not 3 numbers \[x, y, z\]/],
    [fit('human-head', ' --landmarks template=none.json'), /none\.json: has no landmarks; at least 4 are needed\n$/],
  ] as const)
    await fails(1, message, line);
  assert.deepEqual(readdirSync('.').sort(), files);
});
