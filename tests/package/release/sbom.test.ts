// The list of parts that goes with a release: what is in the packed package, and nothing else.
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { test } from 'node:test';
import type { Part } from '../../../wasm/tools/notices.mjs';
import { noticesOf } from '../../../wasm/tools/notices.mjs';
import { sbomOf } from '../../../wasm/tools/sbom.mjs';

const json = (path: string) => JSON.parse(readFileSync(path, 'utf8'));
const manifest = json('package.json');
const parts = json('build/wasm/parts.json') as Part[];
const packed = Buffer.from('a package');
const list = sbomOf(manifest, parts, packed);
const named = list.components.map(({ name, version }) => `${name} ${version}`);

test('it lists what the notices in the package name', () => {
  const notices = readFileSync('dist/THIRD-PARTY-NOTICES.txt', 'utf8');
  const heads = notices.split(/^-{80}\n\n/m).slice(1);
  assert.deepEqual(
    named,
    heads.map((text) => /^(\S+ \S+) \(/.exec(text)?.[1]),
  );
  assert.equal(noticesOf(parts), notices);
});

test('it lists what is bundled or compiled in, and not what develops', () => {
  // Whoever makes the package contain another one adds it here.
  const npm = ['@gltf-transform/core', '@gltf-transform/extensions', 'commander', 'draco3dgltf', 'ktx-parse'];
  const more = ['meshoptimizer', 'pngjs', 'property-graph', 'three', 'fflate'];
  const compiled = ['nanoflann', 'meshoptimizer', 'eigen', 'emscripten'];
  const names = list.components.map(({ name }) => name);
  assert.deepEqual(names, [...npm, ...more, ...compiled]);
  for (const part of ['nanoflann 1.4.3', 'meshoptimizer 0.22', 'eigen 3.4.0'])
    assert.ok(named.includes(part), named.join(', '));
  // Scripts that have a source map say themselves what they are made of.
  const maps = readdirSync('dist').filter((name) => name.endsWith('.map'));
  const sources = maps.flatMap((name) => (json(join('dist', name)) as { sources: string[] }).sources);
  for (const path of sources.filter((one) => one.includes('node_modules/')))
    assert.ok(names.includes(/.*node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(path)?.[1] ?? ''), path);
});

test('its npm packages are those of the lock file', () => {
  const { packages } = json('package-lock.json') as { packages: Record<string, { version: string }> };
  for (const { name, version, purl, where } of parts)
    if (purl.startsWith('pkg:npm/') && where === undefined) {
      assert.equal(version, packages[`node_modules/${name}`]?.version, name);
      assert.equal(decodeURIComponent(purl), `pkg:npm/${name}@${version}`);
    }
});

test('it belongs to one file, and every part to it', () => {
  const own = list.metadata.component;
  assert.equal(own.purl, `pkg:npm/cagecast@${manifest.version}`);
  const sha256 = createHash('sha256').update(packed).digest('hex');
  assert.equal(own.hashes[0]?.content, sha256);
  const [tree] = list.dependencies;
  assert.deepEqual(tree, { ref: own['bom-ref'], dependsOn: list.components.map((part) => part['bom-ref']) });
  assert.equal(new Set(tree?.dependsOn).size, list.components.length);
  assert.equal(JSON.stringify(sbomOf(manifest, parts, packed)), JSON.stringify(list));
});
