// What three.js does not keep of an FBX.
import type { Mesh, Object3D } from 'three';
import { uvSetNames } from '../../../scene/uv-sets.js';
import { isBinaryFbx, recordsOf } from '../checks/fbx.js';
import type { FormatLimits } from '../limits.js';

/** A line of an FBX that names a geometry or a UV set, or begins one. */
interface Line {
  kind: string;
  text: string;
}

/** Keeps the names of UV sets, where a geometry has several, in its `userData`. Geometries of one name that differ in them have none. */
export function nameUvSets(scene: Object3D, bytes: Uint8Array, limits: FormatLimits): void {
  const known = new Map<string, string[] | undefined>();
  for (const { name, sets } of geometriesIn(isBinaryFbx(bytes) ? binaryLines(bytes, limits) : textLines(bytes)))
    known.set(name, known.has(name) && known.get(name)?.join('\n') !== sets.join('\n') ? undefined : sets);
  scene.traverse((object) => {
    const { geometry } = object as Partial<Mesh>;
    const sets = geometry && known.get(geometry.name);
    const count = Object.keys(geometry?.attributes ?? {}).filter((name) => /^uv\d?$/.test(name)).length;
    if (geometry && sets && sets.length > 1 && sets.length === count) geometry.userData[uvSetNames] = sets;
  });
}

/** The geometries, and the names of their UV sets, in the order of the file. */
function geometriesIn(lines: Iterable<Line>): { name: string; sets: string[] }[] {
  const found: { name: string; sets: string[] }[] = [];
  let isInSet = false;
  for (const { kind, text } of lines) {
    if (kind === 'Geometry') found.push({ name: text, sets: [] });
    if (kind === 'Name' && isInSet) found.at(-1)?.sets.push(text);
    isInSet =
      kind === 'LayerElementUV' || (isInSet && kind !== 'Name' && !kind.startsWith('Layer') && kind !== 'Geometry');
  }
  return found;
}

function* binaryLines(bytes: Uint8Array, limits: FormatLimits): Generator<Line> {
  for (const { name, texts } of recordsOf(bytes, limits)) yield { kind: name, text: texts[0]?.split('\0')[0] ?? '' };
}

function* textLines(bytes: Uint8Array): Generator<Line> {
  const pattern = /^[\t ]*(Geometry|Layer\w*|Name):(?:[^"\n]*"(?:\w+::)?([^"\n]*)")?/gm;
  for (const [, kind, text = ''] of new TextDecoder().decode(bytes).matchAll(pattern)) yield { kind: kind!, text };
}
