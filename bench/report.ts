import { exponent } from './statistics.js';
import { table } from './table.js';
import { type PageWait, pageTable } from './waits/page.js';
import { type Growth, growthTable, type Waits, waitsTable } from './waits.js';
import type { FirstUse } from './web/page.js';

/** Everything that the benchmark found out. Parts that were not run are missing. */
export interface Results {
  date: string;
  machine: { processor: string; cores: number; node: string };
  /** By scene. */
  native?: Record<
    string,
    {
      triangles: number;
      cageTriangles: number;
      /** Medians in ms of CPU time, by contestant. */
      times: Record<string, number>;
      /** Medians over turns of `paper` ÷ Embree, `paper` ÷ nanoflann and `default` ÷ `paper`. */
      ratios: { embree?: number; nanoflann: number; default: number };
      /** By step, and by contestant. */
      stages: Record<string, Record<string, number>>;
      /** Most memory that `paper` uses beyond cage and target. */
      peakBytes: number;
      /** At which share of the vertices Embree says another zone. */
      otherZones?: number;
    }
  >;
  web?: {
    /** Its version. */
    chromium: string;
    /** By scene: ms of the fastest runs, and the peer's ÷ the package's. */
    races: Record<string, { cagecast: number; peer?: number; ratio?: number; otherZones?: number }>;
    /** In a browser that never loaded the package, with `default`, by how many times the processor is slowed down. */
    firstUse: Record<string, FirstUse>;
  };
  /** Per transfer, by preset and processor. */
  instructions?: Record<string, number>;
  /** By model. */
  waits?: Record<string, Waits>;
  growth?: Growth[];
  /** By model. */
  page?: Record<string, PageWait>;
  /** Bytes, gzipped. */
  sizes?: Record<string, number>;
}

const kContestants = ['paper', 'default', 'embree', 'nanoflann'];

/** Three digits; nothing for what was not measured. */
const ms = (value: number | undefined): string =>
  value === undefined ? '' : value >= 100 ? value.toFixed(0) : String(Number(value.toPrecision(3)));
const times = (value: number | undefined): string =>
  value === undefined ? '' : `${value.toFixed(value >= 10 ? 1 : 2)}×`;

/** Something the benchmark is to show, and what it showed. */
interface Goal {
  what: string;
  text: string;
  isReached: boolean;
}

/** What the speed and the size of the product are held against; only what was measured. */
export function goalsOf({ native, web, instructions, sizes }: Results): Goal[] {
  const goals: Goal[] = [];
  const expect = (
    what: string,
    value: number | undefined,
    kind: 'at most' | 'at least',
    limit: number,
    unit: string,
  ) => {
    if (value === undefined) return;
    const isReached = kind === 'at most' ? value <= limit : value >= limit;
    goals.push({ what, text: `${ms(value)}${unit}, goal ${kind} ${limit}${unit}`, isReached });
  };
  const fixed = ['4.8k', '50k-fixed-cage', '500k-fixed-cage', '2M-fixed-cage'].flatMap((name) =>
    native?.[name] ? [[native[name].triangles, native[name].times['paper']!] as const] : [],
  );
  const million = (name: string): number | undefined => instructions?.[name] && instructions[name] / 1e6;
  const { '4.8k': sample, '500k': large, '2M': largest } = native ?? {};
  expect('native ÷ Embree, 4.8k', sample?.ratios.embree, 'at most', 0.4, '×');
  expect('native ÷ Embree, 500k', large?.ratios.embree, 'at most', 0.32, '×');
  expect('`default` ÷ `paper`, 4.8k', sample?.ratios.default, 'at most', 2.4, '×');
  expect('scaling exponent with a fixed cage', fixed.length === 4 ? exponent(fixed) : undefined, 'at most', 1.05, '');
  expect('memory above the inputs, 4.8k', sample && sample.peakBytes / 1e6, 'at most', 1, ' MB');
  expect(
    'memory above the inputs, 2M, per triangle',
    largest && largest.peakBytes / largest.triangles,
    'at most',
    150,
    ' B',
  );
  expect('instructions, `paper`, x86-64', million('paper, x86_64'), 'at most', 8, ' M');
  expect('instructions, `paper`, 64-bit ARM', million('paper, aarch64'), 'at most', 8, ' M');
  expect('three-mesh-bvh ÷ Cagecast, Chromium, 4.8k', web?.races['4.8k']?.ratio, 'at least', 10, '×');
  expect('Chromium slowed 4×, first use, 4.8k', web?.firstUse['4']?.total, 'at most', 150, ' ms');
  expect('the package’s entry, gzipped', sizes && sizes['cagecast (WebAssembly inlined)']! / 1e3, 'at most', 97, ' KB');
  return goals;
}

