import assert from 'node:assert/strict';
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { request } from 'node:http';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { freePort } from '../../../examples/catalogue/redis.ts';
import * as recipe from './recipe.ts';
import { ask, filesOf, folder, outputs, results, run, start, submit, until } from './recipe.ts';

before(() => recipe.open(2));
after(() => recipe.close());

type Answer = { status: number; text: string; headers: Record<string, unknown> };

/** Asks as a browser or any program can: with any headers, also a Host. */
function fetchAs(
  address: string,
  {
    method = 'GET',
    headers = {},
    body = '',
  }: { method?: string; headers?: Record<string, string>; body?: string } = {},
): Promise<Answer> {
  return new Promise((resolve, reject) => {
    const asked = request(address, { method, headers, agent: false }, async (response) => {
      let text = '';
      for await (const chunk of response) text += chunk;
      resolve({ status: response.statusCode!, text, headers: response.headers });
    });
    asked.on('error', reject).end(body);
  });
}

/** Runs the status page. */
async function withStatus(env: Record<string, string>, use: (address: string) => Promise<void>): Promise<void> {
  const port = String(await freePort());
  const { child, text } = start('status.ts', [], { ...env, CATALOGUE_PORT: port });
  try {
    await until(() => text().includes('/queue'));
    await use(`http://127.0.0.1:${port}`);
  } finally {
    child.kill('SIGKILL');
  }
}

const jobsInRedis = async () => {
  const counts = await recipe.catalogue.queue.getJobCounts();
  return Object.values(counts).reduce((sum, n) => sum + n, 0);
};

describe('the status page', () => {
  test('only shows, and only to its own pages', async () => {
    await withStatus({ CATALOGUE_NAMES: 'catalogue.example' }, async (address) => {
      const { host } = new URL(address);
      const status = async (path: string, options?: Parameters<typeof fetchAs>[1]) =>
        (await fetchAs(`${address}${path}`, options)).status;
      const asHost = (name: string) => ({ headers: { host: name } });
      for (const name of [host, 'localhost', `localhost:${new URL(address).port}`, '10.1.2.3:80', '[::1]:1'])
        assert.equal(await status('/metrics', asHost(name)), 200, name);
      assert.equal(await status('/metrics', asHost('catalogue.example')), 200);
      for (const name of ['evil.example', 'localhost.evil.example', '127.0.0.1.evil.example', 'x@127.0.0.1'])
        for (const path of ['/metrics', '/queue', '/queue.json', '/files/results.jsonl'])
          assert.ok([400, 421].includes(await status(path, asHost(name))), `${name} ${path}`);

      assert.equal(await status('/queue.json'), 200);
      assert.equal(await status('/queue.json', { headers: { origin: address } }), 200);
      for (const headers of [
        { origin: 'http://evil.example' },
        { origin: 'null' },
        { origin: `http://evil.example:${host.split(':')[1]}` },
        { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'no-cors' },
        { 'sec-fetch-site': 'same-site', 'sec-fetch-mode': 'cors' },
      ])
        for (const path of ['/queue.json', '/metrics', '/files/results.jsonl'])
          assert.equal(await status(path, { headers }), 403, JSON.stringify(headers));
      assert.equal(
        await status('/metrics', { headers: { 'sec-fetch-site': 'cross-site', 'sec-fetch-mode': 'navigate' } }),
        200,
      );

      const before = await jobsInRedis();
      for (const method of ['POST', 'PUT', 'PATCH', 'DELETE', 'OPTIONS'])
        for (const path of ['/queue', '/queue.json', '/metrics', '/files/results.jsonl']) {
          assert.equal(await status(path, { method, body: '{}' }), 405, `${method} ${path}`);
          const headers = { origin: 'http://evil.example', 'content-type': 'text/plain' };
          assert.equal(await status(path, { method, headers, body: '{}' }), 403, `${method} ${path}`);
        }
      assert.equal(await jobsInRedis(), before);
    });
  });

  test('says in plain words that Redis is away, and keeps on', async () => {
    await withStatus({}, async (address) => {
      await recipe.redis.stop('SIGKILL');
      const away = async () => (await fetchAs(`${address}/metrics`)).status === 503;
      await until(away);
      for (const path of ['/metrics', '/queue', '/queue.json']) {
        const { status, text } = await fetchAs(`${address}${path}`);
        assert.deepEqual([status, text], [503, 'Redis does not answer: start it, or set REDIS_URL to where it is\n']);
      }
      await recipe.restartRedis(0);
      await until(async () => !(await away()));
    });
  });
});

