import assert from 'node:assert/strict';
import { test } from 'node:test';
import type { PNG } from 'pngjs';
import { difference, look, modelArea, shareOfHue } from '../../support/picture';
import { drop, openSite, ready, setThreshold, type Visit, violetPaint } from '../../support/site';

const site = await openSite();
// One page for all of it: a file's result must not depend on the files before.
const visit = await site.visit();

/** Goes back to what the page opens with. */
async function fresh(): Promise<Visit> {
  const { page } = visit;
  await page.getByTestId('sample-select').selectOption({ index: 0 });
  await setThreshold(page, 0.5);
  await page.getByTestId('preset').selectOption('default');
  await page.locator('input[value=compare]').check({ force: true });
  await ready(page);
  return visit;
}

test('a model is drawn by the programs of the one before, if it is of the same kind', async () => {
  const { page } = await fresh();
  await page.evaluate(() => {
    const { linkProgram } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.linkProgram = function (program) {
      document.body.dataset['linked'] = String(Number(document.body.dataset['linked'] ?? 0) + 1);
      linkProgram.call(this, program);
    };
  });
  const area = await modelArea(page);
  /** Shows a sample. @returns How many programs were linked so far, and the picture. */
  const show = async (sample: string): Promise<[linked: number, picture: PNG]> => {
    await page.getByTestId('sample-select').selectOption(sample);
    await ready(page);
    const picture = await look(page, area);
    return [Number(await page.evaluate(() => document.body.dataset['linked'] ?? 0)), picture];
  };
  const [linked, human] = await show('human');
  const [linkedThen, misaligned] = await show('human-misaligned');
  assert.ok(difference(human, misaligned) > 0.01, 'the paint is seen elsewhere');
  assert.equal(linkedThen, linked);
});

test('an OBJ is opened with the MTL and the image that are dropped with it', async () => {
  const { page, complaints } = await fresh();
  const text = (name: string, lines: string) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(lines) });
  const corners = [0, 1].flatMap((x) => [0, 1].flatMap((y) => [0, 1].map((z) => `v ${x} ${y} ${z}`))).join('\n');
  const sides = ['1 2 4 3', '5 7 8 6', '1 5 6 2', '3 4 8 7', '1 3 7 5', '2 6 8 4'];
  const faces = sides.map((side) => `f ${side.replace(/\d/g, (v) => `${v}/${1 + (Number(v) % 3)}`)}`).join('\n');
  const image = violetPaint();
  await drop(page, [
    text('cube.obj', `mtllib cube.mtl\n${corners}\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl skin\n${faces}\n`),
    text('cube.mtl', `newmtl skin\nKd 1 1 1\nmap_Kd ${image.name}\n`),
    image,
  ]);
  await page.locator('#target-name', { hasText: 'cube.glb' }).waitFor();
  assert.deepEqual(complaints, []);
});

test('an own paint, PNG or JPEG, is drawn on the model', async () => {
  const { page, complaints } = await fresh();
  await page.locator('input[value=result]').check({ force: true });
  const area = await modelArea(page);
  assert.ok(shareOfHue(await look(page, area), 295) < 0.01);
  await page.getByTestId('texture-input').setInputFiles(violetPaint());
  await ready(page);
  const violet = shareOfHue(await look(page, area), 295);
  assert.ok(violet > 0.1, `${violet} of the picture is violet`);

  const jpeg = await page.evaluate(() => {
    const canvas = document.createElement('canvas');
    canvas.width = canvas.height = 16;
    const context = canvas.getContext('2d')!;
    context.fillStyle = '#00c040';
    context.fillRect(0, 0, 16, 16);
    return canvas.toDataURL('image/jpeg', 1).split(',')[1]!;
  });
  await page
    .getByTestId('texture-input')
    .setInputFiles({ name: 'green.jpg', mimeType: 'image/jpeg', buffer: Buffer.from(jpeg, 'base64') });
  await ready(page);
  const green = shareOfHue(await look(page, area), 140);
  assert.ok(green > 0.1, `${green} of the picture is green`);
  assert.deepEqual(complaints, []);
});
