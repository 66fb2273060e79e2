import { Vector3 } from 'three';
import { triangulated } from './polygon.js';

/** Vertices and faces; a backslash at the end of a line continues it. */
const kLine = /^[ \t]*([vf])[ \t]+((?:[^\\\n]|\\\r?\n|\\)*)/gm;

/** A face of more than three corners. */
const kPolygon = /^[ \t]*f(?:[ \t]+\S+){4}/m;

/** An OBJ whose faces that are not convex are triangles: three's loader makes fans of all. */
export function withConvexFaces(text: string): string {
  if (!kPolygon.test(text) && !/\\\r?\n/.test(text)) return text;
  const places: Vector3[] = [];
  return text.replace(kLine, (line, kind: string, values: string) => {
    const words = values.replaceAll('\\', ' ').trim().split(/\s+/);
    if (kind === 'v')
      places.push(new Vector3(...(words.slice(0, 3).map(Number.parseFloat) as [number, number, number])));
    if (kind === 'v' || words.length < 4) return line;
    const corners = words.map((word) => {
      const number = Number.parseInt(word, 10);
      return places[number < 0 ? places.length + number : number - 1];
    });
    if (corners.includes(undefined)) return line;
    const triangles = triangulated(corners as Vector3[]);
    if (triangles.every((corner, k) => corner === [0, Math.floor(k / 3) + 1, Math.floor(k / 3) + 2][k % 3]))
      return line;
    const faces = triangles.map((corner, k) => `${k % 3 === 0 ? 'f ' : ''}${words[corner]}${k % 3 === 2 ? '\n' : ' '}`);
    return faces.join('').trimEnd();
  });
}
