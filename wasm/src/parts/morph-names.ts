import type { VrmExtensions } from './joints.js';

/** What a morph target does to a face, as far as its name says. */
export type FaceMotion = 'closesEyes' | 'opensMouth' | 'narrowsMouth';

/**
 * The names, as `plain` makes them: of ARKit (`eyeBlinkLeft`), Oculus (`viseme_aa`), VRM 0 and 1 (`blink_l`, `ou`), VRoid
 * (`Fcl_EYE_Close_L`, `Fcl_MTH_A`) and MMD, and what contains such words. The first that fits counts.
 */
const kNames: readonly (readonly [FaceMotion, RegExp])[] = [
  ['closesEyes', /blink|wink|eyes?close|closeeye|まばたき|瞬き|ウィンク|ウインク/],
  ['narrowsMouth', /pucker|funnel|whistle/],
  ['opensMouth', /jawopen|mouthopen|openmouth|viseme|vrcv|fclmth[aiueo]$|^(aa|ih|ou|ee|oh|[aiueoあいうえお])$/],
];

/** Parts by whose motion no mouth is found: what is in it, or hangs over it. */
const kNoLips = /teeth|tooth|tongue|gum|beard|mous?tache|hair|lash|brow|eye/i;

/** Case, separators and half-width forms vary with the exporter. */
const plain = (name: string): string =>
  name
    .normalize('NFKC')
    .toLowerCase()
    .replace(/[^\p{L}\p{N}]/gu, '');

/** A pose that a face is seen in, and how its morph targets are called, as `plain` has it: what is best comes first. */
const kPoses: readonly (readonly RegExp[])[] = [
  [/blink/, /eyes?close|closeeye/, /まばたき|瞬き/, /wink|ウィンク|ウインク/],
  [/jawopen/, /mouthopen|openmouth/, /aa$|fclmtha$|^[aあ]$/],
  [/mouthsmile|fclmth(joy|fun)/, /^(?!.*eye).*smile/, /^(joy|happy|fun)$|にっこり/],
];
/** A target of one side only. A Japanese wink without a side is one of the left eye. */
const kLeft = /left|左|l$|^(ウィンク|ウインク)2?$/;
const kRight = /right|右|r$/;

/**
 * The morph targets that make the poses of a face: a blink of both eyes, an open mouth, a smile.
 * @param targets  All targets of a model, with their names. Those of one name are one, on several parts.
 * @returns for each pose that the names know, the numbers of its targets.
 */
export function poseTargets(targets: readonly (readonly unknown[])[]): number[][] {
  const names = targets.map((all) => all.filter((name) => typeof name === 'string').map(plain));
  const first = (fits: (name: string) => boolean) => names.flat().find(fits);
  const find = (pattern: RegExp) => {
    const isOf = (side: RegExp) => (name: string) => pattern.test(name) && side.test(name);
    const both = first((name) => pattern.test(name) && !kLeft.test(name) && !kRight.test(name));
    return (both === undefined ? [kLeft, kRight].map((side) => first(isOf(side))) : [both]).filter((one) => one);
  };
  return kPoses.flatMap((patterns) => {
    const chosen = patterns.map(find).find((found) => found.length > 0);
    return chosen ? [[...names.keys()].filter((t) => names[t]!.some((name) => chosen.includes(name)))] : [];
  });
}

/** What a morph target of one of some names does to a face; `undefined` if none says so. */
export function motionOf(names: readonly unknown[]): FaceMotion | undefined {
  const all = names.filter((name) => typeof name === 'string').map(plain);
  return kNames.find(([, pattern]) => all.some((name) => pattern.test(name)))?.[0];
}

/** Whether a part with these names may have lips. */
export const mayHaveLips = (names: readonly string[]): boolean => !names.some((name) => kNoLips.test(name));

/** The names of the expressions of a VRM that use a morph target, given the numbers of its node and mesh. */
export type Expressions = (node: number | undefined, mesh: number | undefined, target: number) => string[];

/** The expressions of a VRM; of none if it is none, or is damaged. */
export function vrmExpressions(extensions: VrmExtensions | undefined): Expressions {
  const names = new Map<string, string[]>();
  const add = (binds: unknown, place: 'node' | 'mesh', ...called: unknown[]) => {
    if (!Array.isArray(binds)) return;
    const texts = called.filter((name) => typeof name === 'string');
    for (const bind of binds) {
      const key = `${place} ${bind?.[place]} ${bind?.index}`;
      names.set(key, [...(names.get(key) ?? []), ...texts]);
    }
  };
  const before = (extensions?.VRM as Vrm0 | undefined)?.blendShapeMaster?.blendShapeGroups;
  if (Array.isArray(before)) for (const group of before) add(group?.binds, 'mesh', group?.presetName, group?.name);
  const { preset, custom } = (extensions?.VRMC_vrm as Vrm1 | undefined)?.expressions ?? {};
  for (const [name, expression] of Object.entries({ ...preset, ...custom }))
    add(expression?.morphTargetBinds, 'node', name);
  return (node, mesh, target) =>
    [`node ${node} ${target}`, `mesh ${mesh} ${target}`].flatMap((k) => names.get(k) ?? []);
}

interface Vrm0 {
  blendShapeMaster?: { blendShapeGroups?: ({ presetName?: unknown; name?: unknown; binds?: unknown } | null)[] };
}
type Vrm1Expressions = Record<string, { morphTargetBinds?: unknown } | null>;
interface Vrm1 {
  expressions?: { preset?: Vrm1Expressions; custom?: Vrm1Expressions };
}
