import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../support/axe';
import { asset } from '../../support/cages';
import { difference, frames, look, modelArea } from '../../support/picture';
import { drop, glb, openSite, ready, shownParts, type Upload } from '../../support/site';

const figure = (): Upload => glb('figure.glb', asset('human-body', 'target.glb'));

/** The figure as a VRM 0 file, which looks the other way. */
function vrm(): Upload {
  const file = figure().buffer;
  const length = file.readUInt32LE(12);
  const json = JSON.parse(file.subarray(20, 20 + length).toString());
  const [scene] = json.scenes;
  json.nodes.push({ children: scene.nodes, rotation: [0, 1, 0, 0] });
  scene.nodes = [json.nodes.length - 1];
  json.extensionsUsed = [...(json.extensionsUsed ?? []), 'VRM'];
  json.extensions = { VRM: { humanoid: { humanBones: [] } } };
  const text = Buffer.from(JSON.stringify(json));
  const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')]);
  const head = Buffer.from(file.subarray(0, 20));
  head.writeUInt32LE(padded.length, 12);
  const rest = file.subarray(20 + length);
  head.writeUInt32LE(20 + padded.length + rest.length, 8);
  return glb('figure.vrm', Buffer.concat([head, padded, rest]));
}

const kScreens = [
  { name: 'desk', viewport: { width: 1440, height: 900 } },
  { name: 'phone', viewport: { width: 390, height: 844 }, hasTouch: true },
] as const;

const site = await openSite();

async function open(page: Page, uploads: Upload[]): Promise<void> {
  await drop(page, uploads);
  await ready(page);
}

/** Waits for the verdict on the cage. */
async function verdict(page: Page): Promise<string> {
  const box = page.locator('#stage-verdict:not([data-verdict=""])');
  await box.waitFor();
  return (await box.getAttribute('data-verdict'))!;
}

/** The part of the picture where the model is, in pixels: what another view mode changes. */
async function seenModel(page: Page): Promise<{ left: number; right: number; top: number; bottom: number }> {
  const style = await page.addStyleTag({ content: '#stage > :not(#view), .dock > * { opacity: 0 }' });
  const area = (await page.locator('#stage').boundingBox())!;
  const pictures = [];
  for (const mode of ['segments', 'distance']) {
    await page.locator(`#view-mode input[value=${mode}]`).check({ force: true });
    pictures.push(await look(page, area));
  }
  await style.evaluate((element) => (element as Element).remove());
  const [one, other] = pictures as [(typeof pictures)[0], (typeof pictures)[0]];
  const found = { left: Infinity, right: 0, top: Infinity, bottom: 0 };
  const scale = area.width / one.width;
  for (let at = 0; at < one.data.length; at += 4) {
    if (Math.abs(one.data[at]! - other.data[at]!) + Math.abs(one.data[at + 1]! - other.data[at + 1]!) < 40) continue;
    const [x, y] = [scale * ((at / 4) % one.width), scale * Math.floor(at / 4 / one.width)];
    found.left = Math.min(found.left, x);
    found.right = Math.max(found.right, x);
    found.top = Math.min(found.top, y);
    found.bottom = Math.max(found.bottom, y);
  }
  return {
    left: found.left + area.x,
    right: found.right + area.x,
    top: found.top + area.y,
    bottom: found.bottom + area.y,
  };
}

