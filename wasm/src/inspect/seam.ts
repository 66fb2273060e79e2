import { faceFrameOf, type Spots } from './face.js';
import type { Finding } from './finding.js';
import { between, dot, doubleAreaNormal, joined, length, minus, pointAt, type Vector } from './geometry.js';
import { reverse } from './reverse.js';
import { partsOf, type Scene } from './scene.js';
import { placeOfSegment, type Segment } from './segments.js';
import { isSeam } from './uv.js';

/** How far the middle of a face reaches from the middle between its eyes: to the sides, up and down; in distances of the eyes. */
const kAside = 0.85;
const kUp = 0.35;
const kDown = 1.5;
/** A seam over the face is reported from this length on, in distances of the eyes. */
const kLength = 0.5;
/** The least cosine between a normal and the face's direction at which a triangle is seen from the front. */
const kFacing = 0.3;
/** In how many pieces each edge is looked at. */
const kPieces = 8;

/**
 * Reports a seam of the cage's UVs over the painted face, between brows and chin. Cost: a projection of the points of such seams.
 * @param landmarks  Of the target. Without both `eye_centre_*` nothing is known of its face.
 */
export function checkSeam(scene: Scene, segments: readonly Segment[], landmarks: Spots = {}): Finding[] {
  const frame = faceFrameOf(landmarks);
  const { cage, surface, target, result, parts, areas } = scene;
  if (!frame || !cage.uvs) return [];
  const { right, size, across, up, front } = frame;
  const pieces: { point: Vector; length: number }[] = [];
  for (const edge of surface.edges) {
    if (edge.uses.length < 2 || !isSeam(edge, cage.indices, cage.uvs)) continue;
    const [a, b] = [pointAt(cage.positions, edge.a), pointAt(cage.positions, edge.b)];
    for (let i = 0.5; i < kPieces; ++i) {
      const point = between(a, b, i / kPieces);
      const d = minus(point, right);
      const [x, y] = [dot(d, across) / size - 0.5, dot(d, up) / size];
      if (Math.abs(x) < kAside && y < kUp && y > -kDown && dot(d, front) > 0)
        pieces.push({ point, length: length(minus(b, a)) / kPieces / size });
    }
  }
  const points = Float32Array.from(pieces.flatMap(({ point }) => point));
  const reversed = pieces.length > 0 && reverse(scene, joined(cage.positions, points));
  if (!reversed) return [];
  const painted = pieces.flatMap(({ length: long }, i) => {
    const at = cage.positions.length / 3 + i;
    const normal = doubleAreaNormal(...reversed.corners(at));
    const isSeen = dot(normal, front) > kFacing * length(normal);
    const t = reversed.triangles[at]!;
    return isSeen && result.cosmeticTriangles[t] === 1 ? [{ vertex: target.indices[3 * t]!, long }] : [];
  });
  const total = painted.reduce((sum, { long }) => sum + long, 0);
  if (total < kLength) return [];
  const { vertex } = painted[0]!;
  const part = parts[partsOf(parts, areas.length)[vertex]!]?.name ?? '';
  const segment = result.segments[vertex]!;
  return [
    {
      code: 'faceSeam',
      weight: 0.3,
      sentence: `A seam of the cage's UVs runs over the face of "${part}", ${total.toFixed(1)} times as long as the eyes are apart`,
      advice: 'Fit a template, whose seams are not on the face, or unwrap the cage so that its face is in one chart.',
      numbers: { length: total },
      places: [placeOfSegment(segment, segments[segment]!)],
    },
  ];
}
