import type { Classification } from 'cagecast';
import type { ExtractedMesh } from '../state/model';
import type { Shown } from '../state/scene';
import { diagonalOf } from '../state/surface';
import { type ColorMap, colorAt, kDiverging, kSequential, type Rgb } from './colors';
import { segmentColors } from './segments';

/** The scale of a color map. */
export interface Scale {
  title: string;
  map: ColorMap;
  /** Evenly spaced labels, from the first colour to the last. */
  ticks: string[];
}

/** Colours of a target, 3 bytes per triangle corner, with a scale if they have one. */
export interface Coloring {
  colors: Uint8Array;
  scale?: Scale;
}

/** The colour of triangles that are not painted. */
const kClay: Rgb = [154, 167, 179];
const kFarthest = 0.98; // quantile of the distances at the end of the scale, so that outliers do not compress it
const kDoublings = 2; // from the middle of the stretch scale to either end

/** Colours each segment differently. */
export function colorBySegment(shown: Shown): Coloring {
  const colors = segmentColors(shown);
  const { segments } = shown.projection;
  return { colors: perCorner(shown.target.mesh, (vertex) => colors[segments[vertex]!]!) };
}

/** Colours vertices by their distance to the cage. */
export function colorByDistance(
  { target: { mesh }, projection: { distances } }: Shown,
  { zones }: Classification,
): Coloring {
  const diagonal = diagonalOf(mesh) || 1;
  const cosmetic = distances.filter((_, vertex) => zones[vertex] === 0);
  const sorted = (cosmetic.length > 0 ? cosmetic : distances).toSorted();
  const longest = roundedUp((100 * sorted[Math.floor(kFarthest * (sorted.length - 1))]!) / diagonal);
  const ramp = rampOf(kSequential);
  const colors = perCorner(mesh, (vertex) => ramp((100 * distances[vertex]!) / diagonal / longest));
  const ticks = [0, 0.25, 0.5, 0.75, 1].map(
    (share) => `${share === 1 ? '≥ ' : ''}${Number((share * longest).toPrecision(3))}`,
  );
  return { colors, scale: { title: 'Distance to the cage, % of the model’s diagonal', map: kSequential, ticks } };
}

/**
 * Colours painted triangles by the stretch of the texture: the length on the model of a unit step in the texture, in the
 * direction of the largest stretch, relative to the median.
 */
export function colorByStretch(
  { target: { mesh }, projection }: Shown,
  { cosmeticTriangles }: Classification,
): Coloring {
  const stretch = stretches(mesh, projection);
  const median =
    medianOf(stretch.filter((value, triangle) => cosmeticTriangles[triangle] === 1 && Number.isFinite(value))) || 1;
  const ramp = rampOf(kDiverging);
  const colors = perCorner(mesh, (_, triangle) => {
    if (cosmeticTriangles[triangle] !== 1) return kClay;
    return ramp(0.5 + Math.log2(stretch[triangle]! / median) / (2 * kDoublings));
  });
  const ticks = ['≤ ¼×', '½×', '1×', '2×', '≥ 4×'];
  return { colors, scale: { title: 'Stretch of the paint, relative to the median', map: kDiverging, ticks } };
}

/** 1 per triangle: the larger singular value of the map from texture to surface; infinite without area in the texture. */
function stretches({ positions, indices }: ExtractedMesh, { uvs, cornerUvs }: Shown['projection']): Float64Array {
  const ofCorners = cornerUvs.length > 0;
  const texture = ofCorners ? cornerUvs : uvs;
  const stretch = new Float64Array(indices.length / 3);
  for (let triangle = 0; triangle < stretch.length; triangle++) {
    const first = 3 * triangle;
    const [i, j, k] = [indices[first]!, indices[first + 1]!, indices[first + 2]!];
    const [a, b, c] = ofCorners ? [first, first + 1, first + 2] : [i, j, k];
    const [bu, bv] = [texture[2 * b]! - texture[2 * a]!, texture[2 * b + 1]! - texture[2 * a + 1]!];
    const [cu, cv] = [texture[2 * c]! - texture[2 * a]!, texture[2 * c + 1]! - texture[2 * a + 1]!];
    const area = bu * cv - cu * bv;
    // Derivatives of the position by u and v; Sander et al., Texture Mapping Progressive Meshes, 2001.
    let [uu, uv, vv] = [0, 0, 0];
    for (let axis = 0; axis < 3; axis++) {
      const ab = positions[3 * j + axis]! - positions[3 * i + axis]!;
      const ac = positions[3 * k + axis]! - positions[3 * i + axis]!;
      const alongU = (ab * cv - ac * bv) / area;
      const alongV = (ac * bu - ab * cu) / area;
      uu += alongU * alongU;
      uv += alongU * alongV;
      vv += alongV * alongV;
    }
    stretch[triangle] = area === 0 ? Infinity : Math.sqrt((uu + vv + Math.hypot(uu - vv, 2 * uv)) / 2);
  }
  return stretch;
}

/** A lookup table of 256 colours: interpolating for each vertex takes ten times as long. */
function rampOf(map: ColorMap): (share: number) => Rgb {
  const steps = Array.from({ length: 256 }, (_, step) => colorAt(map, step / 255));
  return (share) => steps[Math.round(255 * Math.min(1, Math.max(0, share)))]!;
}

function perCorner({ indices }: ExtractedMesh, colorOf: (vertex: number, triangle: number) => Rgb): Uint8Array {
  const colors = new Uint8Array(3 * indices.length);
  for (let corner = 0; corner < indices.length; corner++) {
    const color = colorOf(indices[corner]!, Math.floor(corner / 3));
    colors[3 * corner] = color[0];
    colors[3 * corner + 1] = color[1];
    colors[3 * corner + 2] = color[2];
  }
  return colors;
}

function medianOf(values: Float64Array): number {
  return values.toSorted()[Math.floor(values.length / 2)] ?? 0;
}

/** The next of 1, 2, 4, 6, 8 and 10 times a power of ten, which divide well by four. */
function roundedUp(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  return power * [1, 2, 4, 6, 8, 10].find((step) => step * power >= value)!;
}
