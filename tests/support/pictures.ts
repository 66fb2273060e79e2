// Takes the README's pictures of the page: npm run pictures [-- name …]

import { mkdir, writeFile } from 'node:fs/promises';
import { type Accessor, NodeIO } from '@gltf-transform/core';
import type { Page } from 'playwright-core';
import { drop, glb, inRepository, kPlay, Site, settled, type Upload } from './site';

const kFolder = inRepository('docs/pictures');
const kModels = ['Lizard head', 'Human bust', 'Saloon car'];

/** The model alone, naive beside filtered. */
async function compare(site: Site): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 1480, height: 720 }, deviceScaleFactor: 1 });
  await hideControls(page);
  await rest(page);
  const box = (await page.locator('#stage').boundingBox())!;
  const clip = { x: box.x + box.width / 2 - 270, y: box.y + box.height * 0.16, width: 540, height: box.height * 0.62 };
  await page.screenshot({ path: `${kFolder}/compare.jpg`, type: 'jpeg', quality: 88, clip });
}

/**
 * What the page shows until it has drawn the first picture itself, on a desk and on a phone: that one, in a square as large as the
 * stylesheet shows it.
 */
async function first(site: Site): Promise<void> {
  for (const [name, viewport, deviceScaleFactor] of [
    ['first', { width: 1440, height: 900 }, 2],
    ['first-phone', { width: 390, height: 844 }, 3],
  ] as const) {
    const { page } = await site.visit({ viewport, deviceScaleFactor }, kPlay);
    await page.addStyleTag({
      content:
        '* { background: none !important; box-shadow: none !important } .panel, header, #stage > :not(canvas), .dock > * { opacity: 0 }',
    });
    await rest(page);
    const clip = (await page.locator('#view').boundingBox())!;
    const shot = dataUri(await page.screenshot({ type: 'png', omitBackground: true, clip }));
    const webp = await page.evaluate(
      async ({ shot, width, height, pixels }) => {
        const image = new Image();
        image.src = shot;
        await image.decode();
        const style = getComputedStyle(document.querySelector('#view')!);
        const [top = 0, bottom = 0, fill = 1] = ['top', 'bottom', 'fill'].map((name) =>
          parseFloat(style.getPropertyValue(`--stage-${name}`)),
        );
        const free = height - top - bottom; // what controls leave
        const side = (1.118 / fill) * Math.min(free, width);
        const canvas = document.createElement('canvas');
        canvas.width = canvas.height = pixels;
        const context = canvas.getContext('2d')!;
        context.imageSmoothingQuality = 'high';
        context.scale(pixels / side, pixels / side);
        context.drawImage(image, (side - width) / 2, (side - free) / 2 - top, width, height);
        return canvas.toDataURL('image/webp', 0.82);
      },
      { shot, ...clip, pixels: 1200 },
    );
    await writeFile(`${kFolder}/${name}.webp`, Buffer.from(webp.split(',')[1]!, 'base64'));
  }
}

/** Busts of other shapes. */
async function busts(): Promise<Upload[]> {
  const io = new NodeIO();
  const shapes = { slim: [0.8, 1.05, 0.9], broad: [1.2, 1, 1.1], short: [1, 0.85, 1], tall: [0.95, 1.15, 1] };
  return Promise.all(
    Object.entries(shapes).map(async ([name, scale]) => {
      const document = await io.read(inRepository('examples/samples/human/target.glb'));
      const primitives = document
        .getRoot()
        .listMeshes()
        .flatMap((mesh) => mesh.listPrimitives());
      const positions = new Set(primitives.map((primitive) => primitive.getAttribute('POSITION') as Accessor));
      for (const one of positions) one.setArray((one.getArray() as Float32Array).map((x, i) => x * scale[i % 3]!));
      return glb(`${name}.glb`, Buffer.from(await io.writeBinary(document)));
    }),
  );
}

/** Shows one paint on busts of other shapes. */
async function fillWardrobe(page: Page): Promise<void> {
  await drop(page, await busts());
  const worn = '.avatars :is([data-verdict=good], [data-verdict=usable])';
  await page.locator(worn).nth(3).waitFor();
  await settled(page);
}

/** The whole page on two screens: a figure in Play, and a wardrobe. */
async function desktopAndPhone(site: Site): Promise<void> {
  const shots: string[] = [];
  for (const [width, height, colorScheme] of [
    [1440, 900, 'light'],
    [390, 844, 'dark'],
  ] as const) {
    const isPhone = width < 600;
    const options = { viewport: { width, height }, deviceScaleFactor: 1, colorScheme, hasTouch: isPhone };
    const { page } = await site.visit(options, kPlay, isPhone ? '#sample=avatar&view=result' : '');
    if (!isPhone) await fillWardrobe(page);
    await rest(page);
    shots.push(dataUri(await page.screenshot({ type: 'png' })));
  }
  await compose(
    site,
    'page',
    `<div style="display:flex;gap:24px">${shots.map((shot) => `<img src="${shot}" style="height:640px;border-radius:10px">`).join('')}</div>`,
  );
}