for (const { name, ...options } of kScreens) {
  test(`${name}: a figure under another model’s cage is called unfit, is seen whole, and its picture can be saved`, async () => {
    const { page, complaints } = await site.visit({ ...options, deviceScaleFactor: 0.5 });
    assert.equal(await verdict(page), 'good');
    assert.match((await page.locator('#stage-verdict-text').textContent())!, /^\d+ % paintable/);
    assert.deepEqual(await page.locator('#section-nav a').allTextContents(), [
      'NCZ',
      'Model',
      'Paint',
      'Motion',
      'Share',
    ]);
    const inside = (selector: string): Promise<boolean[]> =>
      page.locator(selector).evaluateAll((all) =>
        all.map((element) => {
          const { left, right, top, bottom } = element.getBoundingClientRect();
          return left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight;
        }),
      );
    for (const selector of ['#section-nav a', '#view-mode label', '.toggle', '#stage-verdict', '#stage-share'])
      assert.ok((await inside(selector)).every(Boolean), `${selector} is seen without scrolling`);

    await open(page, [figure(), glb('cage.glb', asset('lizard', 'cage.glb'))]);
    assert.equal(await verdict(page), 'unfit');
    assert.deepEqual(await inside('#stage-verdict'), [true]);
    assert.equal(await page.locator('#stage-verdict-text').textContent(), 'The cage does not fit');
    assert.equal(await page.getByTestId('stage-remedy').textContent(), 'Move the cage');
    assert.deepEqual(await faults(page), []);

    if (name === 'phone') {
      const small = await page
        .locator(
          '#stage :is(button, label, input[type=color]), .section-nav a, .quiet, .icon, .eye, select, summary, .file',
        )
        .evaluateAll((all) =>
          all.flatMap((control) => {
            const { width, height } = control.getBoundingClientRect();
            return control.checkVisibility() && Math.min(width, height) < 43.5 ? control.outerHTML.slice(0, 80) : [];
          }),
        );
      assert.deepEqual(small, [], 'large enough for a finger');
    }
    const box = async (selector: string) => (await page.locator(selector).boundingBox())!;
    const [head, rail, bar] = [await box('#stage-share'), await box('#tools'), await box('.toolbar')];
    const seen = await seenModel(page);
    assert.ok(seen.bottom < bar.y, `it ends at ${seen.bottom}, the toolbar begins at ${bar.y}`);
    assert.ok(seen.left >= rail.x + rail.width, `it begins at ${seen.left}, the rail ends at ${rail.x + rail.width}`);
    if (name === 'phone')
      assert.ok(seen.top > head.y + head.height, `it begins at ${seen.top}, under ${head.y + head.height}`);
    assert.ok(
      seen.bottom - seen.top > 0.75 * (bar.y - (name === 'phone' ? head.y + head.height : 0)),
      'and it is large',
    );

    const [download] = await Promise.all([page.waitForEvent('download'), page.getByTestId('export-glb').click()]);
    assert.equal(download.suggestedFilename(), 'figure-painted.glb');
    assert.deepEqual(complaints, []);
  });
}

test('a VRM opens from its front; buttons and keys show front, side and the whole model', async () => {
  const { page } = await site.visit({ viewport: { width: 900, height: 600 } });
  assert.match((await page.getByTestId('target-input').getAttribute('accept'))!, /\.vrm/);
  await open(page, [figure()]);
  await page.locator('#view-mode input[value=distance]').check({ force: true });
  const area = await modelArea(page);
  const front = await look(page, area);
  await open(page, [vrm()]);
  assert.ok(difference(front, await look(page, area)) < 0.02, 'as the figure that looks forward');

  const button = (name: string): Promise<void> => page.getByRole('button', { name, exact: true }).click();
  await button('Left');
  const side = await look(page, area);
  assert.ok(difference(front, side) > 0.02);
  await button('Front');
  const straight = await look(page, area);
  await page.locator('#view').press('2');
  assert.ok(difference(side, await look(page, area)) < 0.002);
  for (let i = 0; i < 5; i++) await page.locator('#view').press('+');
  assert.ok(difference(side, await look(page, area)) > 0.02);
  await page.locator('#view').press('0');
  assert.ok(difference(side, await look(page, area)) < 0.01, 'as large as it fits');
  await page.locator('#view').press('1');
  assert.ok(difference(straight, await look(page, area)) < 0.002);
});

