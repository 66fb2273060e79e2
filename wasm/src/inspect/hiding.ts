import { type TransferOptions, transfer } from '../api/index.js';
import { type Finding, percent } from './finding.js';
import { partsOf, type Scene } from './scene.js';

/** The share of the rest from which on a part that hides it is a finding. */
const kMuchHidden = 1 / 3;
/** How large the rest has to be, as a share of the part that hides it: a skin hides teeth and tongue, as it should. */
const kMinRest = 0.5;
/** How many parts are tried at most, the largest first: each costs a transfer. */
const kMaxTried = 2;
/** From this share on, the main piece of a part is hardly seen. */
const kHardlySeen = 2 / 3;
/** How large it is at least, as a share of the whole. */
const kMinMain = 0.1;

/**
 * Reports a part without which much more of the rest could be painted: a visor, a force field, another outfit. Of parts, also pieces
 * around the main one: shells that clothes are made from. No cost unless much of the target is hidden.
 * @param options  Of the transfer.
 */
export function checkHiding(scene: Scene, options: TransferOptions): Finding[] {
  const { parts, areas, result } = scene;
  const partOf = partsOf(parts, areas.length);
  const [total, hidden] = [new Float64Array(parts.length), new Float64Array(parts.length)];
  areas.forEach((area, v) => {
    total[partOf[v]!]! += area;
    if (result.zones[v] === 1) hidden[partOf[v]!]! += area;
  });
  const [all, allHidden] = [total, hidden].map((of) => of.reduce((sum, area) => sum + area, 0)) as [number, number];
  const isSuspect = (p: number) =>
    hidden[p]! < total[p]! / 2 &&
    allHidden - hidden[p]! > Math.max(kMuchHidden * (all - total[p]!), kMinRest * total[p]!);
  const suspects = [...parts.keys()].filter(isSuspect).sort((a, b) => total[b]! - total[a]!);
  const found = suspects.slice(0, kMaxTried).flatMap((p): Finding[] => {
    const freed = freedBy(scene, options, (v) => partOf[v] === p);
    const share = freed / (all - total[p]!);
    if (share <= kMuchHidden || freed <= kMinRest * total[p]!) return [];
    const { name } = parts[p]!;
    return [
      {
        code: 'muchHidden',
        weight: 0.5,
        sentence: `"${name}" hides ${percent(share)} of the rest, which could be painted without it`,
        advice: 'If it is a visor, a shell or another outfit, leave it out.',
        numbers: { share },
        ignore: [name],
      },
    ];
  });
  return found.length > 0 ? found : checkPieces(scene, partOf, options);
}

/** The area that could be painted without some vertices. */
function freedBy(
  { cage, target, areas, result }: Scene,
  options: TransferOptions,
  isIt: (v: number) => boolean,
): number {
  // Segments have other numbers without them, and triangles too.
  const { masks: _, locks: __, ...rules } = options;
  const indices = Uint32Array.from(target.indices).filter((_, i, all) => !isIt(all[i - (i % 3)]!));
  const { zones } = transfer(cage, { ...target, indices }, rules);
  return areas.reduce((sum, area, v) => sum + (!isIt(v) && result.zones[v] !== 0 && zones[v] === 0 ? area : 0), 0);
}

/** Reports a part whose main piece, the one of the most points, is hidden by its other pieces. */
function checkPieces(scene: Scene, partOf: Uint32Array, options: TransferOptions): Finding[] {
  const { parts, areas, result } = scene;
  const { segments, segmentStats, zones } = result;
  const main = new Map<number, number>();
  segments.forEach((segment, v) => {
    const known = main.get(partOf[v]!) ?? segment;
    main.set(partOf[v]!, segmentStats[segment]!.points > segmentStats[known]!.points ? segment : known);
  });
  const hidden = new Float64Array(segmentStats.length);
  areas.forEach((area, v) => (hidden[segments[v]!]! += zones[v] === 1 ? area : 0));
  const whole = areas.reduce((sum, area) => sum + area, 0);
  const isSuspect = (segment: number) =>
    hidden[segment]! > Math.max(kHardlySeen * segmentStats[segment]!.area, kMinMain * whole);
  return [...main]
    .filter(([, segment]) => isSuspect(segment))
    .sort(([, a], [, b]) => hidden[b]! - hidden[a]!)
    .slice(0, kMaxTried)
    .flatMap(([p, segment]): Finding[] => {
      const isOther = (v: number) => partOf[v] === p && segments[v] !== segment;
      const freed = freedBy(scene, options, isOther);
      const share = freed / segmentStats[segment]!.area;
      if (share <= kHardlySeen) return [];
      const { name } = parts[p]!;
      return [
        {
          code: 'muchHidden',
          weight: 0.5,
          sentence: `Loose pieces of "${name}" hide ${percent(share)} of its main piece, which could be painted without them`,
          advice:
            'If they are helpers that nobody should see, delete them in the file, or make them a part of their own.',
          numbers: { share },
          places: [{ segment, group: segmentStats[segment]!.group, part: name }],
        },
      ];
    });
}
