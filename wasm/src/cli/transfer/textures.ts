import { basename } from 'node:path';
import type { ReadLimits } from '../../gltf/checks/read-limits.js';
import { type Paint, paintOf, tileAt } from '../../gltf/overlay.js';
import type { ReadModel } from '../../gltf/read-model.js';
import { partOf, primitivePath } from '../../scene/extract.js';
import { InputError, naming } from '../../scene/input-error.js';
import { readBytes } from '../io/files.js';
import { quoted } from '../model/text.js';
import { tilePath } from '../model/uv-bounds.js';

/** The types of images that a GLB can have as a texture. */
const kTypes = ['image/png', 'image/jpeg', 'image/webp', 'image/ktx2'];

/** Reads a texture. @throws {InputError} that names the file. */
export const readPaint = (path: string, limits: ReadLimits): Promise<Paint> =>
  naming(path, async () => paintOf(await readBytes(path, limits), basename(path), kTypes));

/** Reads the texture of each tile that a cage uses. @throws {InputError} that names the file, or the cage's triangle. */
export async function readTiles(
  path: string,
  cage: ReadModel,
  limits: ReadLimits,
): Promise<(Paint & { tile: number })[]> {
  const tiles = tilesOf(cage);
  return Promise.all(
    tiles.map(async (tile) => {
      const paint = await readPaint(tilePath(path, tile), limits).catch((error: unknown) => {
        const text = `${cage.file.path} uses the ${tiles.length === 1 ? 'tile' : 'tiles'} ${tiles.join(', ')}`;
        throw error instanceof InputError ? new InputError(`${error.message} (${text})`, { cause: error }) : error;
      });
      return { ...paint, tile };
    }),
  );
}

/** How far a UV may be beyond the border of its tile, by rounding. */
const kSlack = 1e-3;

/** The tiles of UDIM that a cage's UVs are in, in order. @throws {InputError} for a triangle that is not in one of them. */
function tilesOf({ file, extracted: { mesh, parts } }: ReadModel): number[] {
  const { indices } = mesh;
  const uvs = mesh.uvs!;
  const tiles = new Set<number>();
  for (let t = 0; t < indices.length / 3; ++t) {
    const corners = [...indices.subarray(3 * t, 3 * t + 3)].map((v) => [uvs[2 * v]!, uvs[2 * v + 1]!] as const);
    const centre = [0, 1].map((k) => (corners[0]![k]! + corners[1]![k]! + corners[2]![k]!) / 3) as [number, number];
    const [left, top] = [Math.floor(centre[0]), Math.floor(centre[1])];
    const isInside = corners.every(
      ([u, v]) => u >= left - kSlack && u <= left + 1 + kSlack && v >= top - kSlack && v <= top + 1 + kSlack,
    );
    if (isInside && left >= 0 && left < 10 && top <= 0) {
      tiles.add(tileAt(...centre));
      continue;
    }
    const part = partOf(parts, indices[3 * t]!)!;
    const shown = corners.map(([u, v]) => `${Number(u.toFixed(3))}, ${Number(v.toFixed(3))}`).join('; ');
    throw new InputError(
      `${primitivePath(part)} (${quoted(part.name)}), triangle ${t - part.firstTriangle} ${isInside ? 'is in no UDIM tile' : 'is in more than one UDIM tile'}: its UVs are ${shown}`,
    ).in(file.path);
  }
  return [...tiles].sort((a, b) => a - b);
}