test('the wheel brings near what is under the pointer; the right button and Shift with arrow keys move the view', async () => {
  const { page, complaints } = await site.visit({ viewport: { width: 1000, height: 700 } });
  await open(page, [figure()]);
  await page.locator('#view').press('1');
  for (let i = 0; i < 4; i++) await page.locator('#view').press('-');
  const crown = async (): Promise<{ x: number; y: number }> => {
    const { left, right, top } = await seenModel(page);
    return { x: (left + right) / 2, y: top };
  };
  const before = await crown();
  assert.ok(before.y > 60);
  await page.mouse.move(before.x, before.y + 4);
  for (let i = 0; i < 8; i++) {
    await page.mouse.wheel(0, -120);
    await frames(page, 2);
  }
  const near = await crown();
  assert.ok(Math.abs(near.y - before.y) < 15, `the head stays under the pointer: from ${before.y} to ${near.y}`);

  await page.mouse.move(before.x, before.y + 4);
  await page.mouse.down({ button: 'right' });
  await page.mouse.move(before.x, before.y + 104, { steps: 5 });
  await page.mouse.up({ button: 'right' });
  await frames(page, 40); // the glide ends
  const lower = await crown();
  assert.ok(lower.y > near.y + 70, `from ${near.y} to ${lower.y}`);
  await page.locator('#view').press('Shift+ArrowUp');
  await frames(page, 40); // the glide ends
  assert.ok((await crown()).y > lower.y + 5, 'the eye moves up, so the model moves down');

  await page.locator('#view').press('1');
  for (let i = 0; i < 4; i++) await page.locator('#view').press('-');
  assert.ok(Math.abs((await crown()).y - before.y) < 3, 'and all comes back');
  assert.deepEqual(complaints, []);
});

test('while one paints, colour, size, undo and redo are on the stage; a part that is clicked can be chosen for', async () => {
  const { page } = await site.visit({ viewport: { width: 390, height: 844 }, hasTouch: true });
  assert.ok(await page.locator('#quick-paint').isHidden());
  await page.locator('#tools input[data-key=b]').check({ force: true });
  for (const id of ['quick-color', 'quick-size', 'quick-undo', 'quick-redo']) {
    const { width, height, y } = (await page.locator(`#${id}`).boundingBox())!;
    assert.ok(Math.min(width, height) >= 44 && y + height < 500, `${id}: ${width} × ${height} at ${y}`);
  }
  await page.locator('#quick-color').fill('#00ff00');
  await page.locator('#quick-size').fill('70');
  assert.equal(await page.getByTestId('brush-color').inputValue(), '#00ff00');
  assert.equal(await page.getByTestId('brush-size').inputValue(), '70');
  const area = { x: 140, y: 130, width: 170, height: 250 };
  const bare = await look(page, area);
  await page.mouse.move(area.x + 0.4 * area.width, area.y + 0.3 * area.height);
  await page.mouse.down();
  await page.mouse.move(area.x + 0.45 * area.width, area.y + 0.35 * area.height, { steps: 3 });
  await page.mouse.up();
  await page.mouse.move(5, 5);
  assert.ok(difference(bare, await look(page, area)) > 0.01, 'it is painted');
  await page.locator('#quick-undo').click();
  await page.mouse.move(5, 5);
  assert.ok(difference(bare, await look(page, area)) < 0.002, 'and undone');
  await page.locator('#tools input[data-key=e]').check({ force: true });
  assert.ok(await page.locator('#quick-color').isHidden(), 'the eraser has no colour');
  assert.deepEqual(await faults(page), []);

  await page.locator('#tools input[data-key=t]').check({ force: true });
  await page.locator('#view-mode input[value=segments]').check({ force: true });
  await page.locator('#view').click({ position: { x: 195, y: 180 } });
  const menu = page.getByTestId('part-menu');
  const name = (await menu.locator('b').textContent())!;
  assert.match((await menu.locator('#part-menu-text').textContent())!, /^[1-9][\d,]* of [\d,]+ points are painted\./);
  const { x, width } = (await menu.boundingBox())!;
  assert.ok(x >= 0 && x + width <= 390);
  assert.deepEqual(await faults(page), []);
  await menu.getByRole('radio', { name: 'Keep bare' }).check({ force: true });
  assert.match((await menu.locator('#part-menu-text').textContent())!, /^0 of .* the whole part is not painted/);
  assert.deepEqual(
    (await shownParts(page)).filter(({ lock }) => lock !== 'auto').map((part) => [part.name, part.lock]),
    [[name, 'exclude']],
  );
  await page.keyboard.press('Escape');
  assert.ok(await menu.isHidden());

  // By the keyboard, the part at the centre; what is kept says why it stays bare.
  await page.locator('#view').press('Enter');
  await menu.getByRole('radio', { name: 'Keep', exact: true }).check({ force: true });
  assert.match((await page.getByTestId('keep-note').textContent())!, /is kept: .* of .* points are painted/);
});
