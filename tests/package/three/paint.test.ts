import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { build } from 'esbuild';
import type { Browser, Page } from 'playwright-core';
import { launchChromium } from '../../support/chromium.js';

/** The three.js of these scenes, as package.json names it; `oldest.test.ts` gives another. */
const three = process.env['CAGECAST_THREE'] ?? 'three';
const folder = mkdtempSync(join(tmpdir(), 'cagecast-three-'));
const types: Record<string, string> = { js: 'text/javascript', wasm: 'application/wasm', html: 'text/html' };
const server = createServer((request, response) => {
  const name = new URL(request.url ?? '/', 'http://localhost').pathname.slice(1) || 'index.html';
  try {
    const from = /^(target|cage)\.glb$/.test(name)
      ? 'examples/samples/lizard'
      : /^(worker-thread|index|spawn|cages-thread)\.js$|\.wasm$/.test(name)
        ? 'dist'
        : folder;
    const bytes = readFileSync(join(from, name));
    response.writeHead(200, {
      'content-type': types[name.split('.').at(-1)!] ?? 'application/octet-stream',
      // Isolated pages may read the clock exactly.
      'cross-origin-opener-policy': 'same-origin',
      'cross-origin-embedder-policy': 'require-corp',
    });
    response.end(bytes);
  } catch {
    response.writeHead(404).end();
  }
});
let browser: Browser;
let page: Page;
const complaints: string[] = [];

before(async () => {
  await build({
    entryPoints: ['tests/package/three/page.ts'],
    bundle: true,
    format: 'esm',
    outdir: folder,
    logLevel: 'warning',
    define: { 'import.meta.url': 'location.href' },
    ...(three !== 'three' && { alias: { three } }),
  });
  const lizard = (name: string) => `examples/samples/lizard/${name}`;
  const options = [
    '--cage',
    lizard('cage.glb'),
    '--texture',
    lizard('paint-tiger.png'),
    '-o',
    join(folder, 'painted.glb'),
  ];
  const { status, stderr } = spawnSync(process.execPath, ['dist/cli.js', 'transfer', lizard('target.glb'), ...options]);
  assert.equal(status, 0, String(stderr));
  writeFileSync(join(folder, 'index.html'), '<!doctype html><script type="module" src="page.js"></script>');
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  browser = await launchChromium({ drawing: true });
  page = await browser.newPage();
  const session = await page.context().newCDPSession(page);
  await page.exposeFunction('collectGarbage', () => session.send('HeapProfiler.collectGarbage'));
  page.on('pageerror', (error) => complaints.push(String(error)));
  page.on('console', (message) => {
    // The renderer frees what a lost context had, too.
    const harmless = /404|GPU stall|object does not belong to this context/;
    if (['error', 'warning'].includes(message.type()) && !harmless.test(message.text()))
      complaints.push(message.text());
  });
  await page.goto(`http://127.0.0.1:${(server.address() as { port: number }).port}/`);
  await page.waitForFunction(() => 'run' in globalThis || undefined, undefined, { timeout: 60000 });
});
after(async () => {
  await browser?.close();
  server.close();
  rmSync(folder, { recursive: true, force: true });
});

async function run<T>(name: string): Promise<T> {
  const seen = await page.evaluate(
    (name) => (globalThis as unknown as { run(name: string): Promise<unknown> }).run(name),
    name,
  );
  assert.equal((seen as { error?: string }).error, undefined);
  assert.deepEqual(complaints.splice(0), []);
  return seen as T;
}

