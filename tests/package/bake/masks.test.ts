import assert from 'node:assert/strict';
import { before, describe, test } from 'node:test';
import { CagecastError, classify, cutBorders, init, type Masks, project, transfer, Zone } from 'cagecast';
import { type Image, maskTriangles, maskVertices } from 'cagecast/engines';
import { applyTransfer, modelMasks } from 'cagecast/three';
import {
  BufferAttribute,
  type BufferGeometry,
  CompressedTexture,
  DataTexture,
  Float16BufferAttribute,
  Group,
  Mesh,
  PlaneGeometry,
  SphereGeometry,
  Texture,
} from 'three';
import { head } from '../scenes.js';

before(init);

const scene = head(3, 14);
const { cage, target } = { cage: scene.cage, target: { ...scene.target, groups: undefined } };
const [vertices, triangles] = [target.positions.length / 3, target.indices.length / 3];

describe('masks', () => {
  test('reach the core, for vertices and triangles, in transfer, classify and cutBorders', () => {
    const plain = transfer(cage, target);
    const first = plain.cosmeticTriangles.indexOf(1);
    const bare = plain.cosmeticTriangles.indexOf(0);
    const masks = {
      vertices: Int8Array.from({ length: vertices }, (_, v) => (v === target.indices[3 * first] ? -1 : 0)),
      triangles: Int8Array.from({ length: triangles }, (_, t) => (t === bare ? 1 : 0)),
    };
    const masked = transfer(cage, target, { masks });
    assert.deepEqual([masked.cosmeticTriangles[first], masked.cosmeticTriangles[bare]], [0, 1]);
    assert.equal(masked.zones[target.indices[3 * first]!], Zone.Culled);
    const found = classify(project(cage, target), { masks });
    assert.deepEqual([found.zones, found.cosmeticTriangles], [masked.zones, masked.cosmeticTriangles]);
    const cut = cutBorders(cage, target, masked, { masks });
    cut.triangles.forEach((t, piece) => {
      if (t === first || t === bare) assert.equal(cut.cosmeticTriangles[piece], Number(t === bare));
    });
  });

  test('masks that do not belong to the target are one clear error', () => {
    const cases: [unknown, RegExp][] = [
      [
        { vertices: new Int8Array(3) },
        /^transfer: options\.masks\.vertices has 3 entries, not 1 for each of \d+ vertices of target/,
      ],
      [
        { triangles: new Int8Array(1) },
        /options\.masks\.triangles has 1 entries, not 1 for each of \d+ triangles of target/,
      ],
      [{ vertices: new Uint8Array(vertices) }, /options\.masks\.vertices is .*, not an Int8Array/],
      [
        { vertices: new Int8Array(vertices).fill(2) },
        /options\.masks\.vertices\[0\] = 2 is not -1 \(never\), 0 or 1 \(always\)/,
      ],
      [{ eyes: new Int8Array(vertices) }, /options\.masks\.eyes is unknown; there are: vertices, triangles/],
      [7, /options\.masks is 7, not an object/],
      [new Map([['vertices', new Int8Array(vertices)]]), /options\.masks is .*, not an object/],
    ];
    for (const [masks, message] of cases)
      assert.throws(
        () => transfer(cage, target, { masks: masks as Masks }),
        { name: 'CagecastError', code: 'badOption', message },
        String(message),
      );
  });
});

/** An image of 64 × 64 whose left part is white. */
function leftWhite(columns: number, white = [255, 255, 255, 255]): Image {
  const data = new Uint8Array(4 * 64 * 64);
  for (let i = 0; i < 64 * 64; ++i) data.set(i % 64 < columns ? white : [0, 0, 0, 255], 4 * i);
  return { width: 64, height: 64, data };
}

