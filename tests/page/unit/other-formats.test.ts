import assert from 'node:assert/strict';
import { test } from 'node:test';
import { adviceOn } from '../../../web/src/loading/other-formats';

const kHeads: [kind: RegExp, head: string, advice: RegExp][] = [
  [/FBX/, 'Kaydara FBX Binary  \0\x1a\0', /Blender.*FBX.*glTF 2\.0/],
  [/FBX/, '; FBX 7.4.0 project file\n', /Blender/],
  [/Blender/, 'BLENDER-v279', /glTF 2\.0/],
  [/Blender/, '\x28\xb5\x2f\xfd\x00', /glTF 2\.0/],
  [/USDZ/, 'PK\x03\x04\x0a\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x0a\0\x1c\0model.usdc', /Blender/],
  [/ZIP/, 'PK\x03\x04\x14\0\x08\0\x08\0figure.glb', /unpack/],
  [/OBJ/, '# made by hand\r\nmtllib thing.mtl\no thing\nv 0.5 -1 2\n', /Blender.*Wavefront/],
  [/PLY/, 'ply\nformat ascii 1.0\n', /Blender/],
  [/STL/, 'solid thing\n facet normal 0 0 1\n', /Blender/],
  [/Collada/, '<?xml version="1.0"?>\n<COLLADA xmlns="x">', /Blender/],
  [/image/, '\x89PNG\r\n', /paint/],
];

test('a file of another kind is known by its first bytes, with what to do', () => {
  for (const [kind, head, advice] of kHeads) {
    const told = adviceOn(Uint8Array.from(head, (letter) => letter.charCodeAt(0)));
    assert.match(told ?? '', kind, head);
    assert.match(told ?? '', advice, head);
  }
});

test('nothing is said of glTF and of files that are unknown', () => {
  for (const head of ['glTF\x02\0\0\0', '{"asset":{"version":"2.0"}}', 'hello', '', 'verses about a solid'])
    assert.equal(adviceOn(Uint8Array.from(head, (letter) => letter.charCodeAt(0))), undefined, head);
});
