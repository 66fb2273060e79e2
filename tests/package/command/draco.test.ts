// Streams of Draco that strangers may send: each ends with one clear line, within the memory and time of a small file.
import assert from 'node:assert/strict';
import { readFileSync, writeFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { type GLTF, NodeIO } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import { checkGltf } from 'cagecast/gltf';
import draco from 'draco3dgltf';
import { fails, ok, run } from '../../support/command.js';
import { glbOf, packGlb, tetrahedron, unpackGlb } from '../../support/gltf.js';
import { temporaryFolder } from '../../support/temporary.js';
import { ball } from '../scenes.js';

const { folder } = temporaryFolder('draco');
const line = 'transfer target.glb --cage cage.glb -o out.glb';
/** Bytes of this process, at most: the decoder keeps what it has had. */
const kMaxBytes = 500e6;

before(() => {
  process.chdir(folder);
  writeFileSync('cage.glb', glbOf(tetrahedron(1)));
});

/** A file of one mesh that Draco has compressed, and the stream. */
async function compressed(mesh: Parameters<typeof glbOf>[0], method: 0 | 1) {
  const io = new NodeIO().registerExtensions([KHRDracoMeshCompression]).registerDependencies({
    'draco3d.encoder': await draco.createEncoderModule(),
    'draco3d.decoder': await draco.createDecoderModule(),
  });
  const document = await io.readBinary(glbOf(mesh, 'ball'));
  document.createExtension(KHRDracoMeshCompression).setRequired(true).setEncoderOptions({ method });
  const { json, bin } = unpackGlb(await io.writeBinary(document));
  return { json, stream: Uint8Array.from(bin).slice(0, json.bufferViews![0]!.byteLength) };
}

function write(json: GLTF.IGLTF, stream: Uint8Array<ArrayBuffer>): void {
  const buffers = [{ byteLength: stream.length }];
  const bufferViews = [{ buffer: 0, byteLength: stream.length }];
  writeFileSync('target.glb', packGlb({ json: { ...json, buffers, bufferViews }, bin: stream }));
}

/** A number as streams have it: 7 bits per byte. */
function varint(value: number): number[] {
  const bytes = [];
  for (; value >= 128; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
  return [...bytes, value];
}

/** A stream with another number at a place. */
function changed(stream: Uint8Array, at: number, value: number): Uint8Array<ArrayBuffer> {
  let end = at;
  while (stream[end]! >= 128) ++end;
  return new Uint8Array([...stream.subarray(0, at), ...varint(value), ...stream.subarray(end + 1)]);
}

describe('a stream of Draco', () => {
  for (const [name, method] of [
    ['that walks from face to face', 1],
    ['of faces one after the other', 0],
  ] as const) {
    test(`${name}: whatever number is wrong in its header, or where it is cut off`, async () => {
      const { json, stream } = await compressed(
        ball([0, 0, 0], () => 0.9, 8, 8),
        method,
      );
      write(json, stream);
      await ok(line);
      const wrong = [0, 5, 11, 12, stream.length >> 1, stream.length - 1].map((end) => stream.subarray(0, end));
      for (let at = 5; at < 24; ++at)
        for (const value of [2 ** 24, 2 ** 31, 2 ** 32 - 1]) wrong.push(changed(stream, at, value));
      for (const bytes of wrong) {
        write(json, bytes);
        const { status, stderr } = await run(line);
        assert.equal(status, 1, stderr);
        assert.match(stderr, /^cagecast: target\.glb: [^\n]*(cannot be decoded|the limit)[^\n]*\n$/);
      }
      assert.ok(1024 * process.resourceUsage().maxRSS < kMaxBytes);
    });
  }

  test('of a hundred bytes that stands for millions of points, once for each attribute', async () => {
    const flat = { ...tetrahedron(0.9), positions: new Float32Array(12).fill(1), uvs: new Float32Array(8) };
    const { json, stream } = await compressed(flat, 0);
    // The decoder makes one point of the four.
    write(json, stream);
    assert.equal(json.accessors![1]!.count, 1);
    await ok(line);
    const [primitive] = json.meshes![0]!.primitives;
    const { attributes, extensions } = primitive!;
    const inStream = (extensions!['KHR_draco_mesh_compression'] as { attributes: Record<string, number> }).attributes;
    for (let i = 0; i < 50; ++i) {
      attributes[`_A${i}`] = attributes['POSITION']!;
      inStream[`_A${i}`] = 0;
    }
    write(json, changed(stream, 12, 2e6));
    await fails(
      1,
      /target\.glb: decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion" is 100\n$/,
      line,
    );
    assert.throws(() => checkGltf(readFileSync('target.glb')), /the limit "expansion" is 100/);
    // The same behind what the stream says of itself.
    const said = [0, 1, 4, ...Buffer.from('name'), 2, 1, 2, 0];
    const flagged = Uint8Array.from(stream, (byte, i) => (i === 10 ? 0x80 : byte));
    const behind = changed(flagged, 12, 2e6);
    write(json, new Uint8Array([...behind.subarray(0, 11), ...said, ...behind.subarray(11)]));
    await fails(1, /decodes to [\d,]+ bytes, [\d,]+ times its size; the limit "expansion"/, line);
    assert.ok(1024 * process.resourceUsage().maxRSS < kMaxBytes);
  });

  test('that has other numbers of points than its accessors', async () => {
    const { json, stream } = await compressed(
      ball([0, 0, 0], () => 0.9, 8, 8),
      0,
    );
    const counted = (accessor: number, by: number) =>
      write(
        {
          ...json,
          accessors: json.accessors!.map((one, a) => (a === accessor ? { ...one, count: one.count + by } : one)),
        },
        stream,
      );
    for (const [accessor, by] of [
      [1, -1],
      [1, 1],
      [2, 1],
    ] as const) {
      counted(accessor, by);
      await fails(
        1,
        /^cagecast: target\.glb: meshes\[0\]\.primitives\[0\]\.[^\n]*(, not the \d+ of its accessor|has \d+ elements for \d+ vertices)\n$/,
        line,
      );
    }
    // Draco leaves out triangles without an area, and not all that write such files count again.
    counted(0, 3);
    await ok(line);
  });
});
