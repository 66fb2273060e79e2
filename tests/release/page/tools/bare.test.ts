import assert from 'node:assert/strict';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { faults } from '../../../support/axe';
import { asset, middleOf } from '../../../support/cages';
import { difference, look, modelArea } from '../../../support/picture';
import { saved } from '../../../support/saved';
import { drop, glb, openSite, passed, ready, shownCounts } from '../../../support/site';

const site = await openSite();

/** Opens a head in one piece, eyes and all, with a cage that was made for it, and begins to mark. */
async function begin(page: Page): Promise<void> {
  await drop(page, [glb('scan.glb', asset('human-fused', 'target.glb'))]);
  await ready(page);
  await page.getByTestId('make-cage').click();
  await page.locator('#cage-note', { hasText: 'was made' }).waitFor();
  await ready(page);
  await page.getByTestId('make-options').locator('summary').click();
  await page.getByTestId('bare-brush').click();
}

/** How many edges of the saved cage have one triangle only. */
async function openEdges(page: Page): Promise<number> {
  const document = await new NodeIO().readBinary((await saved(page, 'save-cage')).bytes);
  const [primitive] = document.getRoot().listMeshes()[0]!.listPrimitives();
  const position = primitive!.getAttribute('POSITION')!;
  const corners = [...primitive!.getIndices()!.getArray()!].map((vertex) => position.getElement(vertex, []).join());
  const edges = new Map<string, number>();
  corners.forEach((from, i) => {
    const key = [from, corners[i % 3 === 2 ? i - 2 : i + 1]!].sort().join(' ');
    edges.set(key, (edges.get(key) ?? 0) + 1);
  });
  return [...edges.values()].filter((count) => count === 1).length;
}

const markedCount = async (page: Page): Promise<number> =>
  Number(/^[\d,]+/.exec((await page.getByTestId('bare-count').textContent())!)?.[0].replace(',', '') ?? 0);

/** Waits until the cage has followed the marks. */
async function followed(page: Page): Promise<void> {
  await passed(page, 1500); // longer than the page waits before it makes the cage again
  await ready(page);
}

/** Waits until the browser keeps everything. */
const kept = (page: Page): Promise<unknown> =>
  page.waitForFunction(() => dispatchEvent(new Event('beforeunload', { cancelable: true })));

test('marked spots stay bare, and the made cage has a hole there; marks are erased, undone, and back after a reload', async () => {
  const { page, complaints } = await site.visit();
  await begin(page);
  const [unmarked, closed] = [await shownCounts(page), await openEdges(page)];
  assert.deepEqual(await faults(page), []);
  const area = await modelArea(page);
  const plain = await look(page, area);
  const { x, y } = await middleOf(page);
  const stroke = async (): Promise<void> => {
    await page.mouse.move(x - 25, y - 60);
    await page.mouse.down();
    await page.mouse.move(x + 25, y - 60, { steps: 2 });
    await page.mouse.up();
  };
  await page.getByTestId('bare-size').fill('75');
  await stroke();
  const count = await markedCount(page);
  assert.ok(count > 50, `${count} triangles are marked`);
  const marked = await shownCounts(page);
  assert.ok(marked.culled > unmarked.culled + 20, `${unmarked.culled} points were culled, and ${marked.culled} are`);
  assert.ok(difference(plain, await look(page, area)) > 0.01, 'the marks are seen');
  assert.deepEqual(await faults(page), []);
  await followed(page);
  const open = await openEdges(page);
  assert.ok(open > closed + 3, `the cage had ${closed} open edges, and has ${open}`);

  // Erased in one stroke, and back by undo.
  await page.getByTestId('bare-erase').check({ force: true });
  await stroke();
  assert.ok((await markedCount(page)) < count / 10);
  await page.keyboard.press('Control+z');
  assert.equal(await markedCount(page), count);
  assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: marking what stays bare');
  await page.keyboard.press('Control+z');
  assert.equal(await markedCount(page), 0);
  await page.keyboard.press('Control+Shift+z');
  assert.equal(await markedCount(page), count);

  // Explained where it is.
  await followed(page);
  await page.locator('#tools input[data-key=x]').check({ force: true });
  await page.mouse.click(x, y - 60);
  assert.match((await page.locator('#explain-brief').textContent())!, /^Not painted: marked/);

  await kept(page);
  const before = await shownCounts(page);
  await page.reload();
  await page.getByTestId('ask').filter({ hasText: 'Your last work is back.' }).waitFor();
  await ready(page);
  assert.deepEqual(await shownCounts(page), before);
  await page.locator('#tools input[data-key=n]').waitFor({ state: 'attached' }); // its tool is there at once
  await page.getByTestId('make-options').locator('summary').click();
  await page.getByTestId('bare-brush').click();
  assert.equal(await markedCount(page), count);
  await page.getByTestId('bare-clear').click();
  assert.equal(await markedCount(page), 0);
  assert.ok((await shownCounts(page)).culled < before.culled - 20);
  assert.deepEqual(complaints, []);
});
