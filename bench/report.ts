import { writeFile } from 'node:fs/promises';
import { embreeWhereSet, type Goal, goalsOf, isReached, phone } from './goals.js';
import type { Preset, WasmCount } from './instructions.js';
import { stages, stagesOfDefault } from './native.js';
import { scalingPlot, stagesPlot, totalsPlot } from './plots.js';
import { type Results, resultsFolder } from './results.js';
import { table } from './table.js';
import type { FirstUse } from './web/first-page.js';

const ms = (value: number | undefined): string =>
  value === undefined
    ? '–'
    : value >= 100
      ? value.toFixed(0)
      : value >= 10
        ? value.toFixed(1)
        : value.toFixed(value < 0.1 ? 3 : 2);
const times = (value: number | undefined): string =>
  value === undefined ? '–' : `${value >= 10 ? value.toFixed(1) : value.toFixed(2)}×`;

function inWasm({ paper, default: preset }: Record<Preset, WasmCount>, node: string): string {
  const million = (count: number): string => `${(count / 1e6).toFixed(1)} M`;
  return `In WebAssembly, in Node ${node}, optimised: ${million(paper.optimised)}, with \`default\` ${million(preset.optimised)}; the first of all, compiled as it goes and not optimised: ${million(paper.first)} and ${million(preset.first)}.`;
}

/** Writes the table and the plots of results, over those of earlier ones. */
export async function writeReport(results: Results): Promise<void> {
  await writeFile(`${resultsFolder}/README.md`, markdown(results));
  if (results.native === undefined) return;
  await writeFile(`${resultsFolder}/totals.svg`, totalsPlot(results));
  await writeFile(`${resultsFolder}/stages.svg`, stagesPlot(results));
  await writeFile(`${resultsFolder}/scaling.svg`, scalingPlot(results));
}

/** What the goals in milliseconds come to on the processor that they were set on, if all goes as Embree does. */
function inProportion(goals: readonly Goal[]): string[] {
  const each = goals.flatMap(({ what, value, limit, embree }) =>
    value === undefined || embree === undefined
      ? []
      : [`${what}: ${ms((value * embreeWhereSet) / embree)} (${limit}; Embree ${ms(embree)})`],
  );
  return each.length === 0
    ? []
    : [
        `Goals in milliseconds were set where Embree takes ${ms(embreeWhereSet)} ms at 4.8k. In proportion to what it took here, in the same run: ${each.join('; ')}.`,
      ];
}

/** Where Embree's answer differs, scene by scene. */
function otherZones(native: NonNullable<Results['native']>): string {
  const some = Object.entries(native).flatMap(([scene, { peers, vertices }]) => {
    const count = peers['embree']?.otherZones ?? 0;
    return count > 0 ? [`${count} of ${vertices} vertices (${scene})`] : [];
  });
  return some.length > 0 ? some.join(', ') : 'no vertex';
}

/** What was reached of the goals. */
function ofGoals(results: Results): string[] {
  const goals = goalsOf(results);
  return [
    '## Goals',
    table(
      ['', 'measured', 'goal', ''],
      goals.map((goal) => {
        const reached = isReached(goal);
        const unit = goal.unit === '×' ? '×' : goal.unit && ` ${goal.unit}`;
        return [
          goal.what,
          goal.value === undefined ? 'not measured' : `${ms(goal.value)}${unit}`,
          `${goal.kind} ${goal.limit}${unit}`,
          reached === undefined ? '' : reached ? 'yes' : 'no',
        ];
      }),
    ),
    ...inProportion(goals),
  ];
}

/** Natively, scene by scene, and step by step at 4.8k. */
function inNative(native: Results['native']): string[] {
  if (!native) return [];
  const parts: string[] = [];
  parts.push(
    '## Native',
    table(
      [
        'scene',
        'triangles',
        'cage',
        'Cagecast',
        'Embree',
        'ratio',
        'nanoflann',
        'ratio',
        'MB above inputs',
        'B/triangle',
      ],
      Object.entries(native).map(([scene, r]) => [
        scene,
        String(r.triangles),
        String(r.cageTriangles),
        ms(r.cagecast.total.median),
        ms(r.peers['embree']?.times.total.median),
        times(r.peers['embree']?.ratios.total),
        ms(r.peers['nanoflann']?.times.total.median),
        times(r.peers['nanoflann']?.ratios.total),
        (r.peakBytes / 1e6).toFixed(2),
        (r.peakBytes / r.triangles).toFixed(0),
      ]),
    ),
    `Embree 3.13 is used in the way that is fastest for this task (bench/native/embree_peer.cpp says what was tried). It computes the same zones, except at ${otherZones(native)}, because it decides in float. nanoflann finds the nearest cage *vertex* and filters nothing.`,
  );
  const sample = native['4.8k'];
  const embree = sample?.peers['embree'];
  if (sample) {
    parts.push(
      table(
        ['4.8k, step by step', 'Cagecast', 'min–max', 'Embree', 'ratio'],
        stages.map((stage) => {
          const [ours, theirs] = [sample.cagecast[stage], embree?.times[stage]];
          return [
            stage,
            ms(ours.median),
            `${ms(ours.min)}–${ms(ours.max)}`,
            theirs && theirs.median > 0 ? ms(theirs.median) : '–',
            times(embree?.ratios[stage]),
          ];
        }),
      ),
    );
  }
  return parts;
}

