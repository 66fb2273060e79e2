import { ColorUtils, Document, NodeIO } from '@gltf-transform/core';
import type { Mesh } from 'cagecast';
import { thumbnail } from 'cagecast/gltf';
import { PNG } from 'pngjs';
import type { Labels } from './labels.js';

/** What is shown of a vertex, with its colour: by Okabe and Ito, which people who do not see all colours can tell apart. */
export const kColors = {
  painted: 0x56b4e9,
  forbidden: 0xd55e00,
  missing: 0xf0e442,
  bare: 0x6e6e6e,
  unscored: 0xcdcdcd,
} as const;
type What = keyof typeof kColors;

/** In words. */
export const kLegend: Record<What, string> = {
  painted: 'blue: painted, as it should be',
  forbidden: 'orange-red: forbidden paint',
  missing: 'yellow: missing paint',
  bare: 'dark grey: left out, as it should be',
  unscored: 'light grey: not scored',
};

/** From where models are seen. */
const kViews = [
  { azimuth: 30, elevation: 10 },
  { azimuth: -75, elevation: 10 },
];
const kSize = 240;

/** @param zones  Of a method; without, the truth is shown. */
function whatOf({ ncz, ignore, offCage }: Labels, v: number, zones?: Uint8Array): What {
  const isNcz = ncz[v] === 1;
  if (ignore[v] === 1 || (!isNcz && offCage[v] === 1)) return 'unscored';
  const isPainted = zones === undefined ? !isNcz : zones[v] === 0;
  if (isPainted) return isNcz ? 'forbidden' : 'painted';
  return isNcz ? 'bare' : 'missing';
}

/** Pictures of a model, one beside the other, as a PNG. @param zones  Of a method; without, the truth is shown. */
export async function draw(target: Mesh, labels: Labels, zones?: Uint8Array): Promise<Buffer> {
  const model = await glbOf(target, (v) => whatOf(labels, v, zones));
  const sheet = new PNG({ width: kViews.length * kSize, height: kSize });
  for (const [n, view] of kViews.entries()) {
    const picture = new PNG({ width: kSize, height: kSize });
    picture.data.set((await thumbnail(model, { size: kSize, view })).data);
    PNG.bitblt(picture, sheet, 0, 0, kSize, kSize, n * kSize, 0);
  }
  return PNG.sync.write(sheet);
}

/** A model whose triangles have the colours of their corners: as in the score, a third for each. */
function glbOf({ positions, indices }: Mesh, whatIs: (vertex: number) => What): Promise<Uint8Array> {
  const points: Record<What, number[]> = { painted: [], forbidden: [], missing: [], bare: [], unscored: [] };
  const mean = (...vertices: number[]): number[] =>
    [0, 1, 2].map((k) => vertices.reduce((sum, v) => sum + positions[3 * v + k]!, 0) / vertices.length);
  for (let t = 0; t < indices.length; t += 3) {
    const [a, b, c] = [indices[t]!, indices[t + 1]!, indices[t + 2]!];
    const whats = [a, b, c].map(whatIs);
    if (whats.every((what) => what === whats[0])) points[whats[0]!].push(...mean(a), ...mean(b), ...mean(c));
    else
      for (const [k, [p, q, r]] of [[a, b, c] as const, [b, c, a] as const, [c, a, b] as const].entries()) {
        const middle = mean(a, b, c);
        points[whats[k]!].push(...mean(p), ...mean(p, q), ...middle, ...mean(p), ...middle, ...mean(p, r));
      }
  }
  const document = new Document();
  const buffer = document.createBuffer();
  const mesh = document.createMesh();
  for (const [what, place] of Object.entries(points)) {
    if (place.length === 0) continue;
    const array = Float32Array.from(place);
    const accessor = document.createAccessor().setType('VEC3').setArray(array).setBuffer(buffer);
    const material = document.createMaterial().setDoubleSided(true);
    material.setBaseColorFactor(
      ColorUtils.hexToFactor(kColors[what as What], [0, 0, 0, 1]) as [number, number, number, number],
    );
    mesh.addPrimitive(document.createPrimitive().setAttribute('POSITION', accessor).setMaterial(material));
  }
  document.createScene().addChild(document.createNode().setMesh(mesh));
  return new NodeIO().writeBinary(document);
}
