// What a visitor does first, in one browser and three visits: most of it needs no picture, and is done without WebGL.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import type { Primitive } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { faults } from '../support/axe';
import { asset } from '../support/cages';
import { GlbMaker, glbOf, tetrahedron } from '../support/glb';
import { filled, image, names, savedTexture } from '../support/layers';
import { type Area, columns, difference, look, modelArea, shareOfHue } from '../support/picture';
import { primitivesOf, saved, validModel } from '../support/saved';
import {
  drop,
  glb,
  kNoWebGl,
  kPlay,
  openSite,
  ready,
  setThreshold,
  settled,
  shownCounts,
  shownError,
  shownParts,
  type Visit,
  violetPaint,
} from '../support/site';

const site = await openSite();
let visit: Visit;
let page: Page;
let area: Area;

/** Chooses in a list, and waits for what follows. */
async function choose(list: string, value: string): Promise<void> {
  await page.getByTestId(list).selectOption(value);
  await ready(page);
}

const isPainted = (primitive: Primitive): boolean => primitive.listSemantics().includes('_NCZ');
const check = (what: string): Promise<void> => page.locator(what).check({ force: true });
const undoTitle = () => page.getByTestId('undo').getAttribute('title');
const bust = () => [glb('bust.glb', asset('human', 'target.glb')), glb('bust-cage.glb', asset('human', 'cage.glb'))];

