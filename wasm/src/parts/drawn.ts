// Which parts of a model count. What a viewer does not draw is neither painted nor in the way.
import { kPartLists } from '../api/option-names.js';
import { type PartOf, type Parts, partsNamed } from '../api/parts.js';
import { show } from '../core/error.js';
import { determinant } from './affine.js';
import { cageParts } from './own-cages.js';
import { movePoints } from './points.js';

/** What decides whether a viewer draws a part. */
export interface Look {
  /** The names of its node, its mesh and its materials. */
  names: readonly (string | undefined)[];
  /** The names of the nodes above it. Default: none. */
  above?: readonly (string | undefined)[];
  /** Whether it, or something above it, is switched off. */
  isHidden: boolean;
  /** Whether the alpha of its material, or of its vertices, leaves nothing of it. */
  isClear: boolean;
  /** The sides of its triangles that are drawn. */
  sides: 'front' | 'back' | 'both';
  /** Its own positions, 3 per vertex. */
  positions: ArrayLike<number>;
  /** Its own triangles. Default: all vertices in their order */
  indices: ArrayLike<number> | undefined;
  /** From its own space to the scene's. */
  matrix: ArrayLike<number>;
}

/** Why a part does not count, for people. */
const kReasons = {
  name: 'by name a cage, marker or collision shape',
  hidden: 'hidden',
  transparent: 'fully transparent',
  outline: 'only its back is drawn, around others',
  backdrop: 'a ground or backdrop that reaches beyond all others',
  ignored: 'ignored',
};

/** A part that is left out, and why. */
export interface LeftOut {
  name: string;
  why: keyof typeof kReasons;
}

/** The extension of glTF that switches nodes off, with all below them. */
export const visibilityExtension = 'KHR_node_visibility';
/** The extension of glTF for materials that light goes through. */
export const transmissionExtension = 'KHR_materials_transmission';

/** Names of cages, markers and collision shapes: of Roblox, Unreal, Godot, MakeHuman, and usual ones. Programs add numbers to them. */
const kTechnical = [
  /^(UCX|UBX|USP|UCP|MCDCX)([ ._-]|\d*$)|_(OuterCage|InnerCage|Att)([._]?\d+)?$|^helper-/i,
  /[_$-]((conv)?colonly|navmesh|occonly|noimp)([._]?\d+)?$/i,
  /^(collision|collider|hit[ _-]?box)(e?s)?([ ._-]|[ ._-]?(mesh|box|shape|hull|geo|proxy)?[._]?\d*$)/i,
  /[ ._$-](collision|collider|hit[ _-]?box)(e?s)?[ ._-]?(mesh|box|shape|hull|geo|proxy)?([._]?\d+)?$/i,
  /[a-z\d](Collision|Collider|Hit_?[Bb]ox)(e?s)?(Mesh|Box|Shape|Hull|Geo|Proxy)?([._]?\d+)?$/,
];
/** The node of a collision shape, by the name of its model before or after it; in names of materials `col` stands for a colour. */
const kShapeAfter = /^(.+)[_-](conv)?col([._]?\d+)?$/i;
const kShapeBefore = /^(?:conv)?col[_-](.+)$/i;
/** What programs add to a name that is there. */
const kNumber = /[._]?\d{1,9}$/;
/** A cube at a joint of MakeHuman's mesh, beside its helpers. */
const kJoint = /^joint-/;
const kHelper = /^helper-/;

/** Words that name what a figure wears or carries. */
const kAccessories =
  /^((eye|sun)?glasses|goggles|spectacles|hats?|beanie|headwear|facewear|earrings?|necklace|weapons?|swords?|daggers?|kni(fe|ves)|axes?|spears?|shields?|bows?|crossbows?|guns?|pistols?|rifles?)$/;

/** Which parts of a target count. */
export interface Chosen<Part> {
  parts: Part[];
  leftOut: (LeftOut & { part: Part })[];
  /** The numbers of those that a figure wears or carries, by their names; none if all are such. */
  accessories: number[];
  /** The numbers of those that patterns keep or exclude. */
  kept: number[];
  excluded: number[];
}

