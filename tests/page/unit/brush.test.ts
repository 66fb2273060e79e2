import assert from 'node:assert/strict';
import { test } from 'node:test';
import { SphereGeometry, Vector3 } from 'three';
import { CageTexels, type Capsule } from '#three';
import { BrushTool } from '../../../web/src/tools/paint/brush-tool';

const { attributes, index } = new SphereGeometry(1, 16, 8);
const cageTexels = new CageTexels(
  {
    positions: attributes.position!.array as Float32Array,
    uvs: attributes.uv!.array as Float32Array,
    indices: Uint32Array.from(index!.array),
  },
  64,
);
const event = { clientX: 0, clientY: 0, pointerType: 'mouse' } as PointerEvent;

/** Paints at a spot. @param scale Pixels of the screen per unit of length of the cage. @returns Diameters in pixels: of the paint, and of the circle before and at it; and the texels of the painting. */
function dab(scale: number, size: number): { painted: number; shown: number[]; texels: number } {
  const options = { color: '#ff0000', opacity: 1, hardness: 1, mirror: false, size, texels: 1024 as 1024 | 2048 };
  const painted: number[] = [];
  const shown: number[] = [];
  const surface = { point: new Vector3(0, 0, 1), normal: new Vector3(0, 0, 1) };
  const brush = new BrushTool(
    {
      cageTexels,
      triangles: 1,
      aimOf: (spot) => spot && { surface, scale },
      aimAt: () => undefined,
      telling: (begin) => begin(),
      begin() {},
      extend: (capsules: readonly Capsule[]) => painted.push(...capsules.map(({ radius }) => 2 * radius * scale)),
      end() {},
      cancel() {},
    },
    options,
    { follow: (_aim, _event, diameter) => shown.push(diameter) },
    false,
  );
  const spot = {} as Parameters<BrushTool['down']>[0];
  brush.hover(spot, event);
  assert.ok(brush.down(spot, event));
  brush.hover(spot, event);
  brush.up();
  return { painted: painted[0]!, shown, texels: options.texels };
}

test('the brush paints what its circle shows, which has one size on the screen however near the model is', () => {
  for (const scale of [100, 400, 1600]) {
    const { painted, shown } = dab(scale, 30);
    for (const diameter of [painted, ...shown]) assert.ok(Math.abs(diameter - 30) < 1e-6, `${diameter} at ${scale}`);
  }
});

test('a stroke that is fine on the model gets a painting of more texels', () => {
  assert.deepEqual(
    [100, 400, 1600].map((scale) => dab(scale, 30).texels),
    [1024, 1024, 2048],
  );
});