describe('what others put into Redis or the folders', () => {
  const good = { kind: 'slow', inputs: { target: { place: '1.glb', sha256: '0'.repeat(64) } }, settings: {} };
  const id = (kind: string, digit: string) => `${kind}-${digit.repeat(32)}`;

  test('fails as broken if it is no job, and harms no program', async () => {
    const { queue } = recipe.catalogue;
    const put = (data: unknown, jobId?: string) => queue.add('x', data as never, jobId === undefined ? {} : { jobId });
    await put({});
    await put(null, id('slow', '0'));
    await put([], id('slow', '1'));
    await put('text', id('slow', '2'));
    await put({ ...good, output: '../escaped.glb' }, id('slow', '3'));
    await put({ ...good, output: 'file:///etc/passwd' }, id('slow', '4'));
    await put(good, '../../escaped');
    await put(good, 'slow-../../../../escaped0000000000000');
    await put(good, `slow-${'0'.repeat(31)}/`);
    await put({ ...good, kind: '__proto__' }, `__proto__-${'0'.repeat(32)}`);
    await put({ ...good, kind: '../x' }, `../x-${'0'.repeat(32)}`);
    await put({ ...good, kind: 7 }, id('slow', '5'));
    await put({ ...good, inputs: { target: '1.glb' } }, id('slow', '6'));
    await put({ ...good, inputs: undefined }, id('slow', '7'));
    await put({ ...good, settings: 'x' }, id('slow', '8'));
    await put(good, id('inspect', '9'));
    await put({ ...good, kind: 'constructor' }, id('constructor', 'a'));
    await results(); // waits
    // Not even JSON; and one that says it is done, but has no result.
    await ask('HSET', 'test:jobs:torn', 'data', '{', 'name', 'x', 'failedReason', 'broken: x');
    await ask('ZADD', 'test:jobs:failed', '1', 'torn');
    await ask('HSET', `test:jobs:${id('slow', 'b')}`, 'data', JSON.stringify(good), 'name', 'x', 'returnvalue', '{}');
    await ask('ZADD', 'test:jobs:completed', '1', id('slow', 'b'));
    await ask('ZADD', 'test:jobs:completed', '2', 'nothing');

    const lines = await results();
    const reasons = lines.map(({ key, reason }) => `${key} ${reason}`);
    assert.equal(lines.filter(({ reason }) => reason === 'broken').length, 17, reasons.join('\n'));
    assert.equal(lines.filter(({ reason }) => reason === 'missing').length, 2); // two kinds that nobody knows
    assert.equal(lines.filter(({ status }) => status === 'done').length, 0);
    assert.deepEqual(readdirSync(folder).sort(), ['inputs', 'outputs', 'redis', 'secret.glb']);
    const [code, ...dead] = await run('dead.ts');
    assert.deepEqual([code, dead.length], [0, 18]);
    await ask('ZREM', 'test:jobs:failed', 'torn');
    await run('dead.ts', '--retry');
    await recipe.parts.untilDone(recipe.catalogue);
    assert.equal((await run('dead.ts')).length, 1 + 17);
    await withStatus({}, async (address) => {
      for (const path of ['queue', 'queue.json', 'metrics', 'files/report.html'])
        assert.equal((await fetchAs(`${address}/${path}`)).status, 200, path);
    });
  });

  test('is replaced by the real job where it has its id', async () => {
    const job = { kind: 'slow', target: '5.glb', settings: { ms: 1 } };
    await submit(job);
    const key = (await results()).find(({ status }) => status === 'done')!.key;
    await recipe.catalogue.queue.remove(key);
    rmSync(join(outputs, 'results.jsonl'));
    await recipe.catalogue.queue.add('x', { ...good, settings: { ms: 9 } }, { jobId: key });
    await recipe.parts.untilDone(recipe.catalogue);
    assert.deepEqual(await submit(job), ['0 new jobs, 0 known, 1 tried again']);
    assert.equal((await results()).find((line) => line.key === key)!.status, 'done');
  });

  test('leads nowhere if it is a link', async () => {
    const outside = join(folder, 'outside');
    mkdirSync(outside);
    writeFileSync(join(outside, 'key.txt'), 'not yours');
    const planted = join(outputs, 'slow');
    rmSync(planted, { recursive: true });
    symlinkSync(outside, planted);
    symlinkSync(join(outside, 'key.txt'), join(outputs, 'key.txt'));
    const job = (ms: number) => ({ kind: 'slow', target: '6.glb', settings: { ms } });
    await submit(job(2));
    const failed = (await results()).find(({ inputs }) => inputs['target'] === '6.glb')!;
    assert.match(failed.error!, /^refused: slow\/.*: "slow" in the output folder is a link or a file; remove it$/);
    await withStatus({}, async (address) => {
      for (const path of [
        'key.txt',
        'slow/key.txt',
        '..%2fsecret.glb',
        '%2e%2e/secret.glb',
        'slow%2fkey.txt',
        '.unfinished/x',
        '%00',
      ])
        assert.ok([400, 404].includes((await fetchAs(`${address}/files/${path}`)).status), path);
      const { status, headers } = await fetchAs(`${address}/files/results.jsonl`);
      assert.equal(status, 200);
      assert.match(String(headers['content-security-policy']), /^sandbox;/);
    });
    rmSync(planted);

    // The folder of unfinished files, and the file itself.
    const unfinished = join(outputs, '.unfinished');
    rmSync(unfinished, { recursive: true });
    symlinkSync(outside, unfinished);
    await submit(job(3));
    await recipe.parts.untilDone(recipe.catalogue);
    assert.deepEqual(readdirSync(outside), ['key.txt']);
    rmSync(unfinished);
    rmSync(join(outputs, 'results.jsonl'));
    symlinkSync(join(outside, 'key.txt'), join(outputs, 'results.jsonl'));
    const [code, text] = await run('report.ts');
    assert.equal(code, 2);
    assert.match(text!, /results\.jsonl in the output folder is a link/);
    rmSync(join(outputs, 'results.jsonl'));
    await submit(job(4));
    const { output } = (await results()).find(
      ({ status, inputs }) => status === 'done' && inputs['target'] === '6.glb',
    )!;
    rmSync(join(outputs, output!));
    symlinkSync(join(outside, 'key.txt'), join(outputs, output!));
    await submit(job(4));
    assert.equal((await results()).find((line) => line.output === output)!.status, 'done');
    assert.equal(readFileSync(join(outside, 'key.txt'), 'utf8'), 'not yours');
    assert.match(readFileSync(join(outputs, output!), 'utf8'), /^x+$/);
    assert.ok(existsSync(unfinished) && filesOf(unfinished).length === 0);
  });
});