/** Whether a part of a target counts. @param isDrawn  Whether a viewer draws it, and it is no cage, marker, collision shape or backdrop. */
export type IsMeant = (part: number, isDrawn: boolean) => boolean;

/**
 * Chooses the parts of a target, or of a cage, that count.
 * @param lookOf   What is known of a part.
 * @param which  Patterns, or a function; drawn parts count by default, and those of `keep`. `cage`: the outer cages, or all if there are
 * none.
 * @param fail   Makes the error if parts are there, but none counts, or if a pattern names nothing.
 */
export function chooseParts<Part extends { name: string }>(
  parts: readonly Part[],
  lookOf: (part: Part) => Look,
  which: Parts | IsMeant | 'cage' = {},
  fail: (text: string) => Error,
): Chosen<Part> {
  const looks = parts.map(lookOf);
  const reasons = whyNotDrawn(looks);
  const patterns = typeof which === 'object' ? which : {};
  const drawn = [...parts.keys()].filter((p) => reasons[p] === undefined);
  const [ignored, kept, excluded] = kPartLists.map((list) => {
    const failed = (text: string) => fail(`parts.${list}: ${text}`);
    const numbered = (n: number): number[] => {
      if (drawn[n] !== undefined) return [drawn[n]];
      throw failed(`there is no part ${n}, only ${drawn.length}`);
    };
    const find = (part: PartOf) => (typeof part === 'number' ? numbered(part) : partsNamed(part, looks, failed));
    return new Set((patterns[list] ?? []).flatMap(find));
  }) as [Set<number>, Set<number>, Set<number>];
  const isAsked: IsMeant = (p, isDrawn) => !ignored.has(p) && (isDrawn || kept.has(p));
  const counts =
    which === 'cage' ? cageParts(looks.map(({ names }) => names)) : typeof which === 'function' ? which : isAsked;
  const isLeftOut = reasons.map((reason, p) => !counts(p, reason === undefined));
  const leftOut = parts.flatMap((part, p) =>
    isLeftOut[p] ? [{ part, name: part.name, why: reasons[p] ?? ('ignored' as const) }] : [],
  );
  const numbers = [...parts.keys()].filter((p) => !isLeftOut[p]);
  if (parts.length > 0 && numbers.length === 0)
    throw fail(
      `all parts are left out: ${leftOutText(leftOut)}${typeof which === 'object' ? '; name what counts in parts.keep' : ''}`,
    );
  const those = (fits: (p: number) => boolean) => numbers.flatMap((p, n) => (fits(p) ? [n] : []));
  return {
    parts: numbers.map((p) => parts[p]!),
    leftOut,
    accessories: accessoriesAmong(numbers.map((p) => looks[p]!.names)),
    kept: those((p) => kept.has(p)),
    excluded: those((p) => excluded.has(p)),
  };
}

/** How many parts a message names. */
const kMaxNamed = 8;

/** Says which parts are left out, and why. */
export function leftOutText(leftOut: readonly LeftOut[]): string {
  const more = leftOut.length - kMaxNamed;
  const named = leftOut.slice(0, kMaxNamed);
  const reasons = [...new Set(named.map(({ why }) => why))].map((reason) => {
    const names = named.flatMap(({ name, why }) => (why === reason ? show(name) : []));
    return `${names.join(', ')} (${kReasons[reason]})`;
  });
  return `${reasons.join(', ')}${more > 0 ? ` and ${more} more` : ''}`;
}

/** The numbers of parts that a figure wears or carries, by their names; none if all are such. */
export function accessoriesAmong(names: readonly (readonly (string | undefined)[])[]): number[] {
  const found = [...names.keys()].filter((p) => names[p]!.some(isAccessory));
  return found.length < names.length ? found : [];
}

