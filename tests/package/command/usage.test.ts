import assert from 'node:assert/strict';
import { chmodSync, existsSync, lstatSync, mkdirSync, readdirSync, readFileSync, symlinkSync } from 'node:fs';
import { test } from 'node:test';
import { cagecast, fails, json, ok, run, runCommand } from '../../support/command.js';
import { GlbMaker, glbOf } from '../../support/gltf.js';
import { head } from '../scenes.js';
import { inRepository, workplace, write, writeChanged } from './workplace.js';

const { target } = workplace('usage');

test('--version prints the version of package.json; help is a flag and a command, with examples', async () => {
  const { version } = JSON.parse(readFileSync(inRepository('package.json'), 'utf8')) as { version: string };
  assert.equal(await ok('--version'), `${version}\n`);
  for (const line of ['--help', 'help', 'transfer --help', ...(await commands()).map((name) => `help ${name}`)])
    assert.match(await ok(line), /^Usage: cagecast.*Example/s, line);
  assert.match(
    (await ok('help transfer')).replace(/\s+/g, ' '),
    /as in code: preset .*, seams \(default: corner\), .*pokeThrough \(default: 0\.0025\)/,
  );
});

const commands = async () => [...(await ok('help')).matchAll(/^ {2}(\w+) .*(?=<|\[TARG)/gm)].map(([, name]) => name!);

test('without a command it shows its help and exits 2', async () => {
  const { status, stderr } = await cagecast();
  assert.equal(status, 2);
  assert.match(stderr, /Usage: cagecast/);
});

test('every command has --json and --quiet, and the flags that docs/cli.md lists', async () => {
  const names = await commands();
  assert.deepEqual(names, ['transfer', 'inspect', 'bake', 'relay', 'make', 'fit', 'batch', 'diff', 'thumbnail']);
  const page = readFileSync(inRepository('docs/cli.md'), 'utf8').split(/^## /m);
  const sectionOf = (heading: string) => page.find((one) => one.toLowerCase().startsWith(`${heading}\n`))!;
  for (const name of names) {
    const help = await ok(`help ${name}`);
    assert.match(help, /--json .*\n +--quiet /, name);
    const own = sectionOf(`cagecast ${name}`);
    const links = /^Also: .*$/m.exec(own)![0].matchAll(/\[([^\]]*)\]/g);
    const listed = [own, ...[...links].map(([, heading]) => sectionOf(heading!))].join('');
    const taken = help.match(/(?<=^ {2}(-\w, )?)--(?!help)[\w-]+/gm)!;
    assert.deepEqual(listed.match(/(?<=^\| `(-\w, )?)--[\w-]+/gm)!.sort(), taken.sort(), name);
  }
});

// A space at the end, or two, is an empty argument.
const transfer = 'transfer target.glb --cage cage.glb';
const batch = 'batch target.glb --cage cage.glb';
const wrong: [line: string, message: RegExp][] = [
  ['transmogrify', /unknown command 'transmogrify'/],
  ['transfer', /missing required argument 'TARGET'|required option/],
  [`${transfer} extra.glb -o out.glb`, /too many arguments/],
  [`${transfer} --colour red`, /unknown option '--colour'$/m],
  [`${transfer} --weld-tolerance 0`, /unknown option '--weld-tolerance'; it is set by --set weldTolerance=VALUE/],
  [`${transfer} --threshold 2`, /--threshold.*'2' is invalid.*not a number within 0\.\.1/],
  [`${transfer} --threshold half`, /not a number within 0\.\.1/],
  [`${transfer} --threshold `, /not a number within 0\.\.1/],
  [`${transfer} --set weldTolerance=1`, /"weldTolerance" is 1, not a number within 0\.\.0\.01/],
  [
    `${transfer} --set tint=1`,
    /There are preset, seams, weldTolerance, occlusionReach, pokeThrough, motion, minCovered, cageUvs, uvBounds, referenceCage\./,
  ],
  [`${transfer} --set occlusionReach=-1`, /not a number within 0\.\.Infinity/],
  [`${transfer} --set minCovered=2`, /not a number within 0\.\.1/],
  [`${transfer} --set seams=none`, /"seams" is "none", not one of vertex, corner/],
  [`${transfer} --set preset=papre`, /"preset" is "papre", not one of default, paper/],
  [
    'bake target.glb --cage cage.glb --texture paint.png -o out.glb --set referenceCage=cage.glb',
    /are options of transfer/,
  ],
  [
    'relay target.glb --cage cage.glb --texture p.png --to cage.glb -o o.png --set uvBounds=0,0,1,1',
    /of transfer, inspect/,
  ],
  ['bake target.glb --cage cage.glb -o out.glb --map gloss=paint.png', /It is not normal=MAP or orm=MAP/],
  ['inspect target.glb --cage cage.glb --html page.html', /unknown option '--html'; it is --report REPORT\.html/],
  [`${transfer} --set threshold=0.4`, /It has a flag of its own: --threshold 0\.4/],
  [`${transfer} --preset paper`, /unknown option '--preset'.*; it is set by --set preset=VALUE/],
  [`${transfer} --mask colors=NORMAL`, /NORMAL is not COLOR_0, COLOR_1, … or an attribute of an own name/],
  [`${transfer} --limit vertices=2`, /There are the limits bytes, nesting/],
  [`${transfer} --limit bytes=many`, /A limit is a whole number, such as bytes=5000/],
  [`${transfer} --output out.obj`, /must end in \.glb or \.vrm or \.gltf/],
  [`${transfer} --texture paint.png`, /--texture needs -o/],
  [`${transfer} --borders cut`, /--borders cut needs -o OUT\.glb/],
  [`${transfer} --region cage.glb=paint.png`, /--region needs -o OUT\.glb/],
  ...['=paint.png', 'cage.glb', 'cage.glb='].map((region): [string, RegExp] => [
    `${transfer} -o out.glb --region ${region}`,
    /not the file of a cage and that of a texture, with = between them/,
  ]),
  ...['0,0,1', '1,0,0,1', '0,0,1,x'].map((bounds): [string, RegExp] => [
    `${transfer} --set uvBounds=${bounds}`,
    /It is not four numbers U0,V0,U1,V1 with U0 < U1 and V0 < V1/,
  ]),
  [`${transfer} --texture p.<UDIM>.png --set uvBounds=0,0,1,1 -o out.glb`, /cannot be given with a texture of <UDIM>/],
  ['transfer  --cage cage.glb', /TARGET is empty/],
  ['transfer target.glb --cage ', /--cage is empty/],
  [`${transfer} --report `, /--report is empty/],
  [`${transfer} --exclude `, /--exclude is empty/],
  [`${transfer} --keep only --keep `, /--keep is empty/],
  [`${transfer} -o target.glb`, /target\.glb would overwrite target\.glb, which this command reads; choose another/],
  [`${transfer} -o out.glb --report out.glb`, /out\.glb would overwrite out\.glb, which this command writes/],
  ['transfer - --cage -', /only one file can be the standard input/],
  [`${transfer} -o - --report -`, /only one file can be the standard output/],
  ['transfer - --cage cage.glb --config -', /only one file can be the standard input/],
  ['inspect - --cage cage.glb --config -', /only one file can be the standard input/],
  ['inspect target.glb --cage cage.glb --report page.txt', /must end in \.html or \.json/],
  ['bake - --cage cage.glb --texture paint.png --config - -o out.glb', /only one file can be the standard input/],
  ['bake target.glb --cage cage.glb -o out.glb', /there is nothing to bake/],
  ['bake target.glb --cage cage.glb -o out.png', /to write a PNG, --texture is needed/],
  ['bake target.glb --cage cage.glb --texture paint.png --map normal=paint.png -o out.png', /--map needs an OUT\.glb/],
  ['bake target.glb --cage cage.glb --texture paint.png --back -o out.png', /--back takes no paint/],
  [
    'bake target.glb --cage cage.glb --texture paint.png --part only -o out.glb',
    /--part is for a PNG; for a GLB, use --exclude/,
  ],
  [
    'bake target.glb --cage cage.glb --texture paint.png --atlas 9000 -o out.glb',
    /not a whole number of texels within 64\.\.8192/,
  ],
  [
    'bake target.glb --cage cage.glb --texture paint.png --size 0 -o out.png',
    /not a whole number of texels within 1\.\./,
  ],
  ['make', /missing required argument 'TARGET'|required option/],
  ['make target.glb', /required option '-o, --output <CAGE\.glb>' not specified/],
  ['make target.glb -o cage.obj', /Its name must end in \.glb/],
  ['make target.glb -o out.glb --triangles 7', /not a whole number within 50\.\.20000/],
  ['make target.glb -o out.glb --closing 0.3', /It is not a number within 0\.0005\.\.0\.2/],
  ['make target.glb -o out.glb --closing ', /It is not a number within 0\.0005\.\.0\.2/],
  ['make target.glb -o out.glb --kind hand', /Allowed choices are automatic, head, body, prop/],
  ['make target.glb -o target.glb', /target\.glb would overwrite target\.glb, which this command reads/],
  ['fit', /missing required argument 'TARGET'|required option/],
  ['fit target.glb --template human-head', /required option '-o, --output <CAGE\.glb>' not specified/],
  ['fit target.glb --template cage.glb -o cage.glb', /would overwrite cage\.glb, which this command reads/],
  ['batch', /give either TARGETS or --manifest/],
  ['batch  --cage cage.glb', /TARGETS is empty/],
  ['batch target.glb --cage - -o {name}.glb', /its jobs have no standard input/],
  [`${batch} --region -=p.png`, /its jobs have no standard input/],
  [`${batch} --mask never=-`, /its jobs have no standard input/],
  ['batch --manifest - --config -', /only one file can be the standard input/],
  [`${batch} -o -`, /the standard output has its lines/],
  [`${batch} --results -`, /the standard output has its lines/],
  [`${batch} --resume`, /--resume needs --results/],
  [`${batch} --borders cut`, /--borders cut needs -o OUT\.glb/],
  [`${batch} -o {foo}.glb`, /\{foo\} is unknown; paths may hold \{name\} and \{dir\}/],
  [`${batch} --report {name}{stem}.json`, /\{stem\} is unknown/],
  [`${batch} --texture p.<UDIM>.png --set uvBounds=0,0,1,1 -o {name}.glb`, /cannot be given with a texture of <UDIM>/],
  ['thumbnail', /missing required argument 'MODELS'|required option/],
  ['thumbnail target.glb -o out.gif', /must end in \.png or \.jpg or \.jpeg or \.webp/],
  ['thumbnail target.glb --size 8 -o out.png', /not a whole number of pixels within 16\.\.2048/],
  ['thumbnail target.glb --view up -o out.png', /It is neither front, back.* nor two angles such as 30,15/],
  ['thumbnail target.glb --view 30,100 -o out.png', /nor two angles/],
  ['thumbnail target.glb --background red -o out.png', /It is not a colour such as #ffffff/],
  ['thumbnail target.glb --part a --cage cage.glb -o out.png', /--part and --cage both say what fills the picture/],
  ['thumbnail target.glb cage.glb -o out.png', /out\.png is written for several models; use \{name\} or \{dir\}/],
  ['thumbnail target.glb -o {foo}.png', /\{foo\} is unknown/],
  ['diff - -', /only one file can be the standard input/],
  ['diff a.json b.json --tolerance 2', /not a number within 0\.\.1/],
];

test('wrong usage exits 2 with one line and writes nothing', async () => {
  const files = readdirSync('.').sort();
  for (const [line, message] of wrong) await fails(2, message, line);
  assert.deepEqual(readdirSync('.').sort(), files);
});

test('outputs are checked before anything is read', async () => {
  write('kept.glb', 'before');
  mkdirSync('folder.glb');
  for (const command of [
    'make no-model.glb',
    'fit no-model.glb --template human-head',
    'transfer no-model.glb --cage auto',
  ])
    for (const [out, reason] of [
      ['gone/out.glb', 'its folder does not exist'],
      ['kept.glb/out.glb', 'its folder is a file'],
      ['folder.glb', 'is a folder'],
    ])
      await fails(1, `${out}: cannot be written (${reason})`, `${command} -o ${out}`);
  await fails(
    1,
    'gone/page.html: cannot be written (its folder does not exist)',
    'make x.glb -o o.glb --report gone/page.html',
  );
  assert.equal(readFileSync('kept.glb', 'utf8'), 'before');
});

test('links are written through, permissions stay, and two names of one file are one', async () => {
  mkdirSync('folder');
  symlinkSync('folder', 'way');
  symlinkSync('folder/later.glb', 'link.glb'); // does not exist yet
  await ok(`${transfer} -o link.glb`);
  assert.ok(lstatSync('link.glb').isSymbolicLink(), 'the link is kept');
  assert.equal(readFileSync('folder/later.glb').toString('latin1', 0, 4), 'glTF');
  chmodSync('folder/later.glb', 0o626); // more and less than a new file has
  await ok(`${transfer} -o way/later.glb`);
  assert.equal(lstatSync('folder/later.glb').mode & 0o777, 0o626);
  const writes = 'way/a.glb would overwrite folder/a.glb, which this command writes; choose another output';
  await fails(2, writes, `${transfer} -o folder/a.glb --report way/a.glb`);
  const reads = 'link.glb would overwrite folder/later.glb, which this command reads; choose another output';
  await fails(2, reads, 'transfer folder/later.glb --cage cage.glb -o link.glb');
  assert.deepEqual(readdirSync('folder'), ['later.glb']);
});

test('--json and --quiet', async () => {
  const [report, inspection] = [
    await json<{ counts: object }>(transfer),
    await json('inspect target.glb --cage cage.glb'),
  ];
  assert.deepEqual(report.counts, (inspection as typeof report).counts);
  assert.equal(await ok('inspect target.glb --cage cage.glb --quiet'), '');
  assert.equal(await ok(`${transfer} -o quiet.glb --quiet`), '');
  assert.ok(existsSync('quiet.glb'));
});

test('after a name that nothing has, those of parts, materials and nodes that hold others are listed', async () => {
  const maker = new GlbMaker();
  maker.json.materials = [{ name: 'skin' }];
  const head = maker.node({ name: 'head', mesh: maker.mesh(target, { material: 0 }) }, false);
  const inner = maker.node({ name: 'upper', children: [head] }, false);
  maker.node({ children: [maker.node({ name: 'Body', children: [inner] }, false)] });
  maker.node({ name: 'camera' });
  write('named.glb', maker.finish());
  const line = 'named.glb: --keep eyes: nothing has this name; there are: head, skin, upper, Body';
  await fails(1, line, 'transfer named.glb --cage cage.glb --keep eyes');
  await fails(
    1,
    line.replace('--keep', '--part'),
    'bake named.glb --cage cage.glb --texture paint.png -o p.png --part eyes',
  );
  await fails(1, line.replace('--keep', '--exclude'), 'make named.glb -o c.glb --exclude eyes');
});

test('what there is one of is called so', async () => {
  writeChanged('one.glb', glbOf(head(1, 4).cage), () => {});
  assert.match(await ok('transfer one.glb --cage one.glb'), /, 1 segment \(/);
});

test('without -o and --report nothing is written, and it says so', async () => {
  const files = readdirSync('.').sort();
  assert.match(
    (await run(transfer)).stdout,
    /nothing written; to save the result, add -o OUT\.glb or --report R\.json/,
  );
  assert.deepEqual(readdirSync('.').sort(), files);
});

test('progress is shown in a terminal, and cleared; not with --quiet', async () => {
  let shown = '';
  const terminal = {
    stdout: () => void (shown += '[summary]'),
    stderr: (text: string) => void (shown += text),
    columns: 30,
  };
  await runCommand(transfer.split(' '), terminal);
  const steps = ['reading target.glb …', 'reading cage.glb …', 'transferring to 418 vertices …', '[summary]'];
  assert.deepEqual(
    shown.split('\r\x1b[K'),
    steps.map((text) => text.slice(0, 29)),
  );
  shown = '';
  await runCommand([...transfer.split(' '), '--quiet'], terminal);
  assert.equal(shown, '');
});
