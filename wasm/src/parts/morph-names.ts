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