/** The groups of which a cage leaves some name bare; none if those are all. */
export function groupsNamed(bare: readonly string[], names: readonly (readonly string[])[]): number[] {
  const isBare = names.map((own) => own.some((name) => bare.includes(name)));
  return isBare.includes(false) ? isBare.flatMap((is, group) => (is ? [group] : [])) : [];
}

/** Alpha less than this, or transmission more than that, can be looked through. */
const kAlpha = 0.85;
const kTransmission = 0.3;

/** What a part is called besides if its material can be looked through: corneas, visors, windows. Cages get holes over it. */
export const nameOfGlass = (mode = 'OPAQUE', alpha = 1, transmission = 0): string[] =>
  (mode === 'BLEND' && alpha < kAlpha) || transmission > kTransmission ? ['glass'] : [];

/** Whether the alpha of a material leaves nothing of a part, by the modes of glTF. */
export const isClear = (mode = 'OPAQUE', alpha = 1, cutoff = 0.5): boolean =>
  mode === 'BLEND' ? alpha <= 0 : mode === 'MASK' && alpha < cutoff;

/** The largest alpha of the colours of vertices, 4 numbers each; 1 without them. */
export function largestAlpha(colors: ArrayLike<number> | undefined): number {
  if (!colors) return 1;
  let most = 0;
  for (let i = 3; i < colors.length && most < 1; i += 4) most = Math.max(most, colors[i]!);
  return most;
}

function isAccessory(name: string | undefined): boolean {
  const words = name?.replace(/([a-z])([A-Z])/g, '$1 $2').match(/[a-z]+/gi) ?? [];
  return words.some((word) => kAccessories.test(word.toLowerCase()));
}

/** Why each part is not drawn, if it is not. */
function whyNotDrawn(looks: readonly Look[]): (LeftOut['why'] | undefined)[] {
  const all = new Set(looks.flatMap(({ names }) => names));
  const hasHelpers = [...all].some((name) => name !== undefined && kHelper.test(name));
  const isTechnical = (names: Look['names']): boolean => {
    const [node = ''] = names;
    const after = kShapeBefore.exec(node)?.[1];
    const models = [kShapeAfter.exec(node)?.[1], after, after?.replace(kNumber, '')];
    const isShape = models.some((model) => model !== undefined && all.has(model) && !names.includes(model));
    const isOne = (name: string) => kTechnical.some((some) => some.test(name)) || (hasHelpers && kJoint.test(name));
    return isShape || names.some((name) => name !== undefined && isOne(name));
  };
  const reasons = looks.map(({ names, isHidden, isClear }): LeftOut['why'] | undefined => {
    if (isTechnical(names)) return 'name';
    return isHidden ? 'hidden' : isClear ? 'transparent' : undefined;
  });
  const shapes = looks.map((look, p) => (reasons[p] === undefined ? shapeOf(look) : undefined));
  const seen = shapes.filter((shape) => shape !== undefined && !shape.isInward);
  shapes.forEach((shape, p) => {
    if (!shape?.isInward) return;
    // A lining of a car, or the inside of a mouth, is drawn: the inside of a shell is filled by what it is the outline of.
    const inside = seen.filter((one) => isWithin(one!.box, shape.box));
    const filled = inside.reduce((sum, one) => sum + one!.volume, 0);
    if (inside.length > 0 && filled >= kFilled * shape.volume) reasons[p] = 'outline';
  });
  const boxes = shapes.map((shape, p) => (reasons[p] === undefined ? shape?.box : undefined));
  const drawn = boxes.filter((box) => box !== undefined);
  const whole = drawn.reduce(around, kNowhere);
  const others = drawn.filter((box) => !isSheet(box, whole)).reduce(around, kNowhere);
  boxes.forEach((box, p) => {
    if (box && others !== kNowhere && isSheet(box, whole) && isBackdrop(box, others)) reasons[p] = 'backdrop';
  });
  return reasons;
}

/** How thick a ground or backdrop is at most, as a share of what stands before it, and by how much more it extends to the sides. */
const kThick = 0.1;
const kBeyond = 1.15;