describe('paint of cagecast/three, drawn by Chromium', () => {
  test('takes on the shading of the material below, and its opacity, without a draw call', async (context) => {
    const seen = await run<Record<string, { apart: number; calls: number }>>('shading');
    context.diagnostic(JSON.stringify(seen));
    for (const [kind, { apart, calls }] of Object.entries(seen)) {
      assert.ok(apart <= 2, `${kind}: ${apart} of 255`);
      assert.equal(calls, 0, kind);
    }
  });

  test('one texture paints two models with different UV sets, and stays as it was', async () => {
    const { alone, both, rebuilt, untouched } = await run<{
      alone: number[];
      both: number[][];
      rebuilt: number[][];
      untouched: boolean;
    }>('sharedTexture');
    assert.ok(
      alone.every((count) => count > 100),
      alone.join(),
    );
    assert.deepEqual(both, [alone, alone]);
    assert.deepEqual(rebuilt, both);
    assert.ok(untouched);
  });

  test('clones are painted and morph as their model, and rays hit them once', async () => {
    const { still, before, moved, hits } = await run<{ still: number; before: number; moved: number; hits: number }>(
      'clones',
    );
    assert.equal(still, before);
    assert.ok(moved > 1.3 * still, `${moved} of ${still}`);
    assert.equal(hits, 1);
  });

  test('updateMorphTargets and VRMUtils.combineMorphs leave no base bare', async () => {
    const { still, seen } = await run<{ still: number[]; seen: { red: number; base: number }[] }>('morphs');
    seen.forEach(({ red, base }, m) => {
      assert.ok(red > 1.3 * still[m]!, `${red} of ${still[m]}`);
      assert.equal(base, 0);
    });
  });

  test('visibility, layers, first person and render order are those of the base', async () => {
    assert.deepEqual(await run('following'), {
      at: true,
      hidden: 0,
      layers: [0, true],
      firstPerson: [false, false, true],
      headless: [false, false, true],
      order: [0, 1],
    });
  });

  test('parts without paint cost nothing', async () => {
    const { before, after, red } = await run<{ before: number; after: number; red: number }>('emptyParts');
    assert.equal(after, before);
    assert.ok(red > 100);
  });

  test('thirty painted parts need no draw call more, and no other calls of WebGL for each of them', async () => {
    const { calls, commands, red } = await run<{ calls: number[]; commands: number[]; red: number }>('manyParts');
    assert.deepEqual(calls, [30, 30]);
    const [plain, painted] = commands as [number, number];
    // The paint is bound once.
    assert.ok(plain > 90 && painted - plain <= 5, commands.join());
    assert.ok(red > 100);
  });

  test('a shader that asks for paint gets it; one that does not is overlaid', async () => {
    const { calls, red, blue, clone } = await run<{ calls: number[]; red: number[]; blue: number[]; clone: number }>(
      'ownShaders',
    );
    assert.deepEqual(calls, [0, 1]);
    for (const count of [...red, clone]) assert.ok(count > 100, `${count}`);
    for (const count of blue) assert.ok(count < 10, `${count}`);
  });

  test('changes show in the next frame; what is taken away leaves no trace', async () => {
    const seen = await run<Record<string, [red: number, green: number, apart: number]>>('changes');
    const sides = Object.fromEntries(
      Object.entries(seen).map(([name, [red, green, apart]]) => [
        name,
        `${red > 100 ? 'red' : ''}${green > 100 ? 'green' : ''}${apart === 0 ? 'bare' : ''}`,
      ]),
    );
    assert.deepEqual(sides, {
      painted: 'redgreen',
      moved: 'redgreen',
      transparent: 'bare',
      green: 'green',
      none: 'bare',
      again: 'red',
      copy: 'bare',
      'copy painted': 'red',
      disposed: 'bare',
      second: 'green',
    });
  });

  test('updates of an overlay leave nothing on the GPU', async () => {
    assert.deepEqual(await run<number[]>('updatedOverlay'), [0, 0, -1]);
  });

  test('an opaque overlay is seen whenever its material was made', async () => {
    const [before, after] = await run<number[][]>('opaqueOverlays');
    assert.ok(
      after!.every((count) => count > 100),
      `${after}`,
    );
    assert.deepEqual(before, after);
  });

  test('a soft border fades inside the painted zone', async () => {
    const [hard, soft] = (await run<number[][]>('feather')) as [number[], number[]];
    const [first, last] = [hard.indexOf(255), hard.lastIndexOf(255)];
    assert.equal(soft[first + 2], 255);
    // From the lower end of the model to the border.
    const rest = soft.slice(first + 2, last + 1);
    rest.slice(1).forEach((value, i) => assert.ok(value <= rest[i]! + 1, rest.join()));
    assert.ok(rest.filter((value) => value > 0 && value < 255).length >= 4, rest.join());
    assert.ok(rest.at(-1)! < 60, rest.join());
    soft.forEach((value, y) => assert.ok(value <= hard[y]!, `${y}: ${value} of ${hard[y]}`));
  });

  test('instances share their paint', async () => {
    const { calls, left, right } = await run<{ calls: number; left: number; right: number }>('instances');
    assert.equal(calls, 1);
    assert.ok(left > 100 && right > 100, `${left}, ${right}`);
  });

  test('where its material is shared, a mesh that is not painted stays as it was', async () => {
    const { body, both, left } = await run<{ body: number; both: number[][]; left: number[][] }>('sharedMaterial');
    assert.equal(body, 0);
    assert.ok(both[0]![0]! > 100 && both[0]![1] === 0 && both[1]![1]! > 100 && both[1]![0] === 0, JSON.stringify(both));
    assert.deepEqual(left, [both[0], [0, 0, 0]]);
  });

  test('materials that share their uniforms have paint of their own, and no other uniforms than before', async () => {
    const { frames, names } = await run<{ frames: number[][][]; names: string[] }>('sharedUniforms');
    const [r, g, b, black] = [
      [255, 0, 0],
      [0, 255, 0],
      [0, 0, 255],
      [0, 0, 0],
    ];
    assert.deepEqual(frames, [
      [r, g],
      [r, g],
      [b, g],
      [black, black],
    ]);
    assert.deepEqual(names, ['light']);
  });

  test('hooks of others stay, wherever they are', async () => {
    assert.deepEqual(await run('hooks'), {
      own: true,
      wrapping: [
        [true, true],
        [false, true],
        [true, true],
      ],
      replaced: true,
      renewed: [false, true],
      renewedWrapping: [true, true],
    });
  });

  test('a transfer that was replaced changes nothing any more', async () => {
    const [green, bare] = [
      [false, true, false],
      [false, false, false],
    ];
    assert.deepEqual(await run('replaced'), [green, green, bare, green]);
  });

  test('a transfer shows its paint again when the one that replaced it is disposed of', async () => {
    assert.deepEqual(await run('preview'), [false, false, true]);
  });

  test('the material of two models goes on showing the paint of each, whichever transfers end', async () => {
    const [red, blue, none] = [0, 2, -1]; // the channel that is seen
    assert.deepEqual(await run('replacedOnShared'), {
      looks: [
        [red, blue],
        [red, blue],
        [red, none],
      ],
      isOriginal: true,
    });
  });

  test('paint that comes and goes leaves nothing on the GPU', async () => {
    for (const [what, counts] of Object.entries(await run<Record<string, number[]>>('leaks')))
      assert.deepEqual(new Set(counts).size, 1, `${what}: ${counts}`);
  });

  test('meshes elsewhere with the same vertices, and overlays, are drawn whatever is done to the model', async () => {
    const found = await run<{ counts: number[]; splits: number; overlaid: boolean }[]>('sharedVertices');
    for (const { counts, overlaid } of found) {
      assert.ok(counts[0]! > 100 && new Set(counts).size === 1, counts.join());
      assert.ok(overlaid, 'the overlay stays');
    }
    assert.ok(found[1]!.splits > 0, 'vertices are split');
  });

  test('skinned meshes are targets by themselves, and picked where their bones have moved them', async () => {
    const { counts, picks } = await run<{ counts: number[]; picks: boolean[] }>('bones');
    assert.ok(counts[0]! > 100 && counts[1] === counts[0], counts.join());
    assert.deepEqual(picks, [true, false, true]);
  });

  test('attributes of instances stay as they are', async () => {
    assert.deepEqual(await run('instanceAttributes'), [
      { split: true, ids: 2, last: 1 },
      { split: true, ids: 500, last: 499 },
    ]);
  });

  test('where a ray meets nothing, nothing is painted; a list of materials may have a gap', async () => {
    assert.deepEqual(await run('nothing'), { canUndo: true, red: true });
  });

  test('a video as a layer looks as it does as paint', async () => {
    const { alone, layered } = await run<{ alone: number[]; layered: number[] }>('video');
    for (const [k, value] of alone.entries()) {
      assert.ok(Math.abs(value - 128) <= 3, alone.join());
      assert.ok(Math.abs(layered[k]! - value) <= 2, `${layered} ${alone}`);
    }
  });

  test('in the background: the same result in short tasks; cancelled, nothing is changed', async (context) => {
    const { sync, background, split, same, shares, refused, untouched } = await run<{
      sync: { longest: number; total: number };
      background: { longest: number; total: number };
      split: number[];
      same: boolean;
      shares: number[];
      refused: string;
      untouched: boolean;
    }>('background');
    context.diagnostic(`at once ${JSON.stringify(sync)}, in the background ${JSON.stringify(background)}`);
    assert.ok(split[0]! > 0 && split[0] === split[1], split.join());
    assert.ok(same);
    // Half as much more than at once, where this is not a matter of some milliseconds.
    assert.ok(background.total <= 1.5 * Math.max(sync.total, 100), `${background.total} of ${sync.total} ms`);
    // 50 ms are a long task for a browser; on a machine that is that slow, a quarter of the time.
    assert.ok(background.longest <= Math.max(50, sync.total / 4), `${background.longest} of ${sync.total} ms`);
    assert.deepEqual(
      shares,
      shares.toSorted((a, b) => a - b),
    );
    assert.equal(shares.at(-1), 1);
    assert.equal(refused, 'enough');
    assert.ok(untouched);
  });

  test('a saved transfer needs no cage, and gives the same pixels', async (context) => {
    const { bytes, times, vertices, apart, painted } = await run<{
      bytes: number;
      times: number[];
      vertices: number;
      apart: number;
      painted: number;
    }>('saved');
    const median = times.toSorted((a, b) => a - b)[times.length >> 1]!;
    context.diagnostic(
      `${bytes} bytes for ${vertices} vertices, applied in ${median.toFixed(2)} ms (median of ${times.length}; the first ${times[0]!.toFixed(2)} ms)`,
    );
    assert.equal(apart, 0);
    assert.ok(painted > 50, `${painted}`);
  });

  test('the overlay of a written file has no holes, from whatever distance', async () => {
    const counts = await run<number[]>('written');
    assert.ok(counts[0]! > 500, counts.join());
    for (const count of counts) assert.ok(count >= counts[0]! - 2, counts.join());
  });
});