/** What is shown for a link to the page: 1200 × 630 pixels. */
async function share(site: Site): Promise<void> {
  const shots: string[] = [];
  const { page } = await site.visit({ viewport: { width: 900, height: 560 }, deviceScaleFactor: 2 });
  await page.addStyleTag({
    content: '* { background: none !important } .panel, header, #stage > :not(canvas), .dock > * { opacity: 0 }',
  });
  await page.locator('#view-mode input[value=result]').check({ force: true });
  for (const model of kModels) {
    await choose(page, model);
    await rest(page);
    shots.push(dataUri(await page.locator('#stage').screenshot({ type: 'png', omitBackground: true })));
  }
  const picture = (shot: string): string =>
    `<img src="${shot}" style="width:420px;height:400px;margin:0 -12px;object-fit:contain;object-view-box:inset(4% 22% 18% 22%)">`;
  const { page: sheet } = await site.visit({ viewport: { width: 1200, height: 630 }, deviceScaleFactor: 1 });
  await sheet.setContent(
    `<body style="margin:0;font-family:system-ui;color:#14181d;background:radial-gradient(circle at 50% 40%,#fff,#cfd8e0)">
      <div style="padding:44px 56px 0"><b style="font-size:64px;letter-spacing:-.02em">Cagecast</b>
      <div style="font-size:32px;color:#445">One paint for any mesh, kept off eyes and teeth.</div></div>
      <div style="display:flex;justify-content:center">${shots.map(picture).join('')}</div></body>`,
  );
  await sheet.waitForTimeout(500);
  await sheet.screenshot({ path: `${kFolder}/share.jpg`, type: 'jpeg', quality: 85 });
}

/** The steps of the method, as the film strip shows them. */
async function steps(site: Site): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 900, height: 640 }, deviceScaleFactor: 1 }, kPlay);
  await page.locator('#method > summary').click();
  await hideControls(page);
  const shots: string[] = [];
  for (const step of ['Cage', 'Closest point', 'Rays', 'Parts', 'Result']) {
    await page.locator('#steps').getByRole('button', { name: step }).click();
    await rest(page);
    const shot = dataUri(await page.locator('#stage').screenshot({ type: 'png' }));
    shots.push(
      `<div style="text-align:center">${step}<br><img src="${shot}" style="width:264px;height:264px;object-fit:cover;object-view-box:inset(4% 18% 8% 12%)"></div>`,
    );
  }
  await compose(site, 'steps', `<div style="display:flex">${shots.join('')}</div>`);
}

/** The stories of an eye, and of a spot that the model hides. */
async function why(site: Site): Promise<void> {
  const shots: string[] = [];
  const { page } = await site.visit({ viewport: { width: 1200, height: 760 }, deviceScaleFactor: 1 });
  await page.locator('#view-mode input[value=result]').check({ force: true });
  await page.getByRole('radio', { name: 'Explain' }).check({ force: true });
  const stage = (await page.locator('#stage').boundingBox())!;
  for (const [x, y] of [
    [0.6, 0.35],
    [0.42, 0.58],
  ] as const) {
    await page.mouse.click(stage.x + x * stage.width, stage.y + y * stage.height);
    await rest(page);
    shots.push(dataUri(await page.screenshot({ type: 'png' })));
  }
  await compose(
    site,
    'why',
    `<div style="display:flex;gap:16px">${shots.map((shot) => `<img src="${shot}" style="width:720px;border-radius:10px">`).join('')}</div>`,
  );
}

/** A mouth and an eye by the method as published, whose borders follow the triangles; and cut. */
async function borders(site: Site): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 1440, height: 900 }, deviceScaleFactor: 2 });
  await hideControls(page);
  await page.locator('#view-mode input[value=result]').check({ force: true });
  await page.getByTestId('preset').selectOption('paper');
  await settled(page);
  await page.locator('#view').hover();
  for (let step = 0; step < 8; step++) await page.mouse.wheel(0, -240);
  const shots: string[] = [];
  for (const cut of [false, true]) {
    await page.getByTestId('exact-borders').setChecked(cut);
    if (cut) await page.waitForFunction(() => document.querySelector('[data-testid=borders-note]')!.textContent !== '');
    await rest(page);
    shots.push(dataUri(await page.locator('#stage').screenshot({ type: 'png' })));
  }
  const half = (shot: string): string =>
    `<img src="${shot}" style="width:560px;height:500px;object-fit:cover;object-view-box:inset(16% 15% 42% 52%)">`;
  await compose(site, 'borders', `<div style="display:flex;gap:12px">${shots.map(half).join('')}</div>`);
}

async function choose(page: Page, model: string): Promise<void> {
  await page.locator('#sample-select').selectOption({ label: model });
  await page.waitForTimeout(300);
  await settled(page);
}

async function hideControls(page: Page): Promise<void> {
  await page.addStyleTag({
    content: '.panel, .toolbar, .rail, .legend, .stage-head, .angles, .clips, .quick, .dock, header { opacity: 0 }',
  });
}

/** Waits until the picture has been drawn with all its textures. */
const rest = (page: Page): Promise<void> => page.waitForTimeout(2500);

const dataUri = (png: Buffer): string => `data:image/png;base64,${png.toString('base64')}`;

async function compose(site: Site, name: string, html: string): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 1400, height: 700 }, deviceScaleFactor: 1 });
  await page.setContent(
    `<body style="margin:0;font:600 18px system-ui;color:#445"><div id="all" style="display:inline-block;padding:12px;background:#fff">${html}</div></body>`,
  );
  await page.waitForTimeout(500);
  await page.locator('#all').screenshot({ path: `${kFolder}/${name}.jpg`, type: 'jpeg', quality: 85 });
}

const wanted = process.argv.slice(2);
const site = await Site.open('real');
try {
  await mkdir(kFolder, { recursive: true });
  for (const take of [first, compare, share, desktopAndPhone, steps, why, borders])
    if (wanted.length === 0 || wanted.includes(take.name)) await take(site);
} finally {
  await site.close();
}