/** The size of a box, and its diagonal. */
function sizeOf([low, high]: Box): { size: number[]; diagonal: number } {
  const size = low.map((x, k) => high[k]! - x);
  return { size, diagonal: Math.hypot(...size) };
}

/** Whether a part is flat, and large beside the whole. */
function isSheet(box: Box, whole: Box): boolean {
  const { size, diagonal } = sizeOf(box);
  return Math.min(...size) <= kThick * diagonal && 2 * diagonal > sizeOf(whole).diagonal;
}

const kNowhere: Box = [
  [Infinity, Infinity, Infinity],
  [-Infinity, -Infinity, -Infinity],
];

const around = ([low, high]: Box, [otherLow, otherHigh]: Box): Box => [
  low.map((x, k) => Math.min(x, otherLow[k]!)),
  high.map((x, k) => Math.max(x, otherHigh[k]!)),
];

/** Whether a part is a ground under, or a wall beside, what the others are: flat, outside, wider, and not above their foot. As `Foreground` in C++. */
function isBackdrop(box: Box, others: Box): boolean {
  const [[low, high], [otherLow, otherHigh]] = [box, others];
  const [{ size }, { size: otherSize }] = [sizeOf(box), sizeOf(others)];
  return [0, 1, 2].some((axis) => {
    const thick = kThick * otherSize[axis]!;
    const isOutside = high[axis]! <= otherLow[axis]! + thick || (axis !== 1 && low[axis]! >= otherHigh[axis]! - thick);
    const isWider = [0, 1, 2].every((k) => k === axis || size[k]! > kBeyond * otherSize[k]!);
    const isStanding = axis === 1 || low[1]! <= otherLow[1]! + kThick * otherSize[1]!;
    return size[axis]! <= thick && isOutside && isWider && isStanding;
  });
}

/** The share of its volume from which a shell is an outline of what is in it. */
const kFilled = 0.5;

type Box = readonly [low: number[], high: number[]];

const isWithin = ([low, high]: Box, [outerLow, outerHigh]: Box): boolean =>
  low.every((x, k) => x >= outerLow[k]!) && high.every((x, k) => x <= outerHigh[k]!);

/** What a part encloses, in the scene's space, and whether only its inside is drawn. */
function shapeOf({ positions, indices, sides, matrix }: Look): { volume: number; isInward: boolean; box: Box } {
  const volume = enclosed(positions, indices);
  const box: Box = [
    [Infinity, Infinity, Infinity],
    [-Infinity, -Infinity, -Infinity],
  ];
  const points = movePoints(matrix, positions, new Float32Array(positions.length));
  points.forEach((x, i) => {
    box[0][i % 3] = Math.min(box[0][i % 3]!, x);
    box[1][i % 3] = Math.max(box[1][i % 3]!, x);
  });
  const isInward = sides === 'front' ? volume < 0 : sides === 'back' && volume > 0;
  return { volume: Math.abs(volume * determinant(matrix)), isInward, box };
}

/** The volume that triangles enclose, negative if they are wound inward; of open ones, as seen from the mean of their vertices. */
function enclosed(positions: ArrayLike<number>, indices: ArrayLike<number> | undefined): number {
  const count = positions.length / 3;
  const mean = [0, 0, 0];
  for (let i = 0; i < positions.length; ++i) mean[i % 3]! += positions[i]! / count;
  let volume = 0;
  const corners = indices?.length ?? count;
  const at = (corner: number, k: number) => positions[3 * (indices?.[corner] ?? corner) + k]! - mean[k]!;
  for (let i = 0; i + 2 < corners; i += 3) {
    const [ax, ay, az] = [at(i, 0), at(i, 1), at(i, 2)];
    const [bx, by, bz] = [at(i + 1, 0), at(i + 1, 1), at(i + 1, 2)];
    const [cx, cy, cz] = [at(i + 2, 0), at(i + 2, 1), at(i + 2, 2)];
    volume += (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6;
  }
  return volume;
}