const decode = (byte: number): number =>
  byte <= 0.04045 * 255 ? byte / 255 / 12.92 : ((byte / 255 + 0.055) / 1.055) ** 2.4;
const encode = (share: number): number =>
  255 * (share <= 0.0031308 ? 12.92 * share : 1.055 * share ** (1 / 2.4) - 0.055);
const formulas: Record<string, (below: number, layer: number) => number> = {
  normal: (_, layer) => layer,
  multiply: (below, layer) => below * layer,
  screen: (below, layer) => below + layer - below * layer,
  add: (below, layer) => Math.min(1, below + layer),
};

interface LayerStyle {
  color: number[];
  blend: string;
  opacity: number;
  tint: string;
}

/** What layers look like, by “Compositing and Blending Level 1” in linear light. */
function blended(layers: readonly LayerStyle[]): number[] {
  let [color, alpha] = [[0, 0, 0], 0];
  for (const { color: own, blend, opacity, tint } of layers) {
    const layerAlpha = (opacity * own[3]!) / 255;
    const whole = layerAlpha + alpha * (1 - layerAlpha);
    color = color.map((below, k) => {
      const layer = decode(own[k]!) * decode(Number.parseInt(tint.slice(1 + 2 * k, 3 + 2 * k), 16));
      const mixed = (1 - alpha) * layer + alpha * formulas[blend]!(below, layer);
      return whole === 0 ? 0 : (layerAlpha * mixed + (1 - layerAlpha) * alpha * below) / whole;
    });
    alpha = whole;
  }
  return [...color.map(encode), 255 * alpha];
}

