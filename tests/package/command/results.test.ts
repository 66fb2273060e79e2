// What is found: the report of transfer, the verdict of inspect, and what diff says of both.
import assert from 'node:assert/strict';
import { mkdirSync, readdirSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import { presetOptions, transfer } from 'cagecast';
import { PNG } from 'pngjs';
import { fails, json, ok, run } from '../../support/command.js';
import { type GlbMaker, glbOf } from '../../support/gltf.js';
import { ball, cagedFigure, head, isOfCage, kCagedParts, within } from '../scenes.js';
import { inRepository, io, modelsLike, workplace, write, writeChanged, writeMade } from './workplace.js';

const models = modelsLike(/lizard|misaligned/);
const { groups } = head(1, 10).target;
const { cage, target } = workplace('results');
const plain = 'transfer target.glb --cage cage.glb';

interface Report {
  counts: Record<'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;
  areas: Record<'total' | 'cosmetic' | 'occluded' | 'uncovered' | 'culled', number>;
  segments: (Record<'points' | 'vertices', number> & { culled: boolean; culledBy: string; part: string })[];
  parts: { name: string; place: string; vertices: number; uvSet: string | null; splitVertices: number | null }[];
  target: { vertices: number; triangles: number; leftOut: { name: string; why: string }[]; bare: string[] };
  triangles: { total: number; cosmetic: number };
  stretch: Record<'median' | 'p95' | 'overTwice', number>;
  options: { occlusionReach: unknown; keep: string[]; exclude: string[] };
  timings: { total: number };
  versions: { cagecast: string };
}

test('reports the result of the package', async () => {
  const { counts, areas, segments, parts, target: found, options, versions, timings } = await json<Report>(plain);
  const result = transfer(cage, target);
  assert.deepEqual(
    Object.values(counts),
    [0, 1, 2, 3].map((zone) => result.zones.filter((one) => one === zone).length),
  );
  assert.deepEqual([found.vertices, found.triangles], [result.zones.length, target.indices.length / 3]);
  const pick = ({
    points,
    exposedArea,
    coveredArea,
    coverage,
    culled,
    culledBy,
  }: (typeof result.segmentStats)[number]) => [...[points, exposedArea, coveredArea, coverage], ...[culled, culledBy]];
  assert.deepEqual(
    segments.map((segment) => pick(segment as never)),
    result.segmentStats.map(pick),
  );
  const verticesOf = (s: number) => result.segments.filter((one) => one === s).length;
  assert.deepEqual(
    segments.map(({ vertices }) => vertices),
    segments.map((_, s) => verticesOf(s)),
  );
  const sum = areas.cosmetic + areas.occluded + areas.uncovered + areas.culled;
  assert.ok(Math.abs(sum - areas.total) < 1e-9 * areas.total);
  const [part, ...others] = parts.map((one) => [one.name, one.place, one.vertices, one.uvSet, one.splitVertices]);
  assert.deepEqual([part, others], [['only', 'meshes[0].primitives[0]', found.vertices, null, null], []]);
  assert.deepEqual(options, { preset: 'default', ...presetOptions(), keep: [], exclude: [], ignore: [], config: null });
  assert.match(versions.cagecast, /^\d+\.\d+\.\d+/);
  assert.ok(timings.total > 0);
});

test('a model far from the origin is read, inspected and given a cage as one at it', async () => {
  const translation = [3e6, -1e5, 1e7];
  for (const [name, mesh] of Object.entries({ target, cage }))
    writeMade(`far-${name}.glb`, (maker) => maker.node({ mesh: maker.mesh(mesh), translation }));
  const far = 'far-target.glb --cage far-cage.glb';
  const [near, away] = [await json<Report>(plain), await json<Report>(`transfer ${far}`)];
  const shares = ({ areas }: Report) => Object.values(areas).map((area) => (area / areas.total).toFixed(4));
  assert.deepEqual(shares(away), shares(near));
  assert.equal((await json<{ verdict: string }>(`inspect ${far}`)).verdict, 'good');
  await ok('make far-target.glb --triangles 300 -o far-made.glb');
  assert.match(await ok('inspect far-target.glb --cage far-made.glb'), /^(GOOD|USABLE)/m);
});

test('vertices that no triangle uses are no segments of reports', async () => {
  const spare = Array.from({ length: 3000 }, (_, i) => target.positions[i % 100]! / 2);
  const positions = Float32Array.from([...target.positions, ...spare]);
  write('spare.glb', glbOf({ positions, indices: target.indices }));
  for (const command of ['transfer', 'inspect']) {
    const [without, report] = await Promise.all(
      ['target', 'spare'].map((name) => json<Report>(`${command} ${name}.glb --cage cage.glb`)),
    );
    assert.deepEqual(report!.segments, without!.segments);
  }
});

test('the preset and single options are obeyed', async () => {
  const painted = (options: object) => transfer(cage, target, options).cosmeticTriangles.filter(Boolean).length;
  for (const [flags, options] of [
    ['--threshold 0', { threshold: 0 }],
    ['--threshold 1', { threshold: 1 }],
    ['--set preset=paper', { preset: 'paper' }],
    [
      '--set minCovered=1 --set pokeThrough=0.1 --set occlusionReach=0',
      { minCovered: 1, pokeThrough: 0.1, occlusionReach: 0 },
    ],
  ] as const)
    assert.equal((await json<Report>(`${plain} ${flags}`)).triangles.cosmetic, painted(options), flags);
  assert.notEqual(painted({}), painted({ preset: 'paper' }));
  assert.equal((await json<Report>(`${plain} --set preset=paper`)).options.occlusionReach, 'Infinity');
});

/** The mesh of one of the groups of the target: head, eye and tongue. */
const meshOf = (maker: GlbMaker, group: number, more = {}) =>
  maker.mesh(
    { ...target, indices: (target.indices as Uint32Array).filter((_, i, all) => groups![all[i - (i % 3)]!] === group) },
    more,
  );

/** Which of some parts are culled, by a lock if that is asked. Vertices in no triangle are segments as well. */
const culledIn = async (line: string, names: readonly string[], by?: string) => {
  const { segments } = await json<Report>(line);
  const isCulled = (one: Report['segments'][number]) => (by ? one.culledBy === by : one.culled);
  return names.map((name) => segments.filter((one) => one.part === name && one.points > 1).every(isCulled));
};

test('a cage that faces the other way is turned, and a line says so; one that fits either way stays', async () => {
  const bust = (turn: 1 | -1) => {
    const nose = (phi: number, theta: number) => Math.exp(-6 * ((phi - Math.PI / 2) ** 2 + (theta - 1.5) ** 2));
    // Its nose is at y, of which the node makes z; and it is farther back than its axis.
    const mesh = (size: number) => ball([0, 0.4, 0], (phi, theta) => size + nose(phi, theta), 24, 36);
    return (maker: GlbMaker, size: number) => {
      const rotation = turn > 0 ? [Math.SQRT1_2, 0, 0, Math.SQRT1_2] : [0, Math.SQRT1_2, -Math.SQRT1_2, 0];
      maker.node({ name: 'bust', mesh: maker.mesh(mesh(size)), rotation });
    };
  };
  for (const turn of [1, -1] as const) writeMade(`bust${turn}.glb`, (maker) => bust(turn)(maker, 1));
  writeMade('bust-cage.glb', (maker) => bust(1)(maker, 1.1));
  const said =
    /^the cage faced the other way; turned by half about the vertical axis, it fits clearly better, so it was$/m;
  for (const command of ['transfer', 'inspect']) {
    assert.doesNotMatch(await ok(`${command} bust1.glb --cage bust-cage.glb`), said);
    const turned = await run(`${command} bust-1.glb --cage bust-cage.glb`);
    assert.equal(turned.status, 0);
    assert.match(turned.stdout, said);
  }
  const [right, back] = await Promise.all(
    ['bust1', 'bust-1'].map((name) => json<Report>(`transfer ${name}.glb --cage bust-cage.glb`)),
  );
  assert.deepEqual(back!.counts, right!.counts);
  assert.ok((back as unknown as { cage: { isTurned: boolean } }).cage.isTurned);
  for (const off of [0, 0.3]) {
    write('off.glb', glbOf({ ...cage, positions: cage.positions.map((x) => x + off) }));
    assert.doesNotMatch((await run('transfer target.glb --cage off.glb')).stdout, said);
  }
});

test('a line says why next to nothing may be painted, and what helps', async () => {
  const away = (by: number) => glbOf({ ...cage, positions: cage.positions.map((x) => x + by) });
  write('away.glb', away(9));
  writeMade('hidden.glb', (maker) => {
    maker.node({ name: 'body', mesh: maker.mesh(target) });
    const shell = ball([0, 0, 0], () => 1.12, 12, 18);
    const inward = shell.indices.map((_, i, all) => all[i % 3 === 0 ? i : i % 3 === 1 ? i + 1 : i - 1]!);
    maker.json.materials = [{ doubleSided: true }];
    maker.node({ name: 'shell', mesh: maker.mesh({ ...shell, indices: inward }, { material: 0 }) });
  });
  write('large.glb', glbOf({ ...cage, positions: cage.positions.map((x) => 100 * x) }));
  write('small.glb', glbOf({ ...cage, positions: cage.positions.map((x) => x / 1000) }));
  write('within.glb', glbOf({ ...ball([0, 0, 0], () => 0.5, 60, 80) }));
  writeMade('half.glb', (maker) => {
    const front = within(cage, (x) => x > 0.9);
    maker.node({ name: 'cap', mesh: maker.mesh(front) });
  });
  for (const [line, note] of [
    [
      'transfer target.glb --cage away.glb',
      /^nothing may be painted: the cage lies over next to none of the target; put /m,
    ],
    [
      'transfer hidden.glb --cage cage.glb --exclude shell',
      /^nothing .*: most of "body" is hidden by "shell"; try --ignore "shell", or /m,
    ],
    [
      // Its eyes and teeth are hidden by the skin, and most of the skin by itself.
      `transfer ${inRepository('examples/samples/human/target.glb')} --cage ${inRepository('examples/samples/lizard/cage.glb')}`,
      /^only 1\.\d % .*: most of "skin" is hidden by other surfaces; leave out /m,
    ],
    [
      'transfer target.glb --cage half.glb --set preset=paper',
      /^nothing .* covers only [\d.]+ % of .* "only"; try --keep "only" or a /m,
    ],
    [
      'transfer target.glb --cage large.glb',
      /^(nothing may be painted: |)the cage is \d\d+ times as large as the target, as in another unit; give both in the same unit$/m,
    ],
    [
      'transfer target.glb --cage small.glb',
      /^nothing may be painted: the target is \d{3,} times as large as the cage, as in another unit; give both in the same unit$/m,
    ],
    [
      'transfer cage.glb --cage within.glb',
      /^nothing may be painted: target and cage seem to be exchanged; exchange them$/m,
    ],
    [
      'transfer target.glb --cage cage.glb --exclude only',
      /^nothing .*: "only" is excluded by choice; leave out --exc/m,
    ],
  ] as const) {
    assert.match(await ok(line), note, line);
    const { note: told } = await json<{ note?: string }>(line);
    assert.match(told!, note);
  }
  assert.equal((await json<{ note?: string }>(plain)).note, undefined);
});

test('--keep and --exclude lock parts by the names of nodes and materials', async () => {
  writeMade('named.glb', (maker) => {
    maker.json.materials = ['skin', 'glass', 'flesh'].map((name) => ({ name }));
    for (const [group, name] of ['head', 'eye.left', 'tongue'].entries())
      maker.node({ mesh: meshOf(maker, group, { material: group }), name });
  });
  const named = 'transfer named.glb --cage cage.glb';
  for (const [flags, culled] of [
    ['', [false, true]],
    [' --exclude skin --keep eye*', [true, false]],
    [' --exclude head --exclude tongue --keep *glas*', [true, false, true]],
    [' --exclude * --keep flesh', [true, true, false]],
    [' --exclude nose* --keep eye*', [false, false]],
  ] as const)
    assert.deepEqual(
      await culledIn(`${named}${flags}`, ['head', 'eye.left', 'tongue'].slice(0, culled.length)),
      culled,
    );
  const { options } = await json<Report>(`${named} --keep eye* --exclude head`);
  assert.deepEqual([options.keep, options.exclude], [['eye*'], ['head']]);
  await fails(1, /named\.glb: --exclude eye\?left: nothing has this name/, `${named} --exclude eye?left`);
});

test('--keep and --exclude take a node that holds others for all below it, unless a part has its name', async () => {
  writeMade('holding.glb', (maker) => {
    const [face, eye, tongue] = ['head', 'eye', 'tongue'].map((name, group) =>
      maker.node({ name, mesh: meshOf(maker, group) }, false),
    );
    const mouth = maker.node({ name: 'mouth', children: [tongue!] }, false);
    maker.node({ name: 'Face', children: [eye!, mouth] });
    maker.node({ children: [maker.node({ name: 'eye', children: [face!] }, false)] });
  });
  const holding = 'transfer holding.glb --cage cage.glb';
  for (const [name, culled] of [
    ['Fa*', [false, true, true]],
    ['mouth', [false, false, true]],
    ['eye', [false, true, false]],
  ] as const)
    assert.deepEqual(await culledIn(`${holding} --exclude ${name}`, ['head', 'eye', 'tongue'], 'lock'), culled, name);
  assert.deepEqual(await culledIn(`${holding} --exclude Face --keep mouth`, ['eye', 'tongue'], 'lock'), [true, false]);
});

/** A head under a visor, with an outfit that is hidden, a hat and a cage for it. */
function dressed(maker: GlbMaker): void {
  const off = { extensions: { KHR_node_visibility: { visible: false } } };
  maker.node({ name: 'head', mesh: meshOf(maker, 0) });
  maker.node({ name: 'Visor', mesh: maker.mesh(ball([0, 0, 0], () => 1.12, 12, 24)) });
  maker.node({ name: 'Outfit', mesh: maker.mesh(ball([0, 0, 0], () => 1.13, 12, 24)), ...off });
  maker.node({ name: 'StrawHat', mesh: maker.mesh(ball([0, 0, 1.05], () => 0.04, 6, 9)) });
  maker.node({ name: 'head_OuterCage', mesh: maker.mesh(cage) });
  maker.json.extensionsUsed = ['KHR_node_visibility'];
}

test('what the colours of its vertices leave nothing of is left out, where its material blends', async () => {
  const left = async (alphaMode: string, alpha: number) => {
    writeMade('veiled.glb', (maker) => {
      const veil = ball([0, 0, 0], () => 1.12, 12, 24);
      const number = maker.mesh(veil, { material: 0 });
      const colors = Uint8Array.from({ length: (veil.positions.length / 3) * 4 }, (_, i) =>
        i % 4 === 3 ? alpha : 255,
      );
      maker.json.meshes[number]!.primitives[0]!.attributes['COLOR_0'] = maker.accessor(colors, 'VEC4', {
        normalized: true,
      });
      maker.json.materials = [{ alphaMode: alphaMode as 'BLEND' }];
      maker.node({ name: 'head', mesh: meshOf(maker, 0) });
      maker.node({ name: 'Veil', mesh: number });
    });
    const { target } = await json<Report>('transfer veiled.glb --cage cage.glb');
    return target.leftOut.map(({ name, why }) => `${name}: ${why}`);
  };
  assert.deepEqual(await left('BLEND', 0), ['Veil: transparent']);
  for (const [mode, alpha] of [
    ['BLEND', 1],
    ['OPAQUE', 0],
  ] as const)
    assert.deepEqual(await left(mode, alpha), []);
});

test('what is not drawn is left out, and what --ignore names; hats stay bare', async () => {
  writeMade('dressed.glb', dressed);
  const line = 'transfer dressed.glb --cage cage.glb';
  const partsOf = async (flags = '') => {
    const { target, parts } = await json<Report>(`${line} --keep head${flags}`);
    return [parts.map(({ name }) => name), target.leftOut.map(({ name, why }) => `${name}: ${why}`), target.bare];
  };
  const [cage, outfit] = ['head_OuterCage: name', 'Outfit: hidden'];
  assert.deepEqual(await partsOf(), [['head', 'Visor', 'StrawHat'], [outfit, cage], ['StrawHat']]);
  assert.deepEqual(await partsOf(' --ignore Vis* --keep *Hat'), [
    ['head', 'StrawHat'],
    ['Visor: ignored', outfit, cage],
    [],
  ]);
  assert.deepEqual(await partsOf(' --ignore head_* --keep outfit'), [
    ['head', 'Visor', 'Outfit', 'StrawHat'],
    [cage],
    ['StrawHat'],
  ]);
  const painted = async (flags: string) => (await json<Report>(`${line}${flags}`)).areas.cosmetic;
  assert.ok((await painted(' --ignore Visor')) > 2 * (await painted(' --exclude Visor --set preset=paper')));
  assert.match(
    await ok(`inspect dressed.glb --cage cage.glb --ignore Visor`),
    /^left out: "Visor" \(ignored\), "Outfit" \(hidden\), "head_OuterCage" \(by name a cage, [^)]+\)\nbare by their names, unless --keep names them: StrawHat$/m,
  );
  await fails(1, /dressed\.glb: --ignore Hat: nothing has this name; there are: head, Visor/, `${line} --ignore Hat`);
  await fails(
    1,
    /--exclude Outfit: nothing has this name; .*; left out: "Outfit" \(hidden\)/,
    `${line} --exclude Outfit`,
  );
  await fails(
    1,
    /^cagecast: dressed\.glb: all parts are left out: "head", .* \(ignored\), .*; name what counts by --keep$/m,
    `${line} --ignore *`,
  );
});