describe('without a picture', () => {
  before(async () => {
    visit = await site.visit({}, kNoWebGl);
    page = visit.page;
  });
  after(() => assert.deepEqual([visit.complaints, visit.foreign], [[], []]));

  test('the page opens with the first sample, and says that there is no picture', async () => {
    await ready(page);
    const { cosmetic, occluded, uncovered, culled } = await shownCounts(page);
    assert.ok(cosmetic > 0 && occluded > 0 && uncovered > 0);
    const total = Number((await page.locator('#count-total').textContent())!.replaceAll(',', ''));
    assert.equal(cosmetic + occluded + uncovered + culled, total);
    assert.match((await page.locator('#stage-notice').textContent())!, /WebGL/);
    const still = page.getByAltText(/lizard/);
    await still.evaluate((one: HTMLImageElement) => one.decode());
    assert.deepEqual(await faults(page), []);
  });

  test('the content security policy forbids other hosts', async () => {
    const refused = await page.evaluate(() =>
      fetch('https://example.org/').then(
        () => false,
        () => true,
      ),
    );
    assert.ok(refused);
    visit.complaints.length = visit.foreign.length = 0; // this one
  });

  test('the threshold, and the overrides of parts, change the counts at once and back', async () => {
    const before = await shownCounts(page);
    await setThreshold(page, 1);
    const strict = await shownCounts(page);
    assert.ok(strict.cosmetic < before.cosmetic);
    await setThreshold(page, 0.5);
    const { name } = (await shownParts(page)).find(({ culled }) => !culled)!;
    const override = page.getByLabel(`Override for ${name}`, { exact: true });
    await override.selectOption('exclude');
    assert.ok((await shownCounts(page)).culled > before.culled);
    assert.equal(await undoTitle(), `Undo: excluding ${name}`);
    await page.keyboard.press('Control+z');
    assert.equal(await override.inputValue(), 'auto');
    assert.deepEqual(await shownCounts(page), before);
  });

  test('the preset of the paper has fewer steps and other counts', async () => {
    const steps = () => page.locator('#timings th').count();
    const before = { counts: await shownCounts(page), steps: await steps() };
    await choose('preset', 'paper');
    assert.notDeepEqual(await shownCounts(page), before.counts);
    assert.ok((await steps()) < before.steps);
    await page.locator('#code', { hasText: "texture, preset: 'paper' }" }).waitFor();
    await choose('preset', 'default');
    assert.deepEqual({ counts: await shownCounts(page), steps: await steps() }, before);
  });

  test('the model can be deformed, and the counts follow', async () => {
    const before = await shownCounts(page);
    const still = page.locator('#live[aria-busy=true]');
    await page.getByTestId('amount').fill('0.9');
    await still.waitFor({ state: 'detached' });
    assert.notDeepEqual(await shownCounts(page), before);
    await page.getByTestId('amount').fill('0');
    await still.waitFor({ state: 'detached' });
    assert.deepEqual(await shownCounts(page), before);
  });

  test('a link restores the state in a page that shows something else', async () => {
    await setThreshold(page, 0.35);
    await page.getByTestId('share-link').focus();
    const link = await page.getByTestId('share-link').evaluate((one) => (one as HTMLAnchorElement).hash);
    const before = await shownCounts(page);
    await choose('sample-select', 'human');
    await setThreshold(page, 0.5);
    await page.evaluate((hash) => void (location.hash = hash), link);
    await page.locator('#sample-select').evaluate(async (select: HTMLSelectElement) => {
      while (select.value !== 'lizard') await new Promise(requestAnimationFrame);
    });
    await ready(page);
    assert.deepEqual(await shownCounts(page), before);
    await setThreshold(page, 0.5);
  });

  test('a file that cannot be read is reported, and the next one works', async () => {
    const before = await shownCounts(page);
    await page.getByTestId('target-input').setInputFiles(glb('poem.glb', Buffer.from('Shall I compare thee')));
    assert.equal(await settled(page), 'error');
    assert.match(await shownError(page), /poem\.glb: .*no model that can be opened/);
    assert.deepEqual(await shownCounts(page), before);
    assert.deepEqual(await faults(page), []);
    const cube = [
      glb('thing.glb', glbOf(tetrahedron(), 'thing')),
      glb('thing-cage.glb', glbOf(tetrahedron(2), 'thing')),
    ];
    await drop(page, cube);
    await ready(page);
    assert.equal(await shownError(page), '');
    assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 });
    assert.deepEqual((await page.locator('.files .name').allTextContents()).slice(0, 2), [
      'thing.glb',
      'thing-cage.glb',
    ]);
  });

  test('own paints are layers, which are restyled, moved and removed, as steps that can be undone', async () => {
    await drop(page, bust());
    await ready(page);
    for (const name of ['one.png', 'two.png']) {
      await page.getByTestId('texture-input').setInputFiles(image(name, 8, () => [200, 0, 220, 255]));
      await page.getByTestId('layer-list').getByText(name).waitFor();
    }
    const list = page.getByTestId('layer-list');
    await list.getByRole('slider', { name: 'Opacity of two.png' }).fill('40');
    await list.getByRole('button', { name: 'Reorder two.png' }).press('ArrowDown');
    await list.getByRole('button', { name: 'Remove one.png' }).click();
    assert.deepEqual((await names(page)).slice(0, 1), ['two.png']);
    for (const title of ['removing one.png', 'moving two.png', 'changing the opacity of two.png', 'adding two.png']) {
      assert.equal(await undoTitle(), `Undo: ${title}`);
      await page.getByTestId('undo').click();
    }
    assert.deepEqual((await names(page)).slice(0, 1), ['one.png']);
    await page.getByTestId('redo').click();
    assert.deepEqual((await names(page)).slice(0, 2), ['two.png', 'one.png']);
  });

  test('layers of another cage are put away, and brought back', async () => {
    const before = await names(page);
    await page.getByTestId('cage-input').setInputFiles(glb('other-cage.glb', asset('car', 'cage.glb')));
    await ready(page);
    await page.getByTestId('put-away').filter({ hasText: '2 layers of earlier cages put away.' }).waitFor();
    await page.locator('#bring-back').click();
    assert.deepEqual((await names(page)).slice(0, 2), before.slice(0, 2));
    await choose('sample-select', 'car');
  });

  test('a model that is opened alone is fitted a template and painted; so is a cage that is made, and another fit', async () => {
    await drop(page, bust().slice(0, 1));
    await ready(page);
    assert.match((await page.locator('#cage-note').textContent())!, /^The template was fitted/);
    assert.deepEqual(
      [await page.locator('#texture-name').textContent(), (await names(page)).at(-1)],
      ['Tiger', 'Tiger'],
    );
    assert.ok((await shownCounts(page)).cosmetic > 4000, 'head and neck');
    assert.ok(await page.locator('#swap').isHidden());
    const paints = page.locator('#paints label');
    await paints.filter({ hasText: 'Skull' }).click();
    await page.locator('#texture-name', { hasText: 'Skull' }).waitFor({ state: 'attached' });
    await page.getByTestId('make-cage').click();
    await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
    await ready(page);
    assert.ok((await shownCounts(page)).cosmetic > 0);
    assert.deepEqual((await names(page)).at(-1), 'Skull', 'the same paint, drawn for this cage');
    await page.getByTestId('fit-cage').click();
    await page.locator('#cage-note', { hasText: 'was fitted' }).waitFor();
    await ready(page);
    const { name, bytes } = await saved(page, 'save-cage');
    assert.equal(name, 'bust-cage.glb');
    await validModel(bytes);
  });

  test('a part that hides the rest is left out with a click, in what is saved too, and taken back with another', async () => {
    const maker = new GlbMaker();
    for (const [name, size] of [
      ['Head', 1],
      ['Visor', 1.2],
    ] as const)
      maker.node({ mesh: maker.mesh(tetrahedron(size)), name });
    await drop(page, [glb('knight.glb', maker.finish()), glb('knight-cage.glb', glbOf(tetrahedron(1.5), 'Cage'))]);
    await ready(page);
    const before = await shownCounts(page);
    await page.getByRole('button', { name: 'Do it: leave out “Visor”' }).press('Enter');
    const back = page.getByRole('button', { name: 'Take back “Visor”' });
    await back.and(page.locator(':focus')).waitFor();
    await ready(page);
    const leftOut = await shownCounts(page);
    assert.notDeepEqual(leftOut, before);
    const { bytes } = await saved(page, 'export-glb');
    const nodes = (await validModel(bytes)).getRoot().listNodes();
    const painted = nodes.filter((node) => node.getMesh()?.listPrimitives().some(isPainted));
    assert.deepEqual(
      painted.map((node) => node.getName()),
      ['Head'],
    );
    assert.deepEqual(await faults(page), []);
    await page.getByTestId('undo').click();
    await back.waitFor({ state: 'detached' });
    await ready(page);
    assert.deepEqual(await shownCounts(page), before);
    await page.getByTestId('redo').click();
    await back.press('Enter');
    await back.waitFor({ state: 'detached' });
    await ready(page);
    assert.deepEqual(await shownCounts(page), before);
  });

  test('the cage is inspected, and findings offer what can be done', async () => {
    await choose('sample-select', 'human-misaligned');
    await page.locator('#stage-verdict[data-verdict=unfit]').waitFor();
    assert.ok((await page.locator('#fit-findings li').count()) > 0);
    await page.getByRole('button', { name: 'Do it: move the cage' }).first().click();
    await page.locator('#cage-note', { hasText: 'was moved into place' }).waitFor();
    await page.locator('#stage-verdict:not([data-verdict=unfit]):not([data-verdict=""])').waitFor();
  });

  test('a project that was saved brings everything back, and so does a reload', async () => {
    await setThreshold(page, 0.65);
    await ready(page);
    const state = async () => ({
      files: await page.locator('.files .name').allTextContents(),
      counts: await shownCounts(page),
      threshold: await page.getByTestId('threshold').inputValue(),
      layers: await names(page),
    });
    const before = await state();
    const { name, bytes } = await saved(page, 'save-project');
    assert.equal(name, 'target.cagecast');
    assert.equal(bytes.subarray(0, 2).toString(), 'PK', 'it is a ZIP');
    await choose('sample-select', 'car');
    await setThreshold(page, 0.5);
    await drop(page, [{ name, mimeType: '', buffer: bytes }]);
    await page.locator('#threshold').evaluate(async (slider: HTMLInputElement) => {
      while (slider.value !== '0.65') await new Promise(requestAnimationFrame);
    });
    await ready(page);
    assert.deepEqual(await state(), before);
    await setThreshold(page, 0.7);
    const changed = await state();
    // It asks before it is left until the browser keeps it.
    await page.waitForFunction(() => dispatchEvent(new Event('beforeunload', { cancelable: true })));
    await page.getByTestId('kept-note').filter({ hasText: 'Your work is kept on this device' }).waitFor();
    await page.reload();
    await page.getByTestId('ask').filter({ hasText: 'Your last work is back.' }).waitFor();
    await ready(page);
    assert.deepEqual(await state(), changed);
    assert.deepEqual(await faults(page), []);
  });
});