describe('masks of loaded models', () => {
  const plane = () => new Mesh(new PlaneGeometry(1, 1, 8, 1));
  const texture = ({ data, width, height }: Image) => new DataTexture(data as Uint8Array<ArrayBuffer>, width, height);

  test('a texture masks the triangles that it whitens, the other way up if it is flipped, part by part', () => {
    const [left, right] = [plane(), plane()];
    right.geometry.deleteAttribute('uv');
    const both = new Group().add(left, right);
    const { triangles } = modelMasks(both, { never: texture(leftWhite(16)) });
    assert.equal(triangles!.length, 32);
    assert.deepEqual(
      [...triangles!.keys()].filter((t) => triangles![t] !== 0),
      [0, 1, 2, 3],
    );
    // Only the upper half of the first column is white: v = 0 is its lower edge.
    const upper = leftWhite(8);
    upper.data.fill(0, 4 * 64 * 32);
    const flipped = texture(upper);
    flipped.flipY = true;
    const shares = [texture(upper), flipped].map((one) => modelMasks(plane(), { always: one }).triangles!.indexOf(1));
    assert.deepEqual(shares.sort(), [0, 1], 'one triangle has more of the upper half, the other of the lower');
  });

  test('colours mask vertices; applyTransfer takes both, and what is missing is an error', () => {
    const geometry = new SphereGeometry(0.9, 16, 12);
    const colors = Float32Array.from({ length: geometry.getAttribute('position').count * 3 }, (_, i) =>
      Number(i % 3 === 0),
    );
    geometry.setAttribute('color', new BufferAttribute(colors, 3));
    const masks = modelMasks(geometry, { attribute: 'color' });
    assert.ok(masks.vertices!.every((mask) => mask === -1));
    const { result } = applyTransfer(geometry, { cage: new SphereGeometry(1, 16, 12), masks });
    assert.ok(result.cosmeticTriangles.every((one) => one === 0));
    assert.throws(
      () => modelMasks(geometry, { attribute: '_mask' }),
      /modelMasks: no part of target has the attribute _mask/,
    );
    assert.throws(() => modelMasks(geometry, { never: new Texture() }), /the texture "never" is not loaded yet/);
    const compressed = new CompressedTexture([{ data: new Uint8Array(8), width: 4, height: 4 }], 4, 4);
    assert.throws(
      () => modelMasks(geometry, { never: compressed }),
      (error) =>
        error instanceof CagecastError &&
        error.code === 'badArgument' &&
        /^modelMasks: the texture "never" cannot be read: /.test(error.message),
    );
  });

  test('half floats are read as what they stand for', () => {
    const [whole, half] = [plane().geometry, plane().geometry];
    const colors = new BufferAttribute(new Float32Array(3 * 18), 3);
    for (let v = 0; v < 9; ++v) colors.setXYZ(v, Number(v < 5), Number(v > 5), 0.25);
    whole.setAttribute('color', colors);
    for (const name of ['uv', 'color']) {
      const from = whole.getAttribute(name);
      const to = new Float16BufferAttribute(new Uint16Array(from.count * from.itemSize), from.itemSize);
      for (let v = 0; v < from.count; ++v) {
        to.setX(v, from.getX(v));
        to.setY(v, from.getY(v));
        if (from.itemSize > 2) to.setZ(v, from.getZ(v));
      }
      half.setAttribute(name, to);
    }
    const masked = (geometry: BufferGeometry) =>
      modelMasks(geometry, { never: texture(leftWhite(16)), attribute: 'color' });
    assert.deepEqual(masked(half), masked(whole));
    assert.ok(masked(whole).triangles!.includes(-1) && masked(whole).vertices!.includes(1), 'both mask something');
  });

  test('an image beside its name, and names that there are not, are an error', () => {
    const image = leftWhite(16);
    const mesh = { indices: [0, 1, 2], uvs: [0, 0, 1, 0, 0, 1] };
    const cases: [() => unknown, RegExp][] = [
      [
        () => maskTriangles(mesh, image as object),
        /^maskTriangles: images\.width is not an option; .*: never, always$/,
      ],
      [() => maskTriangles(mesh, { nevr: image } as object), /^maskTriangles: images\.nevr is not an option/],
      [() => maskTriangles(mesh, null as never), /^maskTriangles: images is null, not an object$/],
      [
        () => modelMasks(plane(), { nevr: texture(image) } as object),
        /^modelMasks: options\.nevr is not an option; modelMasks takes: never, always, attribute, parts$/,
      ],
      [() => modelMasks(plane(), texture(image) as object), /^modelMasks: options\.\w+ is not an option/],
      [() => modelMasks(plane(), undefined as never), /^modelMasks: options is undefined, not an object$/],
      [() => modelMasks(plane(), null as never), /^modelMasks: options is null, not an object$/],
    ];
    for (const [call, message] of cases)
      assert.throws(call, { name: 'CagecastError', code: 'badOption', message }, String(message));
  });
});

describe('masks from images and colours', () => {
  // Eight columns of two triangles each, as wide as an eighth of the image.
  const uvs = Float32Array.from({ length: 9 * 2 * 2 }, (_, i) =>
    i % 2 ? Math.floor(i / 18) : Math.floor((i % 18) / 2) / 8,
  );
  const indices = Array.from({ length: 8 }, (_, c) => [c, c + 1, c + 10, c, c + 10, c + 9]).flat();

  test('a triangle is masked if half of it is white; transparent white is not', () => {
    const masked = (images: Parameters<typeof maskTriangles>[1]) =>
      [...maskTriangles({ indices, uvs }, images)].join(' ');
    assert.equal(masked({ never: leftWhite(16) }), '-1 -1 -1 -1 0 0 0 0 0 0 0 0 0 0 0 0');
    assert.equal(masked({ never: leftWhite(8), always: leftWhite(16) }), '-1 -1 1 1 0 0 0 0 0 0 0 0 0 0 0 0');
    assert.equal(masked({ never: leftWhite(16, [255, 255, 255, 0]) }), Array(16).fill(0).join(' '));
    // UVs repeat.
    assert.deepEqual(
      maskTriangles({ indices, uvs: uvs.map((u) => u + 3) }, { never: leftWhite(16) }),
      maskTriangles({ indices, uvs }, { never: leftWhite(16) }),
    );
    assert.throws(() => maskTriangles({ indices }, {}), /maskTriangles: target has no UVs/);
    assert.throws(() => maskTriangles({ indices, uvs }, { never: 3 as never }), /images\.never is 3, not an image/);
  });

  test('a vertex is never painted if it is red, always if it is green; other colours say nothing', () => {
    const colors = [1, 0, 0, 1, 0, 1, 0, 1, 1, 1, 1, 1, 0, 0, 0, 1, 0.5, 0.5, 0.5, 1, 0, 0, 1, 1, 0.9, 0.3, 0, 1];
    assert.deepEqual([...maskVertices(colors, 4)], [-1, 1, 0, 0, 0, 0, -1]);
    assert.throws(() => maskVertices([1, 2], 3), /colors has 2 numbers/);
  });
});
