import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { freePort } from '../../../examples/catalogue/redis.ts';
import * as recipe from './recipe.ts';
import { ask, folder, manifestOf, results, run, start, submit } from './recipe.ts';

before(() => recipe.open(2));
after(() => recipe.close());

describe('what the programs say', () => {
  test('has no signature of an address, whatever fails', async () => {
    const secret = '?X-Amz-Signature=s3cr3t&X-Amz-Date=1#s3cr3t';
    const at = (path: string) => `${recipe.origin}${path}${secret}`;
    const place = (path: string, digit: string) => ({ place: at(path), sha256: digit.repeat(64) });
    const said = await submit(
      { kind: 'slow', target: place('/forbidden.glb', '1') },
      { kind: 'slow', target: place('/nowhere.glb', '2') },
      { kind: 'slow', target: place('/cut.glb', '3') },
      { kind: 'slow', target: place('/to-other.glb', '4') },
      { kind: 'slow', target: { place: `https://key:s3cr3t@127.0.0.1/${secret}`, sha256: '5'.repeat(64) } },
      { kind: 'slow', target: { place: `http://[no${secret}`, sha256: '6'.repeat(64) } },
      { kind: 'slow', target: place('/endless.glb', '7') },
      { kind: 'slow', target: '1.glb', output: at('/out.txt') },
      {
        kind: 'tell',
        target: '1.glb',
        settings: { text: `cannot load ${at('/a')} or ?a=s3cr3t`, [at('/b')]: at('/c') },
      },
      { kind: 'tell', target: '2.glb', settings: { text: at('/x'), isFact: true } },
      { kind: 'inspect', target: '1.glb', cage: 'cage.glb', settings: { threshold: at('/t') } },
      { kind: 'slow', target: at('/not-allowed.glb') },
      `{"kind": "slow", "target": "${at('/y')}"`,
    );
    const lines = await results();
    assert.equal(lines.length, 11);
    assert.equal(said.length, 3);
    const { address, close } = await recipe.parts.serveStatus(recipe.catalogue);
    const texts = [said.join('\n'), JSON.stringify(lines), recipe.said, ...(await run('dead.ts'))];
    for (const path of ['metrics', 'files/report.html', 'queue', 'queue.json'])
      texts.push(await (await fetch(`${address}/${path}`)).text());
    const keys = lines.map(({ key }) => key);
    await close();
    for (const text of texts) assert.doesNotMatch(String(text), /s3cr3t|Signature/);
    // Nor does Redis keep them with errors, where other tools read.
    for (const key of keys)
      for (const field of ['failedReason', 'stacktrace', 'returnvalue', 'progress'])
        assert.doesNotMatch(await ask('HGET', `test:jobs:${key}`, field), /s3cr3t|Signature|worker\.ts|^ +at /m);
  });

  test('is a plain sentence where a variable, a word or a file is wrong', async () => {
    const port = String(await freePort());
    const taken = new URL(recipe.redis.url).port;
    const manifest = manifestOf({ kind: 'slow', target: '1.glb', settings: { ms: 5 } });
    await ask('CONFIG', 'SET', 'requirepass', 'right');
    const wrongPassword = start('submit.ts', [manifest], { REDIS_URL: `redis://:s3cr3t@127.0.0.1:${taken}` });
    assert.equal(await wrongPassword.ended, 2);
    assert.match(wrongPassword.text(), /refused: Redis refuses the user or the password of REDIS_URL/);
    assert.doesNotMatch(wrongPassword.text(), /s3cr3t|WRONGPASS|^ +at /m);
    await ask('-a', 'right', 'CONFIG', 'SET', 'requirepass', '');

    const cases: [program: string, args: string[], env: Record<string, string>, says: RegExp][] = [
      ['submit.ts', [manifest], { REDIS_URL: 'user:s3cr3t@nowhere' }, /^broken: REDIS_URL is not an address such as/],
      ['submit.ts', [manifest], { CATALOGUE_PAIRS: '0' }, /^broken: CATALOGUE_PAIRS is "0", not a number ≥ 1$/],
      ['worker.ts', [], { CATALOGUE_RATE: 'many' }, /^broken: CATALOGUE_RATE is "many", not a number ≥ 0$/],
      ['worker.ts', [], { CATALOGUE_CONCURRENCY: '0' }, /^broken: CATALOGUE_CONCURRENCY is "0", not a number ≥ 1$/],
      ['worker.ts', [], { CATALOGUE_KINDS: '/no/kinds.ts' }, /^broken: CATALOGUE_KINDS: .*\/no\/kinds\.ts/],
      [
        'status.ts',
        [],
        { CATALOGUE_PORT: '99999' },
        /^broken: CATALOGUE_PORT is "99999", not a number from 0 to 65535$/,
      ],
      ['status.ts', [], { CATALOGUE_PORT: taken }, /^refused: 127\.0\.0\.1:\d+: another program listens there; set/],
      ['submit.ts', [], {}, /^broken: usage: npm run submit -- MANIFEST\.jsonl \[--wait\]$/],
      ['submit.ts', [manifest, '--watch'], {}, /^broken: Unknown option '--watch'/],
      ['submit.ts', [folder], {}, /^missing: .* is a folder$/],
      ['report.ts', ['--worst', 'x'], {}, /^broken: --worst is "x", not a number ≥ 0$/],
      ['dead.ts', ['--reson', 'x'], {}, /^broken: Unknown option '--reson'/],
      [
        'start.ts',
        ['--once'],
        { REDIS_URL: '', PATH: '/nowhere', CATALOGUE_PORT: port },
        /^missing: redis-server does not start/,
      ],
    ];
    for (const [program, args, env, says] of cases) {
      const { text, ended } = start(program, args, env);
      const code = await ended;
      assert.match(text().trim(), says, program);
      assert.equal(code, 2, text());
      assert.doesNotMatch(text(), /s3cr3t|^ +at |E[A-Z]{5,}/m);
    }
  });

  test('installs what the lock file says', () => {
    const text = (path: string) => readFileSync(resolve('examples/catalogue', path), 'utf8');
    assert.match(text('deploy/Dockerfile'), /npm ci /);
    assert.doesNotMatch(text('deploy/Dockerfile') + text('setup.mjs') + text('start.ts'), /npm install|'install'/);
  });
});