test('without --cage, the cages in the file are taken, each for the part of its name', async () => {
  write('figure.glb', cagedFigure());
  await ok('transfer figure.glb -o out.glb --borders cut --report figure.json');
  const { parts, triangles } = JSON.parse(readFileSync('figure.json', 'utf8')) as Report;
  assert.equal(triangles.cosmetic, triangles.total);
  assert.deepEqual(
    parts.map(({ name }) => name),
    kCagedParts,
  );
  const document = await io.read('out.glb');
  for (const [p, name] of kCagedParts.entries()) {
    const [primitive] = document
      .getRoot()
      .listNodes()
      .find((node) => node.getName() === name)!
      .getMesh()!
      .listPrimitives();
    const uvs = primitive!.getAttribute('TEXCOORD_1')!;
    for (let v = 0; v < uvs.getCount(); ++v) {
      const u = uvs.getElement(v, [])[0]!;
      assert.ok(isOfCage(u, p), `${name}: ${u}`);
    }
  }
  // It says that the tiles of the parts are outside of 0..1.
  const { verdict, holes, findings } = await json<Inspection>('inspect figure.glb');
  assert.deepEqual([verdict, holes, findings.map(({ code }) => code)], ['usable', [], ['uvsOverlap', 'uvsOutside']]);
  // The cages of a file fit others, too; a part without one is named.
  assert.equal(
    (await json<Report & { cage: { triangles: number } }>(`${plain.replace('cage.glb', 'figure.glb')}`)).cage.triangles,
    triangles.total,
  );
  await fails(
    1,
    /^cagecast: target\.glb: has no cage: no mesh in it is named as an outer cage, as Head_OuterCage/,
    'transfer target.glb',
  );
  writeChanged('lost.glb', cagedFigure(), ({ nodes }) => (nodes![3]!.name = 'Hand_OuterCage'));
  await fails(
    1,
    'lost.glb: "Left_Geo" has no cage: none is named Left_OuterCage; --ignore leaves the part out',
    'transfer lost.glb',
  );
  writeChanged('bare.glb', cagedFigure(), ({ nodes }) => {
    for (const [p, name] of kCagedParts.entries()) Object.assign(nodes![p]!, { name: `${name}_OuterCage` });
  });
  await fails(1, /bare\.glb: all parts are left out: "Left_Geo_OuterCage", .* \(by name a cage, /, 'transfer bare.glb');
});

interface Inspection {
  verdict: 'good' | 'usable' | 'unfit';
  findings: { code: string }[];
  counts: object;
  coverage: Record<string, number>;
  placement: { distances: Record<'p50' | 'p90' | 'p99' | 'max', number> };
  holes: object[];
  segments: { part: string }[];
}

test('inspect calls a good cage good, in text and JSON', async () => {
  const text = await ok('inspect target.glb --cage cage.glb');
  for (const word of [/cosmetic/, /outside the cage/, /median/, /F = C\/E/, /beneath/, /(GOOD|USABLE): the cage fits/])
    assert.match(text, word);
  const inspection = await json<Inspection>('inspect target.glb --cage cage.glb');
  assert.notEqual(inspection.verdict, 'unfit');
  assert.deepEqual(inspection.counts, (await json<Report>(plain)).counts);
  assert.ok(Math.abs(Object.values(inspection.coverage).reduce((a, b) => a + b) - 1) < 1e-9);
  assert.equal(inspection.holes.length, 1);
  assert.ok(inspection.segments.every(({ part }) => part === 'only'));
  const { p50, p90, p99, max } = inspection.placement.distances;
  assert.ok(p50 <= p90 && p90 <= p99 && p99 <= max && max < 1);
});

test('a cage that is unfit: exit 3, the cause first, with advice', async () => {
  write('unfit.glb', glbOf({ ...cage, positions: cage.positions.map((x) => 0.8 * x) }));
  const { status, stdout } = await run('inspect target.glb --cage unfit.glb');
  assert.equal(status, 3);
  assert.match(stdout, /UNFIT: the cage does not fit\.\n✗ .*\.\n {2}→ /);
  const { verdict, findings } = await json<Inspection>('inspect target.glb --cage unfit.glb', 3);
  assert.deepEqual([verdict, findings[0]!.code], ['unfit', 'cageTooSmall']);
});

test('inspect finds bad cages of models unfit, for the right reason first, and good ones good or usable', async () => {
  const reasons: [RegExp, string][] = [
    [/shifted|misaligned/, 'cageMisplaced'],
    [/shrunk/, 'cageTooSmall'],
    [/flipped/, 'normalsInward'],
  ];
  for (const model of models)
    for (const name of readdirSync(model).filter((file) => /^cage.*\.glb$/.test(file))) {
      const path = join(model, name);
      const reason = reasons.find(([pattern]) => pattern.test(path))?.[1];
      const line = `inspect ${join(model, 'target.glb')} --cage ${path}`;
      const { verdict, findings } = await json<Inspection>(line, reason ? 3 : 0);
      assert.equal(verdict === 'unfit', reason !== undefined, path);
      if (reason) assert.equal(findings[0]!.code, reason, path);
    }
});

test('an advice to override a verdict comes with the flag that does', async () => {
  const strict = 'inspect target.glb --cage cage.glb --threshold 1';
  const { stdout } = await run(strict);
  assert.match(stdout, /✗ No part of the target may be painted: .*\n {2}→ .* To override: --keep "only"\n/);
  assert.doesNotMatch((await run(`${strict} --keep only`)).stdout, /No part of the target|To override/);
});

test('--report writes a page that needs nothing else', async () => {
  assert.match(await ok('inspect target.glb --cage cage.glb --report page.html'), /\nwrote page\.html\n$/);
  const html = readFileSync('page.html', 'utf8');
  assert.doesNotMatch(html, /(?:src|href)="(?!data:)|https?:\/\/|<script/);
  const pictures = [...html.matchAll(/data:image\/png;base64,([^"]+)"/g)].map(([, data]) =>
    PNG.sync.read(Buffer.from(data!, 'base64')),
  );
  assert.equal(pictures.length, 8);
  // Something is to be seen in each, and not everywhere.
  for (const { data } of pictures) {
    const shown = data.filter((alpha, i) => i % 4 === 3 && alpha > 0).length / (data.length / 4);
    assert.ok(shown > 0.1 && shown < 0.95, `${shown} of a picture shows the model`);
  }
  assert.match(html, /<svg.*<path/s);
});

test('--report writes as JSON what --json prints', async () => {
  const printed = await ok('inspect target.glb --cage cage.glb --json --report report.json');
  const known = ({ timings: _, ...report }: Record<string, unknown>) => report;
  assert.deepEqual(known(JSON.parse(readFileSync('report.json', 'utf8'))), known(JSON.parse(printed)));
});

interface Difference {
  over: number;
  changes: { measure: string; before: number; after: number; isOver: boolean }[];
}

test('diff shows what changed between two reports, and exits 4 over the limit', async () => {
  const report = (name: string, flags = '') => ok(`${plain} --report ${name}.json --quiet${flags}`);
  await Promise.all([report('a'), report('b'), report('c', ' --exclude only')]);
  assert.equal(await ok('diff a.json b.json'), 'nothing changed\n');
  const { status, stdout } = await run('diff a.json c.json');
  assert.equal(status, 4);
  assert.match(stdout, /area cosmetic +[\d.]+ % +0\.0 % +over/);
  assert.match(stdout, /part only: culled/);
  const { over, changes } = await json<Difference>('diff a.json c.json', 4);
  assert.equal(over, changes.filter(({ isOver }) => isOver).length);
  await ok('diff a.json c.json --tolerance 1 --quiet');
  // A cage with half of the texture: all of it is stretched twice as much.
  write('half.glb', glbOf({ ...cage, uvs: cage.uvs!.map((x) => x / 2) }));
  await ok('transfer target.glb --cage half.glb --report half.json --quiet');
  const stretched = await json<Difference>('diff a.json half.json', 4);
  const median = stretched.changes.find(({ measure }) => measure === 'stretch, median')!;
  assert.ok(median.isOver && Math.abs(median.after / median.before - 2) < 1e-4);
  const { stretch } = JSON.parse(readFileSync('a.json', 'utf8')) as Report;
  assert.ok(stretch.median > 0 && stretch.p95 >= stretch.median && stretch.overTwice < 0.5);
  // A report of the same by another command: shares differ in digits that nobody sees.
  const inspection = await ok('inspect target.glb --cage cage.glb --json');
  write('same.json', inspection);
  write('worse.json', inspection.replace(/"verdict": "\w+"/, '"verdict": "unfit"'));
  assert.equal(await ok('diff a.json same.json --tolerance 0'), 'nothing changed\n');
  const worse = await run('diff same.json worse.json');
  assert.equal(worse.status, 4);
  assert.match(worse.stdout, /verdict +(good|usable) +unfit +over/);
});

test('diff compares the regions of reports, if both have them', async () => {
  const report = await json(plain);
  const region = (cosmetic: number) => ({
    counts: { cosmetic, occluded: 10 - cosmetic, uncovered: 0, culled: 0 },
    triangles: { total: 10, cosmetic },
  });
  for (const [name, regions] of Object.entries({ none: [], five: [region(5)], two: [region(2)] }))
    write(`${name}.json`, JSON.stringify({ ...report, regions }));
  const { status, stdout } = await run('diff five.json two.json');
  assert.equal(status, 4);
  assert.match(stdout, /region 1: triangles painted +50\.0 % +20\.0 % +over/);
  assert.match(stdout, /region 1: vertices occluded +50\.0 % +80\.0 % +over/);
  assert.match((await run('diff five.json none.json')).stdout, /region 1 +there +– +over/);
  write('inspected.json', await ok('inspect target.glb --cage cage.glb --json'));
  assert.equal(await ok('diff inspected.json five.json'), 'nothing changed\n');
});

test('diff compares the reports of two folders: what changed, is gone and is new', async () => {
  for (const folder of ['approved/deep', 'build/deep', 'none']) mkdirSync(folder, { recursive: true });
  const [same, other] = [JSON.stringify(await json(plain)), JSON.stringify(await json(`${plain} --exclude only`))];
  for (const name of ['same', 'other', 'gone', 'deep/same', 'deep/gone']) write(`approved/${name}.json`, same);
  for (const name of ['same', 'new', 'deep/same']) write(`build/${name}.json`, same);
  write('build/other.json', other);
  const { status, stdout } = await run('diff approved build');
  assert.equal(status, 4);
  assert.match(stdout, /^other\.json\n +before +after/);
  assert.match(
    stdout,
    /\ngone: deep.gone\.json\ngone: gone\.json\nnew: new\.json\n3 reports compared: 1 changed, 1 over the limit; 2 gone, 1 new\n$/,
  );
  const found = await json<{ over: number; reports: { name: string; over: number }[] }>('diff approved build', 4);
  assert.equal(found.over, 2 + found.reports.find(({ name }) => name === 'other.json')!.over);
  // A report that is gone is a change by itself; a new one is not.
  for (const name of ['approved/gone', 'approved/deep/gone', 'approved/other', 'build/other']) rmSync(`${name}.json`);
  assert.match(await ok('diff approved build'), /^new: new\.json\n2 reports compared: 0 changed/);
  assert.equal((await run('diff build approved')).status, 4);
  await fails(1, /approved: is a folder, and the other is a file/, 'diff approved build/same.json');
  await fails(1, 'none: has no reports (*.json)', 'diff approved none');
  await fails(1, 'nowhere: no such file', 'diff approved nowhere');
});

test('diff says in a line which file is no report, and why', async () => {
  const whole = await json<Report & { target: object }>(plain);
  write('whole.json', JSON.stringify(whole));
  for (const [wrong, fault] of [
    [{ target: null }, 'target is null, not an object'],
    [{ target: { ...whole.target, diagonal: -1 } }, 'target.diagonal is -1, not a number from 0 on'],
    [{ areas: undefined }, 'areas is missing'],
    [{ segments: [null] }, 'segments[0] is null, not an object'],
    [{ segments: [whole.segments[0], { ...whole.segments[0], part: 5 }] }, 'segments[1].part is 5, not a text'],
    [{ parts: {} }, 'parts is {}, not an array'],
    [{ stretch: {} }, 'stretch.median is missing'],
    [{ regions: [{}] }, 'regions[0].counts is missing'],
    [{ verdict: 'bad' }, 'verdict is "bad", not one of unfit, usable, good'],
  ] as const) {
    write('wrong.json', JSON.stringify({ ...whole, ...wrong }));
    const text = 'is no report of cagecast transfer (--report) or inspect (--json)';
    await fails(1, `wrong.json: ${text}: ${fault}`, 'diff whole.json wrong.json');
  }
  await fails(1, /^cagecast: wrong\.json: is no report of /, 'diff wrong.json whole.json');
  await fails(1, /^cagecast: target\.glb: is not JSON/, 'diff whole.json target.glb');
});