const assertNear = (found: readonly number[], expected: readonly number[], most = 3): void =>
  found.forEach((value, k) => assert.ok(Math.abs(value - expected[k]!) <= most, `${found} is not ${expected}`));

describe('cagecast/three/layers, drawn by Chromium', () => {
  test('sixteen layers blend by the formulas of their modes; a wrong one is refused; all can be undone', async () => {
    const seen = await run<{
      styles: LayerStyle[];
      all: number[];
      moved: number[];
      undone: [string, number[]];
      fewer: number[];
      back: number[];
      count: number;
      width: number;
      errors: string[];
    }>('sixteenLayers');
    const { styles } = seen;
    assertNear(seen.all, blended(styles));
    assertNear(seen.moved, blended([styles[15]!, ...styles.slice(0, 15)]));
    assert.equal(seen.undone[0], 'moving Layer 16');
    assert.deepEqual(seen.undone[1], seen.all);
    assertNear(seen.fewer, blended(styles.slice(0, 14)));
    assert.deepEqual(seen.back, seen.all);
    assert.deepEqual([seen.count, seen.width], [16, 256]);
    const expected = [
      /^There are already 16 layers, the maximum\. Remove one first\.$/,
      /opacity is NaN, not a number from 0 to 1$/,
      /blend is "overlay", not one of normal, multiply, screen, add$/,
      /tint is "red", not a colour such as #ff8800$/,
      /place of a layer is 0\.5, not an integer$/,
      /options\.renderer is not a WebGLRenderer$/,
      /options\.renderer is not a WebGLRenderer$/,
      /texture is an object, not a Texture$/,
      /size is 0, not an integer from 1 to 2048$/,
      /size is 100, not one of 256, 512, 1024, 2048$/,
    ];
    assert.equal(seen.errors.length, expected.length);
    seen.errors.forEach((message, i) => assert.match(message, expected[i]!));
  });

  test('an option that is undefined is as one that is not there', async () => {
    assert.deepEqual(await run('undefinedStyle'), {
      added: [0xdd, 0x33, 0x11, 255],
      style: { opacity: 0.5, tint: '#ff0000', blend: 'normal', visible: true },
    });
  });

  test('a renderer with a reversed depth buffer draws layers, strokes, stickers and filled triangles', async () => {
    const { texel, counts } = await run<{ texel: number[]; counts: number[] }>('reversedDepth');
    assertNear(texel, [0xdd, 0x33, 0x11, 255]);
    for (const count of counts) assert.ok(count > 100, counts.join());
  });

  test('an update that fails is made up for by the next one', async () => {
    const { message, updated, texel } = await run<{ message: string; updated: boolean; texel: number[] }>(
      'failedUpdate',
    );
    assert.deepEqual([message, updated], ['not now', true]);
    assertNear(texel, [0xdd, 0x33, 0x11, 255]);
  });

  test('a layer may be added with all that another one, or a saved list, has: it stays a layer of its own', async () => {
    const { shown, step, list } = await run<{ shown: number[]; step: string; list: string[] }>('copiedLayers');
    assertNear(shown, [0, 0, 255, 255]);
    assert.equal(step, 'changing opacity, tint, blend, visible of red');
    assert.deepEqual(list, ['red 0.5', 'third 1']);
  });

  test('adding, removing and other layers are steps of their own, and names are not given twice', async () => {
    assert.deepEqual(await run('quickSteps'), {
      added: [2, 1, 0],
      removed: [1, 2],
      restyled: [
        [0.5, 1],
        [1, 1],
      ],
      slid: 1,
      names: ['Layer 2', 'Layer 1'],
    });
  });

  test('one stack is shown on several models as a texture would be, and drawn again only after a change', async () => {
    const { apart, hidden, idle, changed } = await run<{
      apart: number[];
      hidden: number[];
      idle: boolean;
      changed: number[];
    }>('stackOnModels');
    for (const most of apart) assert.ok(most <= 2, apart.join());
    assert.deepEqual(hidden, [0, 0]);
    assert.equal(idle, false);
    for (const count of changed) assert.ok(count > 100, changed.join());
  });
});

