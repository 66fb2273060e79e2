// The page in other languages: all that it says in its main flows is in the dictionaries, and is shown by them.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { Page } from 'playwright-core';
import { faults } from '../../../support/axe';
import { fitted, head, middleOf } from '../../../support/cages';
import { dictionaryOf, kCollectTexts, kLanguages, type Language, textsOf } from '../../../support/page/words';
import { drop, glb, kPlay, openSite, ready, settled } from '../../../support/site';

const site = await openSite();

const kDesk = { viewport: { width: 1440, height: 900 } };
const kFirstVisit = `localStorage.removeItem('cagecast-guide');`;
/** Names: of the page, of formats, of keys, of files and of parts of models. */
const kNames =
  /^(Cagecast|three\.js|PNG|JSON|GLB|Esc|ms|F = C \/ E|.*\.\w{2,7}|#[0-9a-f]{6}|(eye|mouth|brow|jaw)[A-Z]\w+)$/;
const kPartNames = /^((lower|upper)-teeth|[lr]-eye|skin|bust|lashes|trousers|shirt|shoes|brows)( \d+)?$/;

const isName = (words: string): boolean =>
  kNames.test(words.trim()) || kPartNames.test(words) || !/\p{L}{2}/u.test(words);

/** What of texts has no translation. */
function missing(texts: readonly string[], language: Language): string[] {
  const left = new Set<string>();
  const dictionary = dictionaryOf(language, (words) => left.add(words));
  for (const text of texts) if (dictionary.translate(text) === undefined) left.add(text);
  return [...left].filter((words) => !isName(words));
}

const openAll = (page: Page): Promise<void> =>
  page.locator('details').evaluateAll((all) => all.forEach((details) => details.setAttribute('open', '')));

/** Goes through the main flows of Play, on a first visit. */
async function play(page: Page): Promise<void> {
  const guide = page.getByTestId('guide');
  await guide.locator('.strong').click();
  for (const _ of [1, 2, 3]) await guide.locator('.strong').click();
  await page.getByTestId('stage-verdict').waitFor();
  await openAll(page);
  const frames = page.locator('#steps button');
  for (let step = 0; step < 5; ++step) await frames.nth(step).click();
  await page.locator('#method > summary').click();
  for (const key of ['b', 's']) await page.locator('#view').press(key);
  await page.locator('#view').press('t');
  await page.keyboard.press('?');
  await page.locator('dialog').waitFor();
  await page.keyboard.press('Escape');
  await drop(page, [head()]);
  await ready(page);
  await page.locator('#stage-verdict[data-verdict=good], #stage-verdict[data-verdict=usable]').waitFor();
  const { x, y } = await middleOf(page);
  await page.mouse.click(x, y);
  await page.locator('#part-menu-text:not(:empty)').waitFor();
  await page.locator('#part-menu input[value=exclude]').check({ force: true });
  await page.locator('#undo:enabled').click();
  await page.keyboard.press('Escape');
}

/** And of Inspect. */
async function inspect(page: Page): Promise<void> {
  await page.locator('#fit-verdict:not(:empty)').waitFor();
  await openAll(page);
  for (const mode of ['zones', 'segments', 'distance', 'stretch', 'checker'])
    await page.locator(`#view-mode input[value=${mode}]`).check({ force: true });
  await page.locator('#view').press('x');
  await page.locator('#view').press('Enter');
  await page.locator('#explain-bubble:not([hidden])').waitFor();
  await page.locator('#exact-borders').check({ force: true });
  await ready(page);
  await page.locator('#add-painting').click();
  await page.locator('#segment-rows select').first().selectOption('always');
  await ready(page);
  await page.locator('#open-wardrobe').click();
  await page.locator('#wardrobe-sample').selectOption('human');
  await page.locator('#avatars li:nth-child(2) .state', { hasText: /^(?!.*…)/ }).waitFor();
  await page.locator('#open-wardrobe').click();
  await page.locator('#target-input').setInputFiles(glb('poem.glb', Buffer.from('no model')));
  assert.equal(await settled(page), 'error');
  await drop(page, [head()]);
  await ready(page);
  await fitted(page);
  await page.locator('#fit-verdict:not(:empty)').waitFor();
  await page.locator('#adjust-cage').click();
  for (const what of ['turn', 'scale', 'corner', 'hole'])
    await page.locator(`#adjust input[value=${what}]`).check({ force: true });
  await page.locator('#adjust-done').click();
}

test('all that the page says in its main flows has a translation', async () => {
  const { page, complaints } = await site.visit(kDesk, kFirstVisit + kPlay + kCollectTexts);
  await play(page);
  const texts = await textsOf(page, 'ever');
  const { page: second } = await site.visit(kDesk, kCollectTexts);
  await inspect(second);
  texts.push(...(await textsOf(second, 'ever')));
  const { page: third } = await site.visit(kDesk, kCollectTexts, '#sample=avatar');
  await third.getByTestId('stage-verdict').waitFor();
  texts.push(...(await textsOf(third, 'ever')));
  assert.ok(texts.length > 500, `${texts.length} texts were found`);
  for (const language of kLanguages) assert.deepEqual(missing(texts, language), [], language);
  assert.deepEqual(complaints, []);
});

for (const language of kLanguages)
  test(`${language}: the page is shown in it, follows what happens, and has no faults; English comes back by choice`, async () => {
    const { page, complaints } = await site.visit(
      { ...kDesk, locale: language },
      `if (!sessionStorage.begun) { sessionStorage.begun = 1; ${kFirstVisit} }${kPlay};${kCollectTexts}`,
    );
    await page.locator(`html[lang=${language}]`).waitFor();
    const dictionary = dictionaryOf(language);
    /** What is shown in English, though there is a translation. */
    const english = async (): Promise<string[]> =>
      (await textsOf(page, 'now')).filter((text) => !isName(text) && (dictionary.translate(text) ?? text) !== text);
    assert.deepEqual(await english(), []);
    assert.deepEqual(await faults(page), [], 'as it opens');
    await play(page);
    assert.deepEqual(await english(), []);
    assert.deepEqual(await faults(page), [], 'after all of Play');
    await page.locator('#face').click();
    await openAll(page);
    await page.locator('#view-mode input[value=zones]').check({ force: true });
    await page.locator('#view').press('x');
    await page.locator('#view').press('Enter');
    await page.locator('#explain-bubble:not([hidden])').waitFor();
    await page.locator('#target-input').setInputFiles(glb('poem.glb', Buffer.from('no model')));
    assert.equal(await settled(page), 'error');
    assert.deepEqual(await english(), []);
    assert.deepEqual(await faults(page), [], 'in Inspect, with an error');
    assert.equal(await page.locator('#target-name').textContent(), 'bust.glb');

    await page.locator('#language').selectOption('en');
    await page.locator('html[lang=en]').waitFor();
    assert.equal(await page.locator('#target-file .role').textContent(), 'Open a model');
    assert.match((await page.getByTestId('error').textContent())!, /^poem\.glb: this is no model/);
    await page.reload();
    await settled(page);
    assert.equal(await page.locator('#language').inputValue(), 'en', 'it is remembered');
    await page.goto(`${site.url}?lang=${language}`);
    await page.locator(`html[lang=${language}]`).waitFor();
    assert.deepEqual(complaints, []);
  });
