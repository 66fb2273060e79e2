import type { Results } from './results.js';
import { sizes } from './scenes.js';
import type { sizedFiles } from './size.js';
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

type Limit = (what: string, value: number | undefined, limit: number, unit?: string, embree?: number) => Goal;
const goal =
  (kind: Goal['kind']): Limit =>
  (what, value, limit, unit = '', embree) => ({ what, value, limit, kind, unit, embree });
const atMost = goal('at most');
const atLeast = goal('at least');
const scaled = (value: number | undefined, by: number): number | undefined =>
  value === undefined ? undefined : value * by;

/** What the speed and the size of the product are held against. */
export function goalsOf(results: Results): Goal[] {
  return [...nativeGoals(results), ...webGoals(results), ...sizeGoals(results)];
}

function nativeGoals({ native, shuffled, presets, mobile }: Results): Goal[] {
  const ratio = (scene: string, peer: string, stage: 'total' | 'project' | 'occluded'): number | undefined =>
    native?.[scene]?.peers[peer]?.ratios[stage];
  const perTriangle = (scene: string): number | undefined =>
    native?.[scene] ? native[scene].peakBytes / native[scene].triangles : undefined;
  const sample = presets?.['4.8k'];
  return [
    atMost('native ÷ Embree, 4.8k', ratio('4.8k', 'embree', 'total'), 0.32, '×'),
    atMost('native ÷ Embree, 500k', ratio('500k', 'embree', 'total'), 0.27, '×'),
    atMost('nearest ÷ Embree’s, 4.8k', ratio('4.8k', 'embree', 'project'), 0.25, '×'),
    atMost('self rays ÷ Embree’s, 4.8k', ratio('4.8k', 'embree', 'occluded'), 0.85, '×'),
    atMost('native ÷ nanoflann (nearest vertex, nothing filtered), 4.8k', ratio('4.8k', 'nanoflann', 'total'), 2, '×'),
    atMost('preset `default` without UVs per corner ÷ `paper`, 4.8k', sample?.ratio, 1.8, '×'),
    atMost(
      'UVs per corner on top, cage of one UV chart, 4.8k',
      sample && sample.default.corner - sample.default.vertex,
      0.3,
      'ms',
      sample?.embree,
    ),
    atMost('instructions on aarch64, 4.8k', scaled(mobile?.aarch64.perRun, 1e-6), 7.6, 'M'),
    atMost('instructions on x86-64, 4.8k', scaled(mobile?.x86_64.perRun, 1e-6), 8, 'M'),
    atMost('scaling exponent with a fixed cage, 4.8k to 2M', scalingExponent(native), 1.05),
    atMost('shuffled ÷ ordered input, 500k', shuffled, 1.3, '×'),
    atMost('memory above the inputs, 4.8k', scaled(native?.['4.8k']?.peakBytes, 1e-6), 1, 'MB'),
    atMost('memory above the inputs, 2M, per triangle', perTriangle('2M'), 150, 'B'),
    atMost('memory above the inputs, 2M with a fixed cage, per triangle', perTriangle('2M-fixed-cage'), 150, 'B'),
  ];
}

/** By which power of the number of triangles the time grows; undefined if a size was not measured. */
function scalingExponent(native: Results['native']): number | undefined {
  const fixed = ['4.8k', '50k-fixed-cage', '500k-fixed-cage', '2M-fixed-cage'];
  const times = fixed.flatMap((scene, i) => {
    const total = native?.[scene]?.cagecast.total.median;
    return total === undefined ? [] : [[sizes[i + 1]!, total] as const];
  });
  return times.length === fixed.length ? exponent(times) : undefined;
}

function webGoals({ web, mobile }: Results): Goal[] {
  const embree = mobile?.embree?.['4'];
  const firstUse = 'Chromium slowed 4×, first use in a fresh browser at rest';
  return [
    atLeast('three-mesh-bvh ÷ WASM, Chromium, 4.8k', web?.chromium['4.8k']?.peer?.ratio, 12, '×'),
    atLeast('three-mesh-bvh ÷ WASM, Chromium, 50k', web?.chromium['50k']?.peer?.ratio, 12, '×'),
    atLeast('native Embree ÷ WASM in Chromium, 4.8k', web?.againstNativeEmbree.ratio, 1.7, '×'),
    atMost('Chromium slowed 4×, warm, 4.8k', mobile?.warm['4']?.median, 5, 'ms', embree),
    atMost(`${firstUse}, \`default\`, 4.8k`, mobile?.firstUseAtRest?.['4']?.total, 80, 'ms', embree),
    atMost(`${firstUse}, \`paper\`, 4.8k`, mobile?.firstUseOfPaper?.['4']?.total, 80, 'ms', embree),
    atMost('WASM heap, 4.8k', scaled(mobile?.firstUse['1']?.heapLater, 1e-6), 4, 'MB'),
  ];
}

function sizeGoals({ size }: Results): Goal[] {
  const gz = (name: keyof typeof sizedFiles): number | undefined => scaled(size?.[name]?.gz, 1e-3);
  return [atMost('the package’s entry, WASM inlined, gzipped', gz('cagecast (WebAssembly inlined)'), 80, 'KB')];
}

/** Whether the goal is reached; undefined if it was not measured. */
export function isReached({ value, limit, kind }: Goal): boolean | undefined {
  return value === undefined ? undefined : kind === 'at most' ? value <= limit : value >= limit;
}