describe('cagecast/three/paint, drawn by Chromium', () => {
  test('a stroke can be undone and repeated; the eraser leaves nothing of it, not even its soft edge', async () => {
    const seen = await run<{
      middle: number[][];
      names: string[];
      undone: number;
      redone: number;
      soft: { texels: number; most: number };
      left: { texels: number };
      again: { texels: number };
      half: { texels: number };
      errors: string[];
      steps: number;
    }>('strokes');
    const [on, off] = seen.middle as [number[], number[]];
    assert.ok(on[0]! > 200 && on[1]! < 40, on.join());
    assert.ok(off[0] === off[1], off.join());
    assert.deepEqual(seen.names, ['stroke', 'stroke']);
    assert.deepEqual([seen.undone, seen.redone], [0, 0]);
    assert.ok(seen.soft.texels > 1000);
    assertNear([seen.soft.most], [0.6 * 255]);
    assert.equal(seen.left.texels, 0);
    assert.equal(seen.again.texels, seen.soft.texels);
    assert.ok(seen.half.texels > 0.3 * seen.soft.texels && seen.half.texels < seen.soft.texels, `${seen.half.texels}`);
    const expected = [
      /size is NaN, not a number from 0 to 2$/,
      /color is "red", not a colour such as #ff8800$/,
      /opacity is 2, not a number from 0 to 1$/,
      /a point is \(NaN, 0\), not a UV$/,
      /options\.applied is not what applyTransfer returned$/,
      /options\.applied is not what applyTransfer returned$/,
      /size is 512, not one of 1024, 2048$/,
    ];
    assert.equal(seen.errors.length, expected.length);
    seen.errors.forEach((message, i) => assert.match(message, expected[i]!));
    assert.equal(seen.steps, 1);
  });

  test('mirrored strokes paint both sides, and pressure makes them wider', async () => {
    const { sides, full, thin, widths } = await run<{
      sides: number[][];
      full: number;
      thin: number;
      widths: [number, number];
    }>('mirroredAndPressed');
    for (const [r, g] of sides) assert.ok(r! > 200 && g! < 40, sides.join(' '));
    assert.ok(thin > 0.2 * full && thin < 0.8 * full, `${thin} of ${full}`);
    assert.ok(widths[1] > 2 * widths[0] && widths[0] > 0, widths.join());
  });

  test('text and images lie upright on the model, or turned', async () => {
    const { text, upright, turned } = await run<{ text: number; upright: string[]; turned: string[] }>('stickers');
    assert.ok(text > 5, `${text}`);
    assert.deepEqual(upright, ['red', 'blue']);
    assert.deepEqual(turned, ['blue', 'red']);
  });

  test('an image that the page shows in another size is a sticker, and a mask, of its own shape', async () => {
    const { shape, masked, triangles } = await run<{ shape: number; masked: number; triangles: number }>('shownImages');
    // Four times as wide as high, in texels of a ball, which are twice as wide as high.
    assert.ok(shape > 1.7 && shape < 2.3, `${shape} times as many columns as rows`);
    assert.equal(masked, triangles);
  });

  test('stickers of a wrong size or angle, without a picture, and pressures that are no shares are refused', async () => {
    const { errors, canUndo } = await run<{ errors: string[]; canUndo: boolean }>('refusedStickers');
    const expected = [
      /size is NaN, not a number from 0 to 2$/,
      /size is -0\.2, not a number from 0 to 2$/,
      /size is 0, not a number from 0 to 2$/,
      /size is "big", not a number from 0 to 2$/,
      /size is an object, not a number from 0 to 2$/,
      /angle is NaN, not a number$/,
      /opacity is 2, not a number from 0 to 1$/,
      /the image is not loaded yet$/,
      /pressure is NaN, not a number from 0 to 1$/,
      /^cagecast\/three\/paint: the picture is undefined, not a text or an image$/,
      /the picture is undefined, not a text or an image$/,
      /the picture is an object, not a text or an image$/,
      /the picture is "A", not a text or an image$/,
      /the place is undefined, not an object with "at"$/,
      /points is undefined, not an array$/,
      /points is an object, not an array$/,
    ];
    assert.equal(errors.length, expected.length);
    errors.forEach((message, i) => assert.match(message, expected[i]!));
    assert.equal(canUndo, false);
  });

  test('a painter that was disposed of paints no more, and what it has painted can be undone', async () => {
    const { messages, texels, undone } = await run<{ messages: string[]; texels: number[]; undone: number }>(
      'disposedPainter',
    );
    assert.deepEqual(new Set(messages), new Set(['no error']));
    assert.ok(texels[0]! > 0 && texels[1] === texels[0], texels.join());
    assert.equal(undone, 0);
  });

  test('why a pointer cannot paint is reported, such as that there are too many layers', async () => {
    const { told, held } = await run<{ told: string[]; held: boolean }>('fullLayers');
    assert.equal(told.length, 2);
    assert.match(told[0]!, /already 16 layers/);
    assert.match(told[1]!, /the image is not loaded yet$/);
    assert.equal(held, false);
  });

  test('a text that is laid again has the font that was loaded meanwhile', async () => {
    const { before, after } = await run<{ before: number; after: number }>('lateFont');
    assert.ok(before > 0 && after > 1.2 * before, `${after} texels after ${before}`);
  });

  test('renderers and painters leave nothing behind when they are disposed of', async () => {
    const { made, left } = await run<{ made: number[]; left: Record<string, number> }>('leftovers');
    for (const count of made) assert.ok(count >= 3, made.join());
    assert.deepEqual(left, { renderers: 0, texels: 0, canvases: 0 });
  });

  test('painters that have painted nothing leave no listener on their layers', async () => {
    assert.deepEqual(await run('followers'), [1, 0]);
  });

  test('painters that listen to one element leave it as it was once the last has ended; none begins when disposed of', async () => {
    assert.deepEqual(await run('touchActions'), {
      ended: ['none', 'none', 'pan-y'],
      late: ['auto', 'auto', 'auto', 'auto'],
      again: ['none', 'auto'],
    });
  });

  test('a part that was taken out of a model in a scene is not picked', async () => {
    assert.deepEqual(await run('removedPart'), [true, true, true]);
  });

  test('directions on a model, mirrored or not, are those of the cage', async () => {
    for (const apart of await run<number[]>('toCage')) assert.ok(apart < 1e-6, `${apart}`);
  });

  test('stickers show a canvas as it is now, and their picture after the graphics context was lost', async () => {
    assert.deepEqual(await run('stickersAnew'), { canvas: ['red', 'blue'], picture: ['blue', 'blue', 'blue'] });
  });

  test('what was painted outlives its painter, and the graphics context', async () => {
    const { before, after, changes } = await run<{ before: number[]; after: number[]; changes: number }>(
      'paintedBefore',
    );
    assert.ok(before[0]! > 2 * before[2]!, before.join());
    assert.deepEqual(after, before);
    assert.ok(changes > 0, 'who draws on demand gets word');
  });

  test('a stroke while the graphics context is lost leaves what was painted', async () => {
    const { before, after } = await run<{ before: number[]; after: number[] }>('strokeWhileLost');
    assert.ok(before[0]! > 2 * before[2]!, before.join());
    assert.deepEqual(after, before);
  });

  test('the texture below new layers cannot be undone; given layers stay as they are', async () => {
    assert.deepEqual(await run('baseTexture'), { undone: undefined, layers: 1 });
  });

  test('a fast mouse does not make the painter look for what it is on at each of its points', async () => {
    const { picks, isPainted } = await run<{ picks: number; isPainted: boolean }>('picks');
    assert.equal(isPainted, true);
    assert.ok(picks <= 7, `${picks} times on a model of 60,000 triangles`);
  });

  test('models that were moved, turned and posed are painted where they are seen', async () => {
    const seen =
      await run<{ surface: number[]; right: number[]; scale: number; pixel: number[]; missed: boolean }[]>('posed');
    for (const { surface, right, scale, pixel, missed } of seen) {
      // Turned by a quarter about y, what was on the left is in front.
      assertNear(surface, [-1.1, 0, 0], 0.05);
      assertNear(right, [0, 0, 1], 0.05);
      assertNear([scale], [0.5], 0.01);
      assert.ok(pixel[0]! > 200 && pixel[1]! < 40, pixel.join());
      assert.ok(missed);
    }
  });

  test('pointers paint, erase and place stickers; beside the model they are left to others', async () => {
    const seen = await run<{
      during: number;
      stroke: number[];
      whole: number;
      pen: number;
      captured: number;
      beside: number;
      erased: boolean;
      sticker: number;
      two: number[];
      fingers: number[];
      penned: number[];
      rest: number;
    }>('pointers');
    assert.ok(seen.during < 40, `${seen.during} while the pointer is down`);
    for (const green of seen.stroke) assert.ok(green < 40, seen.stroke.join());
    assert.ok(seen.pen > 0 && seen.pen < 0.6 * seen.whole, `${seen.pen} of ${seen.whole}`);
    assert.deepEqual([seen.captured, seen.beside, seen.erased], [0, 1, true]);
    assert.ok(seen.sticker > 5, `${seen.sticker}`);
    assert.deepEqual([...seen.two, seen.rest], [0, 0, 0]);
    assert.deepEqual(seen.fingers.slice(0, 4), [7, 8, 7, 8], 'two fingers turn the model at once');
    assert.deepEqual(seen.penned, Array(4).fill(seen.whole), 'a hand on the screen disturbs no pen');
    assert.ok(!seen.fingers.slice(4).includes(7), 'nor does the pen turn the model');
    assert.equal(await run('rendererState'), true, 'the renderer is as it was');
  });
});
