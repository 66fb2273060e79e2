import { BufferGeometry } from 'three';
import { paintAttribute } from '../materials/paint-shader.js';
import { type Attribute, zoneAttribute } from './attributes.js';
import { isOfInstances } from './flags.js';
import { disposeOwn } from './own-attributes.js';
import { firstOf } from './remake.js';

export type Channel = 1 | 2 | 3;

/** Who has written a geometry. */
export interface Writer {
  /** Told that a geometry no longer has what was written. */
  replaced(geometry: BufferGeometry): void;
}

/** What a transfer has made of a geometry. */
interface Write {
  writer: Writer;
  channel: Channel;
  before: BufferGeometry;
  made: BufferGeometry;
  /** Of the attributes that were made. */
  versions: Record<string, number>;
}

/** The transfers that geometries show, each made on top of the one before. */
const writes = new WeakMap<BufferGeometry, Write[]>();

/** Holds what a geometry has now: transfers give it other attributes, but do not change these. */
export function stateOf(geometry: BufferGeometry): BufferGeometry {
  const { name, userData } = geometry;
  return Object.assign(new BufferGeometry(), { name, userData }, partsOf(geometry));
}

function partsOf({ attributes, morphAttributes, morphTargetsRelative, index, groups, drawRange }: BufferGeometry) {
  return {
    attributes: { ...attributes },
    morphAttributes: { ...morphAttributes },
    morphTargetsRelative,
    index,
    groups,
    drawRange: { ...drawRange },
  };
}

/**
 * What a geometry was before the transfers that one into a channel takes the place of: all, if no channel is asked for; else that
 * which wrote it, and those after it. Attributes that others have added or changed since are in it, too.
 */
export function beforeOf(geometry: BufferGeometry, channel?: Channel): BufferGeometry {
  const list = writesOf(geometry);
  const first = list[placeOf(list, channel)];
  if (!first) return stateOf(geometry);
  const out = stateOf(first.before);
  const last = list.at(-1)!;
  const own = [zoneAttribute, paintAttribute, ...list.map((one) => `uv${one.channel}`)];
  const { attributes } = geometry;
  for (const name of Object.keys({ ...attributes, ...last.made.attributes })) {
    if (own.includes(name)) continue;
    const attribute = attributes[name] as Attribute | undefined;
    if (!attribute) delete out.attributes[name];
    else if (attribute !== last.made.attributes[name] || versionOf(attribute) !== last.versions[name])
      out.attributes[name] = isOfInstances(attribute)
        ? attribute
        : shortened(attribute, first.before.attributes['position']!.count);
  }
  return out;
}

/** What was made of attributes: as long as one stays as it is, the same is made of it. */
const shortOnes = new WeakMap<Attribute, { version: number; short: Attribute }>();

/** An attribute for the first vertices alone: those of the model. */
function shortened(attribute: Attribute, count: number): Attribute {
  const known = shortOnes.get(attribute);
  const version = versionOf(attribute);
  if (known?.version === version && known.short.count === count) return known.short;
  const short = firstOf(attribute, count);
  shortOnes.set(attribute, { version, short });
  return short;
}

/** Calls a function while geometries are what `beforeOf` says. */
export function asBefore<T>(geometries: ReadonlySet<BufferGeometry>, channel: Channel | undefined, call: () => T): T {
  const now = [...geometries].flatMap((geometry) =>
    writesOf(geometry).length > 0 ? [{ geometry, parts: partsOf(geometry), before: beforeOf(geometry, channel) }] : [],
  );
  for (const { geometry, before } of now) Object.assign(geometry, partsOf(before));
  try {
    return call();
  } finally {
    for (const { geometry, parts } of now) Object.assign(geometry, parts);
  }
}

/** Makes a geometry what `beforeOf` says. @returns the writers that are not on it any more, the last one first. */
export function rewind(geometry: BufferGeometry, channel?: Channel): Writer[] {
  const list = writesOf(geometry);
  const place = placeOf(list, channel);
  const gone = list.slice(place).map(({ writer }) => writer);
  if (gone.length > 0) {
    const before = beforeOf(geometry, channel);
    disposeOwn(geometry);
    Object.assign(geometry, partsOf(before));
  }
  writes.set(geometry, list.slice(0, place));
  return gone.reverse();
}

/** Notes the result of a transfer to a rewound geometry. @param before  The result of `beforeOf`. */
export function noteWrite(geometry: BufferGeometry, write: Pick<Write, 'writer' | 'channel' | 'before'>): void {
  writes.set(geometry, [...(writes.get(geometry) ?? []), { ...write, ...madeOf(geometry) }]);
}

/** Notes that the last transfer has changed a geometry again. */
export function noteChange(geometry: BufferGeometry): void {
  const last = writes.get(geometry)?.at(-1);
  if (last) Object.assign(last, madeOf(geometry));
}

/** Takes a writer off a geometry: it is what it was before, unless others have written on top; then it is once these are gone. */
export function takeOff(geometry: BufferGeometry, writer: Writer): void {
  const write = writesOf(geometry).find((one) => one.writer === writer);
  if (!write) return;
  write.writer = kNobody;
  const last = () => writesOf(geometry).at(-1);
  for (let top = last(); top?.writer === kNobody; top = last()) rewind(geometry, top.channel);
}

/** Whether what a writer has made of a geometry is still in it. */
export const isWrittenBy = (geometry: BufferGeometry, writer: Writer): boolean =>
  writes.get(geometry)?.some((one) => one.writer === writer) === true;

const kNobody: Writer = { replaced() {} };

const madeOf = (geometry: BufferGeometry): Pick<Write, 'made' | 'versions'> => ({
  made: stateOf(geometry),
  versions: Object.fromEntries(
    Object.entries(geometry.attributes).map(([name, attribute]) => [name, versionOf(attribute as Attribute)]),
  ),
});

const versionOf = (attribute: Attribute): number =>
  'isInterleavedBufferAttribute' in attribute ? attribute.data.version : attribute.version;

/** The writes of a geometry; none if others have given it other vertices or triangles since. */
function writesOf(geometry: BufferGeometry): readonly Write[] {
  const list = writes.get(geometry) ?? [];
  const made = list.at(-1)?.made;
  const { attributes, morphAttributes, index } = geometry;
  const isAsMade =
    !made ||
    (index === made.index &&
      attributes['position']?.count === made.attributes['position']!.count &&
      morphAttributes.position === made.morphAttributes.position);
  return isAsMade ? list : [];
}

const placeOf = (list: readonly Write[], channel: Channel | undefined): number => {
  const place = channel === undefined ? 0 : list.findIndex((one) => one.channel === channel);
  return place < 0 ? list.length : place;
};
