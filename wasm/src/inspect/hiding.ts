import { type TransferOptions, transfer } from '../api/index.js';
import { type Finding, percent } from './finding.js';
import { partsOf, type Scene } from './scene.js';

/** The share of the rest from which on a part that hides it is a finding. */
const kMuchHidden = 1 / 3;
/** How large the rest has to be, as a share of the part that hides it: a skin hides teeth and tongue, as it should. */
const kMinRest = 0.5;
/** How many parts are tried at most, the largest first: each costs a transfer. */
const kMaxTried = 2;

/**
 * Reports a part without which much more of the rest could be painted: a visor, a force field, another outfit. No cost unless much
 * of the target is hidden.
 * @param options  Of the transfer.
 */
export function checkHiding({ cage, target, parts, areas, result }: Scene, options: TransferOptions): Finding[] {
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
  // Segments have other numbers without a part, and triangles too.
  const { masks: _, locks: __, ...rules } = options;
  return suspects.slice(0, kMaxTried).flatMap((p): Finding[] => {
    const isOther = (_: number, i: number) => partOf[target.indices[i - (i % 3)]!] !== p;
    const { zones } = transfer(cage, { ...target, indices: Uint32Array.from(target.indices).filter(isOther) }, rules);
    let freed = 0;
    for (let v = 0; v < areas.length; ++v)
      if (partOf[v] !== p && result.zones[v] !== 0 && zones[v] === 0) freed += areas[v]!;
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
}
