import assert from 'node:assert/strict';
import { test } from 'node:test';

test('a paint that has come is shown from there, and not fetched again', async () => {
  Object.assign(globalThis, { document: { baseURI: 'https://page.test/' } });
  const asked: string[] = [];
  globalThis.fetch = async (address) => {
    asked.push(String(address));
    return new Response('a picture', { headers: { 'content-type': 'image/png' } });
  };
  const { fetchAhead, fetchFile, pictureOf } = await import('../../../web/src/loading/samples');
  const address = 'https://page.test/samples/lizard/paint.png';
  const model = 'https://page.test/samples/lizard/target.glb';
  assert.equal(pictureOf(address), address, 'before it has come');
  fetchAhead({ target: model, cage: model, paints: [{ title: 'Paint', file: address }] } as never);
  await fetchFile(address);
  assert.match(pictureOf(address), /^blob:/);
  assert.equal(await (await fetch('https://page.test/')).text(), 'a picture');
  assert.deepEqual(
    asked.filter((one) => one === address),
    [address],
  );
});
