import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, test } from 'node:test';
import { promisify } from 'node:util';

const folder = mkdtempSync(join(tmpdir(), 'cagecast-manifest-'));
after(() => rmSync(folder, { recursive: true, force: true }));
const { readManifest } = await import('../../../examples/catalogue/manifest.ts');

const sha256 = '0'.repeat(64);
const inputs = (count: number) => Array.from({ length: count }, (_, i) => ({ place: `${i}.glb`, sha256 }));

/** The first entries of a manifest, as places of inputs or errors. */
async function entries(lines: (object | string)[], most = 10): Promise<string[]> {
  const path = join(folder, 'manifest.jsonl');
  writeFileSync(path, lines.map((line) => `${typeof line === 'string' ? line : JSON.stringify(line)}\n`).join(''));
  const found: string[] = [];
  for await (const entry of readManifest(path)) {
    if ('error' in entry) found.push(`line ${entry.line}: ${entry.error}`);
    else
      found.push(
        Object.values(entry.data.inputs)
          .map(({ place }) => place)
          .join(' '),
      );
    if (found.length === most) break;
  }
  return found;
}

describe('a manifest', () => {
  test('stands for all pairs of its lists, which are made one by one', async () => {
    const line = { kind: 'inspect', target: inputs(2), cage: inputs(2) };
    assert.deepEqual(await entries([line]), ['0.glb 0.glb', '0.glb 1.glb', '1.glb 0.glb', '1.glb 1.glb']);
    // A million in a process that has not the memory for them.
    writeFileSync(join(folder, 'million.jsonl'), JSON.stringify({ ...line, target: inputs(1000), cage: inputs(1000) }));
    const program = `const { readManifest } = await import('./examples/catalogue/manifest.ts');
      let count = 0;
      for await (const { data } of readManifest(process.argv[1])) if (data && ++count === 5000) break;
      console.log(count);`;
    const args = ['--max-old-space-size=80', '--import', 'tsx', '--input-type=module', '--eval', program];
    const { stdout } = await promisify(execFile)(process.execPath, [...args, join(folder, 'million.jsonl')]);
    assert.equal(stdout.trim(), '5000');
  });

  test('is refused where a line stands for more jobs than allowed', async () => {
    const nineMillion = { kind: 'inspect', target: inputs(3000), cage: inputs(3000) };
    assert.deepEqual(await entries([{ kind: 'inspect', target: inputs(1), cage: inputs(1) }, nineMillion]), [
      '0.glb 0.glb',
      'line 2: stands for 9000000 jobs (3000 of "target" × 3000 of "cage"), at most 1000000 are allowed: split it, or raise CATALOGUE_PAIRS',
    ]);
    const many = Object.fromEntries(Array.from({ length: 1000 }, (_, i) => [`x${i}`, [1, 2]]));
    assert.match((await entries([many]))[0]!, /^line 1: stands for .* jobs/);
  });

  test('never shows the signature of an address', async () => {
    const signed = 'https://bucket.example/1.glb?X-Amz-Signature=s3cr3t';
    const good = { kind: 'inspect', target: 'a.glb', cage: 'b.glb' };
    const found = await entries(
      [
        `{"kind": "inspect", "target": "${signed}`,
        `${signed}"}`,
        `{"kind": "inspect", "target": "${signed}" "cage": 1}`,
        JSON.stringify(signed),
        { ...good, kind: signed },
        { ...good, [signed]: 1 },
        { ...good, target: signed },
        { ...good, target: 'https://key:s3cr3t@bucket.example/1.glb' },
        { ...good, target: { place: signed, sha256: 's3cr3t' } },
        { ...good, output: `ftp://bucket.example/?X-Amz-Signature=s3cr3t` },
        { kind: 'inspect', [`${signed}#`]: [] },
        { kind: 'inspect', [`${signed}#`]: [[]] },
      ],
      20,
    );
    assert.equal(found.length, 12);
    for (const [i, error] of found.entries()) assert.match(error, new RegExp(`^line ${i + 1}: `));
    assert.doesNotMatch(found.join('\n'), /s3cr3t|Signature/);
  });
});
