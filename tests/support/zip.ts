import assert from 'node:assert/strict';
import { crc32 } from 'node:zlib';

/** Reads the files of a ZIP archive by its directory, and asserts that what it says of them is so; uncompressed files only. */
export function unzip(bytes: Buffer): Map<string, Buffer> {
  const end = bytes.length - 22;
  assert.equal(bytes.readUInt32LE(end), 0x06054b50, 'it ends with the end of the directory');
  const count = bytes.readUInt16LE(end + 10);
  assert.equal(bytes.readUInt16LE(end + 8), count);
  let at = bytes.readUInt32LE(end + 16);
  assert.equal(at + bytes.readUInt32LE(end + 12), end, 'the directory is right before it');
  const files = new Map<string, Buffer>();
  let next = 0;
  for (let i = 0; i < count; i++) {
    assert.equal(bytes.readUInt32LE(at), 0x02014b50);
    const [method, crc, packed, size] = [10, 16, 20, 24].map((field) =>
      field === 10 ? bytes.readUInt16LE(at + field) : bytes.readUInt32LE(at + field),
    );
    const [nameLength, extra, comment] = [28, 30, 32].map((field) => bytes.readUInt16LE(at + field)) as number[];
    const name = bytes.subarray(at + 46, at + 46 + nameLength!).toString();
    const local = bytes.readUInt32LE(at + 42);
    assert.equal(local, next, `${name} begins where the file before it ends`);
    assert.equal(bytes.readUInt32LE(local), 0x04034b50);
    // Version, flags, method, time, date, checksum and sizes are those of the directory.
    assert.deepEqual(bytes.subarray(local + 4, local + 28), bytes.subarray(at + 6, at + 30), name);
    assert.equal(method, 0, `${name} is not compressed`);
    assert.equal(packed, size);
    const begin = local + 30 + nameLength! + bytes.readUInt16LE(local + 28);
    assert.equal(bytes.subarray(local + 30, local + 30 + nameLength!).toString(), name);
    const content = bytes.subarray(begin, begin + size!);
    assert.equal(crc32(content), crc, `the checksum of ${name}`);
    assert.ok(!files.has(name), `${name} is there once`);
    files.set(name, content);
    next = begin + size!;
    at += 46 + nameLength! + extra! + comment!;
  }
  assert.equal(at, end);
  return files;
}