/** In Chromium and Node. */
function inJavaScript(web: Results['web']): string[] {
  if (!web) return [];
  const parts: string[] = [];
  const scenes = Object.keys(web.chromium);
  parts.push(
    '## In JavaScript',
    table(
      [
        'scene',
        'Cagecast, Chromium',
        'three-mesh-bvh, Chromium',
        'ratio',
        'Cagecast, Node',
        'three-mesh-bvh, Node',
        'ratio',
      ],
      scenes.map((scene) => {
        const [page, node] = [web.chromium[scene], web.node[scene]];
        return [
          scene,
          ms(page?.cagecast.median),
          ms(page?.peer?.total.median),
          times(page?.peer?.ratio),
          ms(node?.cagecast.median),
          ms(node?.peer?.total.median),
          times(node?.peer?.ratio),
        ];
      }),
    ),
    `three-mesh-bvh is used in the way that is fastest for this task (bench/web/bvh-peer.ts says what was tried), in the same page. Both reuse the arrays of the previous result. Native Embree, run on the same core in turns with Chromium, takes ${times(web.againstNativeEmbree.ratio)} the package’s time at 4.8k (${ms(web.againstNativeEmbree.embree)} and ${ms(web.againstNativeEmbree.cagecast)} ms).`,
  );
  return parts;
}

/** What the preset `default` costs. */
function ofPresets(presets: Results['presets']): string[] {
  if (!presets) return [];
  const parts: string[] = [];
  parts.push(
    '## What the preset `default` costs',
    table(
      [
        'scene',
        'triangles',
        'cage',
        'its UV charts',
        '`paper`',
        '`default` without UVs per corner',
        'ratio',
        'with them',
        'more',
        'recheck',
        'holes',
        'seams',
      ],
      Object.entries(presets).map(([scene, cost]) => [
        scene,
        String(cost.triangles),
        String(cost.cageTriangles),
        String(cost.charts),
        ms(cost.paper),
        ms(cost.default.vertex),
        times(cost.ratio),
        ms(cost.default.corner),
        ms(cost.default.corner - cost.default.vertex),
        ...stagesOfDefault.map((stage) => ms(cost.stages[stage])),
      ]),
    ),
    'Native, all three in turns. 4.8k-many-charts is the sample with the UVs of its cage cut into many charts, as a box would be unfolded.',
  );
  return parts;
}

/** On phones, and in a browser that is slowed. */
function onPhones({ mobile, machine }: Results): string[] {
  if (!mobile) return [];
  const parts: string[] = [];
  const estimate = (1e3 * mobile.aarch64.perRun) / phone.instructionsPerSecond;
  parts.push(
    '## Phones',
    `64-bit ARM (NEON) under QEMU: ${(mobile.aarch64.perRun / 1e6).toFixed(2)} M instructions a transfer at 4.8k${mobile.aarch64.sameAnswer ? ', with bit-identical results' : ', BUT WITH ANOTHER RESULT'}. That is ${ms(estimate)} ms on a ${phone.name}, assuming one instruction per cycle. x86-64: ${(mobile.x86_64.perRun / 1e6).toFixed(2)} M.${mobile.wasm ? ` ${inWasm(mobile.wasm, machine.node)}` : ''}`,
    table(
      [
        'Chromium, 4.8k',
        'warm',
        'first use, at rest',
        '= import',
        '+ init',
        '+ transfer',
        'the same with `paper`',
        'first use, at once',
        '= import',
        '+ init',
        '+ transfer',
      ],
      Object.keys(mobile.firstUse).map((rate) => {
        const parts = (use: FirstUse | undefined): string[] => [
          ms(use?.total),
          ms(use?.import),
          ms(use?.init),
          ms(use?.transfer),
        ];
        return [
          rate === '1' ? 'as it is' : `slowed ${rate}×`,
          ms(mobile.warm[rate]?.median),
          ...parts(mobile.firstUseAtRest?.[rate]),
          ms(mobile.firstUseOfPaper?.[rate]?.total),
          ...parts(mobile.firstUse[rate]),
        ];
      }),
    ),
    'Wall time. *Warm* is the preset `paper`. *First use* is the preset `default` unless the column says otherwise, in a browser that never loaded the package: *at rest* after the browser’s own start is over, *at once* while its processes still start and share the two cores with the page.',
  );
  return parts;
}

function markdown(results: Results): string {
  const { date, machine, native, web, presets } = results;
  const parts = [
    `# Measured on ${date}`,
    `${machine.processor}, ${machine.cores} cores; Node ${machine.node}${machine.compiler ? `, g++ ${machine.compiler}` : ''}${machine.chromium ? `, Chromium ${machine.chromium}` : ''}. Written by \`npm run bench\`; all numbers: [${date}.json](${date}.json). How good the answer is: [quality](quality.md).`,
    'Times are for the whole work, from raw arrays to zones: CPU time of the one thread that does it, in ms, medians. A ratio is the median over pairs of runs, one right after the other. [How it is measured](../README.md).',
    '![Totals by size](totals.svg)',
    '![Steps at 4.8k triangles](stages.svg)',
    '![Scaling](scaling.svg)',
  ];
  parts.push(
    ...ofGoals(results),
    ...inNative(native),
    ...inJavaScript(web),
    ...ofPresets(presets),
    ...onPhones(results),
  );
  if (results.size) {
    parts.push(
      '## Size',
      table(
        ['file', 'bytes', 'gzipped'],
        Object.entries(results.size).map(([name, { raw, gz }]) => [name, String(raw), String(gz)]),
      ),
    );
  }
  return `${parts
    .join('\n\n')
    .replace(/\n{3,}/g, '\n\n')
    .trim()}\n`;
}
