import { mkdir, readFile, writeFile } from 'node:fs/promises';
import type { InstructionCount, Preset, WasmCount } from './instructions.js';
import { type NativeResult, root, type Spread, type StageOfDefault } from './native.js';
import type { RaceResult } from './race.js';
import type { Size } from './size.js';
import type { FirstUse } from './web/first-page.js';

/** Everything that one run of the benchmark found out. Parts that were not run are missing. */
export interface Results {
  date: string;
  machine: { processor: string; cores: number; node: string; compiler?: string; chromium?: string };
  /** By scene. */
  native?: Record<string, NativeResult>;
  /** Of half a million triangles: the time of shuffled input ÷ that of ordered input, both in turn; the median over turns. */
  shuffled?: number;
  web?: {
    node: Record<string, RaceResult>;
    chromium: Record<string, RaceResult>;
    /** Chromium against native Embree, both pinned to one core; the ratio is Embree's time ÷ the package's. */
    againstNativeEmbree: { ratio: number; cagecast: number; embree: number };
  };
  /** What the preset `default` costs, by scene. */
  presets?: Record<string, PresetCost>;
  mobile?: {
    aarch64: InstructionCount & { sameAnswer: boolean };
    x86_64: InstructionCount;
    /** In Node, on this machine's kind of processor. */
    wasm?: Record<Preset, WasmCount>;
    /** By how many times Chromium is slowed down; ms of wall time. */
    warm: Record<string, Spread>;
    /** With `default`, in a browser that was just started, and is still busy with that. */
    firstUse: Record<string, FirstUse>;
    /** In a new browser that has come to rest. */
    firstUseAtRest?: Record<string, FirstUse>;
    /** The same with `paper`. */
    firstUseOfPaper?: Record<string, FirstUse>;
    /** What native Embree takes between these, not slowed, in ms of CPU time. */
    embree?: Record<string, number>;
  };
  size?: Record<string, Size>;
}

/** What the preset `default` costs natively, with and without UVs per corner; all three in turn, times in ms. */
export interface PresetCost {
  triangles: number;
  cageTriangles: number;
  /** How many pieces the cage's texture is in. */
  charts: number;
  paper: number;
  default: Record<'vertex' | 'corner', number>;
  /** Of the one without UVs per corner ÷ `paper`: the median over pairs of runs. */
  ratio: number;
  /** What only the preset `default` does. */
  stages: Record<StageOfDefault, number>;
  /** What Embree takes for `paper`, in turn with these. */
  embree?: number;
}

/** Where results are kept; the plots and the table always show the newest. */
export const resultsFolder = `${root}bench/results`;

/** Reads the results of a day; undefined if there are none. */
export async function readResults(date: string): Promise<Results | undefined> {
  const text = await readFile(`${resultsFolder}/${date}.json`, 'utf8').catch(() => undefined);
  return text === undefined ? undefined : (JSON.parse(text) as Results);
}

export async function writeResults(results: Results): Promise<void> {
  await mkdir(resultsFolder, { recursive: true });
  // Six digits are more than any of these times is good for.
  const text = JSON.stringify(
    results,
    (_, value: unknown) =>
      typeof value === 'number' && !Number.isInteger(value) ? Number(value.toPrecision(6)) : value,
    1,
  );
  await writeFile(`${resultsFolder}/${results.date}.json`, `${text}\n`);
}
