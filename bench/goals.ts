import type { Results } from './results.js';
import { sizes } from './scenes.js';
import { exponent } from './statistics.js';

/** Something the benchmark is to show, and what it showed. */
export interface Goal {
  what: string;
  /** What was measured; undefined if that part was not run. */
  value: number | undefined;
  limit: number;
  kind: 'at most' | 'at least';
  unit: string;
  /** For times: what Embree took at 4.8k in the same run, in ms. */
  embree?: number | undefined;
}

/** An estimate: Cortex-A73, in the phone-class tablets of 2020, at 2.3 GHz and one instruction per cycle. */
export const phone = { name: 'Cortex-A73 at 2.3 GHz', instructionsPerSecond: 2.3e9 };

/** What Embree took at 4.8k, in milliseconds, where the goals in milliseconds were set: these are about the processor as well. */
export const embreeWhereSet = 1.9;

/** What the speed of the product is held against. */
export function goalsOf({ native, shuffled, web, presets, mobile, size }: Results): Goal[] {
  const ratio = (scene: string, peer: string, stage: 'total' | 'project' | 'occluded'): number | undefined =>
    native?.[scene]?.peers[peer]?.ratios[stage];
  const total = (scene: string): number | undefined => native?.[scene]?.cagecast.total.median;
  const peak = (scene: string): number | undefined => native?.[scene]?.peakBytes;
  const perTriangle = (scene: string): number | undefined =>
    native?.[scene] ? native[scene].peakBytes / native[scene].triangles : undefined;
  const fixed = [
    ['4.8k', sizes[1]!],
    ['50k-fixed-cage', sizes[2]!],
    ['500k-fixed-cage', sizes[3]!],
    ['2M-fixed-cage', sizes[4]!],
  ] as const;
  const times = fixed.flatMap(([scene, triangles]) =>
    total(scene) === undefined ? [] : [[triangles, total(scene)!] as const],
  );
  const atMost = (what: string, value: number | undefined, limit: number, unit = '', embree?: number): Goal => ({
    what,
    value,
    limit,
    kind: 'at most',
    unit,
    embree,
  });
  const atLeast = (what: string, value: number | undefined, limit: number, unit = ''): Goal => ({
    what,
    value,
    limit,
    kind: 'at least',
    unit,
  });
  const besideSlowed = mobile?.embree?.['4'];
  const scaled = (value: number | undefined, by: number): number | undefined =>
    value === undefined ? undefined : value * by;
  return [
    atMost('native ÷ Embree, 4.8k', ratio('4.8k', 'embree', 'total'), 0.4, '×'),
    atMost('native ÷ Embree, 500k', ratio('500k', 'embree', 'total'), 0.35, '×'),
    atMost('nearest ÷ Embree’s, 4.8k', ratio('4.8k', 'embree', 'project'), 0.25, '×'),
    atMost('self rays ÷ Embree’s, 4.8k', ratio('4.8k', 'embree', 'occluded'), 0.85, '×'),
    atLeast('three-mesh-bvh ÷ WASM, Chromium, 4.8k', web?.chromium['4.8k']?.peer?.ratio, 14, '×'),
    atLeast('three-mesh-bvh ÷ WASM, Chromium, 50k', web?.chromium['50k']?.peer?.ratio, 12, '×'),
    atLeast('native Embree ÷ WASM in Chromium, 4.8k', web?.againstNativeEmbree.ratio, 1.7, '×'),
    atMost('native ÷ nanoflann (nearest vertex, nothing filtered), 4.8k', ratio('4.8k', 'nanoflann', 'total'), 2, '×'),
    atMost('preset `default` without UVs per corner ÷ `paper`, 4.8k', presets?.['4.8k']?.ratio, 1.8, '×'),
    atMost(
      'UVs per corner on top, cage of one island, 4.8k',
      presets?.['4.8k'] && presets['4.8k'].default.corner - presets['4.8k'].default.vertex,
      0.3,
      'ms',
      presets?.['4.8k']?.embree,
    ),
    atMost('instructions on aarch64, 4.8k', scaled(mobile?.aarch64.perRun, 1e-6), 7, 'M'),
    atMost('instructions on x86-64, 4.8k', scaled(mobile?.x86_64.perRun, 1e-6), 8, 'M'),
    atMost(
      'scaling exponent with a fixed cage, 4.8k to 2M',
      times.length === fixed.length ? exponent(times) : undefined,
      1.05,
    ),
    atMost('shuffled ÷ ordered input, 500k', shuffled, 1.3, '×'),
    atMost('memory above the inputs, 4.8k', scaled(peak('4.8k'), 1e-6), 0.9, 'MB'),
    atMost('memory above the inputs, 2M, per triangle', perTriangle('2M'), 150, 'B'),
    atMost('memory above the inputs, 2M with a fixed cage, per triangle', perTriangle('2M-fixed-cage'), 150, 'B'),
    atMost('WASM heap, 4.8k', scaled(mobile?.firstUse['1']?.heapLater, 1e-6), 4, 'MB'),
    atMost('Chromium slowed 4×, warm, 4.8k', mobile?.warm['4']?.median, 5, 'ms', besideSlowed),
    atMost(
      'Chromium slowed 4×, first use in a fresh browser at rest, `default`, 4.8k',
      mobile?.firstUseAtRest?.['4']?.total,
      60,
      'ms',
      besideSlowed,
    ),
    atMost(
      'Chromium slowed 4×, first use in a fresh browser at rest, `paper`, 4.8k',
      mobile?.firstUseOfPaper?.['4']?.total,
      60,
      'ms',
      besideSlowed,
    ),
    atMost('cagecast.wasm, gzipped', scaled(size?.['cagecast.wasm']?.gz, 1e-3), 40, 'KB'),
    atMost(
      'the package’s entry, WASM inlined, gzipped',
      scaled(size?.['cagecast (wasm, glue and API in one)']?.gz, 1e-3),
      60,
      'KB',
    ),
  ];
}

/** Whether the goal is reached; undefined if it was not measured. */
export function isReached({ value, limit, kind }: Goal): boolean | undefined {
  return value === undefined ? undefined : kind === 'at most' ? value <= limit : value >= limit;
}
