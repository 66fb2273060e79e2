/** A part of the space of a cage's UVs: the least u and v, then the greatest. */
export type UvBounds = readonly [number, number, number, number];

/** Whether a value is bounds. */
export const areBounds = (value: unknown): value is UvBounds =>
  Array.isArray(value) &&
  value.length === 4 &&
  value.every(Number.isFinite) &&
  (value[0] as number) < (value[2] as number) &&
  (value[1] as number) < (value[3] as number);

export const boundsText = 'four numbers U0,V0,U1,V1 with U0 < U1 and V0 < V1';

/** The least bounds around some, and 0..1. */
export const boundsAround = (all: readonly UvBounds[]): UvBounds => [
  Math.min(0, ...all.map(([left]) => left)),
  Math.min(0, ...all.map(([, top]) => top)),
  Math.max(1, ...all.map(([, , right]) => right)),
  Math.max(1, ...all.map(([, , , bottom]) => bottom)),
];

/** What stands for the number of a tile of UDIM in the name of a texture. */
const kPlaceholder = '<UDIM>';

/** Whether a path names a texture for each tile. */
export const isTiled = (path: string): boolean => path.includes(kPlaceholder);

/** The path of a tile's texture; with `*` for the tile, a pattern for all. */
export const tilePath = (path: string, tile: number | '*'): string => path.replaceAll(kPlaceholder, String(tile));

/** The bounds of a tile. */
export function boundsOfTile(tile: number): UvBounds {
  const [column, row] = [(tile - 1001) % 10, Math.floor((tile - 1001) / 10)];
  return [column, -row, column + 1, 1 - row];
}

/** Why a texture and bounds of UVs exclude each other, if they do. */
export const boundsFault = (texture: string | undefined, bounds: UvBounds | undefined): string | undefined =>
  texture !== undefined && isTiled(texture) && bounds
    ? `bounds of UVs cannot be given with a texture of ${kPlaceholder} tiles: each file covers its own tile`
    : undefined;