/** What the poster says, and what was measured of the same model. */
function besidePoster({ native, web, instructions = {} }: Results): string[][] {
  const sample = native?.['4.8k'];
  const million = (preset: string): string => {
    const count = instructions[`${preset}, aarch64`];
    return count === undefined ? '' : `${(count / 1e6).toFixed(1)} M`;
  };
  return [
    ['the poster, on the tablet', '70', '', '20'],
    ['its naive transfer, on the tablet', 'less than 50', '', ''],
    ...(['paper', 'default'] as const).map((preset) => [
      `\`${preset}\`, native, here`,
      ms(sample?.times[preset]),
      million(preset),
      preset === 'paper' && sample ? (sample.peakBytes / 1e6).toFixed(1) : '',
    ]),
    ['`paper`, Chromium, here', ms(web?.races['4.8k']?.cagecast), '', ''],
    ['Embree’s searches, native, here', ms(sample?.times['embree']), '', ''],
    ['three-mesh-bvh’s searches, Chromium, here', ms(web?.races['4.8k']?.peer), '', ''],
  ];
}

function waitsReport({ waits, growth, page }: Results): string[] {
  if (!waits) return [];
  const parts = [
    '## What people wait for',
    'Milliseconds of processor time of a command, from the start of its process to the written file, all its threads together; and where it goes. `transfer` has a cage; glTF-Transform only reads the file and writes it.',
    waitsTable(waits),
  ];
  if (page) {
    parts.push(
      'From a drop on the page until the model stands there painted: processor time of the page’s process, its workers and what the browser compiles together; Chromium draws by software.',
      pageTable(page),
    );
  }
  if (!growth) return parts;
  const about = 'How that grows for the sample `human`, in seconds, and the most memory of the process.';
  return [...parts, about, growthTable(growth)];
}

/** All tables, in Markdown. */
export function speedReport(results: Results): string {
  const { date, machine, native = {}, web, instructions = {}, sizes = {} } = results;
  const goals = goalsOf(results).map(({ what, text, isReached }) => [what, text, isReached ? 'yes' : 'no']);
  const nativeRows = Object.entries(native).map(
    ([scene, { triangles, cageTriangles, times: took, ratios, peakBytes }]) => [
      scene,
      triangles.toLocaleString('en'),
      cageTriangles.toLocaleString('en'),
      ...kContestants.map((name) => ms(took[name])),
      times(ratios.embree),
      times(ratios.nanoflann),
      (peakBytes / 1e6).toFixed(1),
    ],
  );
  const stageRows = Object.entries(native['4.8k']?.stages ?? {}).map(([stage, took]) => [
    stage,
    ...kContestants.map((name) => ms(took[name] || undefined)),
  ]);
  const webRows = Object.entries(web?.races ?? {}).map(([scene, { cagecast, peer, ratio }]) => [
    scene,
    ms(cagecast),
    ms(peer),
    times(ratio),
  ]);
  const phoneRows = Object.entries(web?.firstUse ?? {}).map(([rate, use]) => [
    rate === '1' ? 'as it is' : `slowed ${rate}×`,
    ...[use.total, use.import, use.init, use.transfer].map(ms),
  ]);
  const other = Math.max(0, ...Object.values(native).map(({ otherZones }) => otherZones ?? 0));
  const parts = [
    `# Speed, measured on ${date}`,
    `${machine.processor}, ${machine.cores} cores; Node ${machine.node}${web ? `, Chromium ${web.chromium}` : ''}. Written by \`npm run bench\`; all numbers: [speed.json](speed.json). [What is compared, and how](../README.md). How good the result is: [quality](quality.md).`,
    table(['', 'measured', ''], goals),
    '## Beside the poster',
    'The lizard of 4,782 triangles. [The poster](https://doi.org/10.1145/3799825.3818741) measured on a tablet (Samsung S6 Lite); no such device was at hand here, so instructions stand beside the times.',
    table(['4.8k', 'ms', 'instructions, 64-bit ARM', 'MB'], besidePoster(results)),
    '## Native',
    'Milliseconds of CPU time on one thread, medians. Cagecast: from raw arrays to zones. Embree and nanoflann: the searches alone. A ratio is `paper` ÷ the peer, the median over turns.',
    table(
      [
        'scene',
        'triangles',
        'cage',
        '`paper`',
        '`default`',
        'Embree',
        'nanoflann',
        'ratio to Embree',
        'to nanoflann',
        'MB above inputs',
      ],
      nativeRows,
    ),
    `Embree says other zones than \`paper\` at ${other === 0 ? 'no vertex' : `at most ${(100 * other).toFixed(2)} % of the vertices`}. nanoflann finds the nearest cage *vertex* and filters nothing.`,
    table(['4.8k, by step', '`paper`', '`default`', 'Embree', 'nanoflann'], stageRows),
    '## In Chromium',
    'Milliseconds, the fastest run of each turn, median over turns; preset `paper`. three-mesh-bvh: the searches alone.',
    table(['scene', 'Cagecast', 'three-mesh-bvh', 'ratio'], webRows),
    'First use of the package, by wall time: the sample in a browser that never loaded it and has come to rest, preset `default`.',
    table(['4.8k', 'first use', '= import', '+ init', '+ transfer'], phoneRows),
    ...waitsReport(results),
    '## Instructions and sizes',
    table(
      ['a transfer of the sample', 'instructions'],
      Object.entries(instructions).map(([name, count]) => [name, `${(count / 1e6).toFixed(2)} M`]),
    ),
    table(
      ['file', 'bytes, gzipped'],
      Object.entries(sizes).map(([name, bytes]) => [name, bytes.toLocaleString('en')]),
    ),
  ];
  return `${parts.map((part) => part.trim()).join('\n\n')}\n`;
}