describe('with a picture', () => {
  before(async () => {
    visit = await site.visit({ viewport: { width: 900, height: 560 } });
    page = visit.page;
    area = await modelArea(page);
  });
  after(() => assert.deepEqual([visit.complaints, visit.foreign], [[], []]));

  const mode = (value: string): Promise<void> => check(`#view-mode input[value=${value}]`);
  const at = (u: number, v: number) => [area.x + u * area.width, area.y + v * area.height] as const;

  test('each view mode shows another picture, and some have a legend; the divider separates naive and filtered', async () => {
    const pictures = [];
    const modes = ['compare', 'result', 'naive', 'zones', 'segments', 'checker', 'distance', 'stretch'];
    for (const one of modes) {
      await mode(one);
      for (const other of pictures) assert.ok(difference(other, await look(page, area)) > 0.01, one);
      pictures.push(await look(page, area));
      const hasLegend = ['zones', 'distance', 'stretch'].includes(one);
      assert.equal(await page.locator('#legend').isVisible(), hasLegend, one);
    }
    const [compared, result, naive, zones] = pictures;
    assert.ok(difference(columns(compared!, 0, 0.45), columns(naive!, 0, 0.45)) < 0.002, 'naive on the left');
    assert.ok(difference(columns(compared!, 0.55, 1), columns(result!, 0.55, 1)) < 0.002, 'filtered on the right');
    const [blue, orange] = [shareOfHue(zones!, 202), shareOfHue(zones!, 41)];
    assert.ok(blue > 0.005 && orange > 0.005, `occluded in blue (${blue}), uncovered in orange (${orange})`);
  });

  test('the model turns by keys and by a drag, and Home resets it', async () => {
    await mode('result');
    const home = await look(page, area);
    await page.locator('#view').press('ArrowRight');
    assert.ok(difference(home, await look(page, area)) > 0.02);
    await page.locator('#view').press('Home');
    assert.ok(difference(home, await look(page, area)) < 0.01);
    await page.mouse.move(...at(0.5, 0.5));
    await page.mouse.down();
    await page.mouse.move(...at(0.7, 0.5), { steps: 3 });
    await page.mouse.up();
    assert.ok(difference(home, await look(page, area)) > 0.02);
    await page.locator('#view').press('Home');
  });

  test('an own paint is drawn on the model, the light changes it, and the cage is drawn', async () => {
    await page.getByTestId('texture-input').setInputFiles(violetPaint());
    await ready(page);
    const violet = await look(page, area);
    assert.ok(shareOfHue(violet, 295) > 0.1);
    await page.getByTestId('light').selectOption('evening');
    assert.ok(difference(violet, await look(page, area)) > 0.05);
    await page.getByTestId('light').selectOption('studio');
    await check('#show-cage');
    assert.ok(difference(violet, await look(page, area)) > 0.02);
    await page.locator('#show-cage').uncheck({ force: true });
    await page.locator('#undo').click();
  });

  test('exact borders are cut, and switched off without a trace', async () => {
    const plain = await look(page, area);
    await check('#exact-borders');
    await page
      .getByTestId('borders-note')
      .filter({ hasText: /^Adds [\d,]+ triangles\.$/ })
      .waitFor();
    await ready(page);
    await page.locator('#exact-borders').uncheck({ force: true });
    assert.ok(difference(plain, await look(page, area)) < 0.0005);
  });

  test('a spot is explained, and a part that is clicked can be chosen for', async () => {
    await check('#tools input[data-key=x]');
    await page.mouse.click(...at(0.5, 0.5));
    assert.match(await page.getByTestId('explain-bubble').innerText(), /^(Painted|Not painted)/);
    const spot = page.getByTestId('explain-bubble').locator('.swatch');
    const colour = await spot.evaluate((one) => getComputedStyle(one).backgroundColor);
    assert.notEqual(colour, 'rgba(0, 0, 0, 0)', 'it has the colour of its zone');
    await page.keyboard.press('Escape');
    await check('#tools input[data-key=t]');
    await mode('segments');
    await page.locator('#view').press('Enter');
    await page.getByTestId('part-menu').waitFor();
    assert.deepEqual(await faults(page), []);
    await page.locator('#part-menu-close').press('Enter');
    await mode('result');
  });

  test('a stroke is on a new layer and on the model, is saved, and undone', async () => {
    const [bare, before] = [await look(page, area), filled(await savedTexture(page))];
    await check('#tools input[data-key=b]');
    await page.getByTestId('brush-color').fill('#00c040');
    await page.mouse.move(...at(0.45, 0.45));
    await page.mouse.down();
    await page.mouse.move(...at(0.55, 0.5), { steps: 4 });
    await page.mouse.up();
    await page.mouse.move(5, 5);
    assert.equal((await names(page))[0], 'Painting 1');
    assert.ok(difference(bare, await look(page, area)) > 0.002);
    const { name, bytes } = await saved(page, 'export-glb');
    assert.equal(name, 'target-painted.glb');
    const zones = primitivesOf(await validModel(bytes)).flatMap((one) => [
      ...(one.getAttribute('_NCZ')?.getArray() ?? []),
    ]);
    assert.ok(zones.length > 0 && zones.includes(0));
    await page.keyboard.press('Control+z');
    assert.equal(filled(await savedTexture(page)), before);
    assert.ok(difference(bare, await look(page, area)) < 0.0005);
    await check('#tools input[data-key=t]');
  });

  test('a sticker is placed, and the eraser and the filler are at hand', async () => {
    const before = (await names(page)).length;
    await check('#tools input[data-key=s]');
    await page.getByTestId('sticker-text').fill('FLAG');
    await page.mouse.click(...at(0.5, 0.45));
    await page.getByTestId('layer-list').getByText('Stickers 1').waitFor();
    await page.keyboard.press('Control+z');
    assert.equal((await names(page)).length, before);
    await check('#tools input[data-key=t]');
  });

  test('what is hidden while it has the focus gives it to the stage', async () => {
    await page.getByTestId('target-input').setInputFiles(glb('x.glb', Buffer.from('x')));
    await page.locator('#alert-close').waitFor();
    await page.locator('#alert-close').press('Enter');
    assert.equal(await page.evaluate(() => document.activeElement!.id), 'view');
  });

  test('another avatar stands beside the model, comes on the stage, and all are saved', async () => {
    await page.getByTestId('open-wardrobe').click();
    await page.getByTestId('wardrobe-sample').selectOption('human');
    const cards = page.locator('.avatars .avatar');
    await cards.nth(1).filter({ hasText: 'other paint' }).waitFor();
    await cards.nth(1).click();
    await page.locator('.avatars li:nth-child(2) .avatar[aria-pressed=true]').waitFor();
    await ready(page);
    assert.equal(await page.getByTestId('sample-select').inputValue(), 'human');
    assert.deepEqual(await faults(page), []);
    const { name } = await saved(page, 'export-all');
    assert.equal(name, 'avatars-painted.zip');
    await page
      .locator('#avatars')
      .getByRole('button', { name: /^Remove / })
      .press('Enter');
    await page.locator('.avatars li:only-child .avatar[aria-pressed=true]').waitFor();
    await ready(page);
  });
});

describe('on a phone', () => {
  before(async () => {
    const first = `${kNoWebGl} ${kPlay} localStorage.removeItem('cagecast-guide');`;
    visit = await site.visit({ viewport: { width: 390, height: 844 }, hasTouch: true }, first);
    page = visit.page;
  });

  test('nothing overflows, and a first visit is offered a way through the page', async () => {
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    const guide = page.getByTestId('guide');
    await guide.getByRole('button', { name: 'Show me' }).click();
    for (let step = 1; step <= 3; step++) {
      assert.match((await guide.textContent())!, new RegExp(`Step ${step} of 3`));
      await page.keyboard.press('Enter');
    }
    await guide.waitFor({ state: 'detached' });
    assert.deepEqual(await faults(page), []);
    assert.deepEqual(visit.complaints, []);
  });
});
