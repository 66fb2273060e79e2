import assert from 'node:assert/strict';
import { readdirSync } from 'node:fs';
import { test } from 'node:test';
import { openSite, ready, settled, shownCounts, shownError } from '../../support/site';

const site = await openSite();

test('after one visit the page works offline, with every sample and decoder', async () => {
  const { page, complaints, foreign } = await site.visit({ serviceWorkers: 'allow' });
  const online = await shownCounts(page);
  await page.evaluate(() => navigator.serviceWorker.ready);
  await page.context().setOffline(true);
  await page.goto(`${site.url}?from=a-friend#later`);
  await ready(page);
  assert.deepEqual(await shownCounts(page), online);

  const names = await page
    .getByTestId('sample-select')
    .locator('option')
    .evaluateAll((options) => options.map((option) => (option as HTMLOptionElement).value));
  assert.ok(names.length >= 3);
  for (const name of names) {
    await page.getByTestId('sample-select').selectOption(name);
    assert.equal(await settled(page), 'ready', `${name}: ${await shownError(page)}`);
  }
  // What the page asks for only when a file needs it: nothing of it is left on the network.
  const files = readdirSync(site.folder, { recursive: true, withFileTypes: true }).filter(
    (entry) => entry.isFile() && entry.name !== 'service-worker.js',
  );
  const kept = await page.evaluate(async () => {
    const [name] = await caches.keys();
    return (await (await caches.open(name!)).keys()).map(({ url }) => new URL(url).pathname.split('/').at(-1)!);
  });
  assert.deepEqual(files.map(({ name }) => name).toSorted(), kept.toSorted());
  assert.deepEqual(complaints, []);
  assert.deepEqual(foreign, []);
});

test('requests outside the page are not cached', async () => {
  const { page } = await site.visit({ serviceWorkers: 'allow' });
  await page.evaluate(() => navigator.serviceWorker.ready);
  const ask = (): Promise<string> =>
    page.evaluate(() =>
      fetch('something-else.txt').then(
        () => 'answered',
        () => 'failed',
      ),
    );
  assert.equal(await ask(), 'answered');
  await page.context().setOffline(true);
  assert.equal(await ask(), 'failed');
});

test('it works offline if the server redirects index.html to the folder, beside another copy of the page', async () => {
  const { preview } = await import('vite');
  const server = await preview({
    configFile: false,
    logLevel: 'error',
    build: { outDir: site.folder },
    preview: { host: '127.0.0.1', port: 0 },
    plugins: [
      {
        name: 'folders',
        configurePreviewServer: ({ middlewares }) => {
          middlewares.use((request, response, next) => {
            const [, copy, rest] = /^(\/(?:one|other)\/)(.*)$/.exec(request.url ?? '') ?? [];
            if (rest === 'index.html') return void response.writeHead(308, { location: copy! }).end();
            if (copy) request.url = `/${rest}`;
            next();
          });
        },
      },
    ],
  });
  const context = await site.browser.newContext({
    viewport: { width: 700, height: 500 },
    reducedMotion: 'reduce',
    serviceWorkers: 'allow',
  });
  try {
    const page = await context.newPage();
    const copies = ['one/', 'other/'].map((name) => server.resolvedUrls!.local[0] + name);
    for (const copy of copies) {
      await page.goto(copy);
      await ready(page);
      await page.evaluate(() => navigator.serviceWorker.ready);
    }
    await context.setOffline(true);
    for (const copy of copies) {
      await page.goto(copy);
      await ready(page);
    }
  } finally {
    await context.close();
    await server.close();
  }
});
