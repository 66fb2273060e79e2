import type { TemplateMesh } from './template.js';

/**
 * Reads the faces of a Wavefront OBJ file with their UVs: positions, UVs and polygons, of all its objects together. Vertices keep their
 * order; one with several UVs comes once for each.
 * @param wrong  Makes the error, which names the line.
 */
export function readObj(text: string, wrong: (text: string) => Error): TemplateMesh {
  const points: number[][] = [];
  const texels: number[][] = [];
  /** The number of a vertex with one of its UVs: in the order of the file once all are known. */
  const corners: [point: number, texel: number][] = [];
  for (const [l, line] of text.split(/\r?\n/).entries()) {
    const [word, ...values] = line.replace(/#.*/, '').trim().split(/\s+/);
    const bad = (what: string) => wrong(`line ${l + 1}: ${what}`);
    const numbers = (count: number) => {
      const found = values.slice(0, count).map(Number);
      if (found.length < count || !found.every(Number.isFinite)) throw bad(`"${word}" needs ${count} numbers`);
      return found;
    };
    /** Numbers count from 1, or, if negative, from the last one back. */
    const place = (value: string | undefined, list: unknown[], what: string) => {
      const number = Number(value);
      const i = number < 0 ? list.length + number : number - 1;
      if (!Number.isInteger(number) || list[i] === undefined)
        throw bad(`${what} is ${JSON.stringify(value)}; there are ${list.length} so far`);
      return i;
    };
    if (word === 'v') points.push(numbers(3));
    if (word === 'vt') texels.push(numbers(2));
    if (word !== 'f') continue;
    if (values.length < 3) throw bad('a face needs 3 corners');
    const polygon = values.map((value): [number, number] => {
      const [point, texel] = value.split('/');
      if (!texel) throw bad(`corner "${value}" has no UV: the texture is drawn in the cage's UVs`);
      return [place(point, points, 'a vertex'), place(texel, texels, 'a UV')];
    });
    for (let k = 2; k < polygon.length; ++k) corners.push(polygon[0]!, polygon[k - 1]!, polygon[k]!);
  }
  if (corners.length === 0) throw wrong('has no faces; at least one is needed');
  const keyOf = ([point, texel]: [number, number]) => point * texels.length + texel;
  const vertices = [...new Set(corners.map(keyOf))].sort((a, b) => a - b);
  const numberOf = new Map(vertices.map((key, i) => [key, i]));
  return {
    positions: Float32Array.from(vertices.flatMap((key) => points[Math.floor(key / texels.length)]!)),
    // glTF counts v from the top.
    uvs: Float32Array.from(
      vertices.flatMap((key) => [texels[key % texels.length]![0]!, 1 - texels[key % texels.length]![1]!]),
    ),
    indices: Uint32Array.from(corners, (corner) => numberOf.get(keyOf(corner))!),
  };
}
