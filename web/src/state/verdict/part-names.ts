import type { SegmentStats } from 'cagecast';
import type { Shown } from '../scene';

/** What parts of avatars, animals and cars are, by words in the names of their meshes and materials. */
const kKinds: readonly (readonly [name: string, words: RegExp])[] = [
  ['eyes', /eye(?! ?(brow|lash|lid|wear|glass))|iris|cornea|sclera|pupil/],
  ['teeth', /teeth|tooth|denture|gums?\b/],
  ['tongue', /tongue/],
  ['mouth', /mouth|oral/],
  ['beard', /beard|moustache|mustache/],
  ['hair', /hair|\bfur\b|mane/],
  ['brows', /brow/],
  ['lashes', /lash/],
  ['glasses', /glasses|eye ?wear|goggles/],
  ['hat', /\bhat\b|headwear|helmet|\bcap\b/],
  ['shoes', /shoe|boot|footwear|sneaker/],
  ['clothes', /outfit|cloth|shirt|pants|trouser|jeans|\btops?\b|\bbottoms?\b|dress|skirt|jacket|onepiece|uniform/],
  ['windows', /windows?|windshield|windscreen|\bglass\b/],
  ['wheels', /wheel|\btyres?\b|\btires?\b|\brims?\b/],
  ['seats', /seat|interior|dashboard|steering/],
  ['lights', /lights?\b|lamps?\b/],
];

/** A name as words: `Wolf3D_Teeth` is "wolf3d teeth". */
const spaced = (name: string): string =>
  name
    .replace(/([a-z])([A-Z])/g, '$1 $2')
    .replace(/[_.\-\s]+/g, ' ')
    .toLowerCase();

/** What a part is by the names of its material or its mesh, such as "teeth"; undefined if they do not tell. */
function kindOf(names: readonly string[]): string | undefined {
  return names.map((name) => kKinds.find(([, words]) => words.test(spaced(name)))?.[0]).find(Boolean);
}

type Primitives = Shown['target']['mesh']['primitives'];

/** The plain name of one of a model's primitives; the name in the file if that does not tell what it is. */
export function plainNameOf({ name, mesh }: Primitives[number]): string {
  const materials = [mesh?.material ?? []].flat().map(({ name }) => name);
  return kindOf([...materials, name]) ?? name;
}

/** At least this share of what is seen of a part is painted, or the part is said to be bare. */
const kPainted = 0.5;

/** The plain names of the bare parts, without those beyond the cage or left out; known ones first. */
export function bareParts(
  { target, projection }: Shown,
  stats: readonly Pick<SegmentStats, 'group' | 'area' | 'exposedArea' | 'coveredArea' | 'beyondArea' | 'culled'>[],
): string[] {
  const names = target.mesh.primitives.flatMap((primitive, group) => {
    if (projection.leftOut.includes(group)) return [];
    let [exposed, painted, beyond, area] = [0, 0, 0, 0];
    for (const one of stats) {
      if (one.group !== group) continue;
      area += one.area;
      beyond += one.beyondArea;
      exposed += one.exposedArea;
      if (!one.culled) painted += one.coveredArea;
    }
    const isMeant = area > 0 && beyond < area / 2;
    return isMeant && painted <= kPainted * exposed ? [plainNameOf(primitive)] : [];
  });
  const known = kKinds.map(([name]) => name);
  const rank = (name: string): number => (known.indexOf(name) + known.length + 1) % (known.length + 1);
  return [...new Set(names)].sort((a, b) => rank(a) - rank(b));
}
