import { type NativeResult, type Stage, stages } from './native.js';
import type { Results } from './results.js';

/** What can be seen in a plot: a value per size or step. */
interface Series {
  name: string;
  colour: string;
  points: [x: number, y: number][];
  dashed?: boolean;
}

// Okabe and Ito's colours, which the colour-blind can tell apart.
export const colours = {
  ours: '#0072b2',
  wasm: '#56b4e9',
  embree: '#d55e00',
  nanoflann: '#999999',
  bvh: '#e69f00',
  fixed: '#009e73',
};
const stageColours: Record<Exclude<Stage, 'total'>, string> = {
  weld: '#999999',
  build: '#e69f00',
  project: '#0072b2',
  occluded: '#d55e00',
  covered: '#cc79a7',
  segments: '#56b4e9',
  classify: '#009e73',
};
const stageNames: Record<Exclude<Stage, 'total'>, string> = {
  weld: 'weld',
  build: 'trees',
  project: 'nearest',
  occluded: 'self rays',
  covered: 'cage rays',
  segments: 'segments',
  classify: 'threshold',
};

export const width = 760;
const number = (value: number): string =>
  value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toPrecision(2);
const short = (n: number): string => (n >= 1e6 ? `${n / 1e6}M` : n >= 1e3 ? `${+(n / 1e3).toFixed(1)}k` : `${n}`);
const escapeXml = (text: string): string =>
  text.replace(/[&<>]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;' })[c]!);
export const text = (x: number, y: number, content: string, rest = ''): string =>
  `<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" ${rest}>${escapeXml(content)}</text>`;

// Light or dark as the reader's screen is; the classes are those of the elements that follow it.
const style = `<style>
svg { background: #fff; fill: #222 } .grid { stroke: #ddd } .frame { stroke: #999; fill: none }
@media (prefers-color-scheme: dark) { svg { background: #0d1117; fill: #e6edf3 } .grid { stroke: #30363d } .frame { stroke: #6e7681 } }
</style>`;

/** An SVG of the plots' width, with a title. */
export function picture(height: number, title: string, body: string[]): string {
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" font-family="system-ui, sans-serif" font-size="12">`,
    `<title>${escapeXml(title)}</title>`,
    style,
    text(16, 24, title, 'font-size="15" font-weight="600"'),
    ...body,
    '</svg>\n',
  ].join('\n');
}

const nativeSeries = (
  results: Results,
  pick: (result: NativeResult) => number | undefined,
  isWanted: (scene: string) => boolean,
): [number, number][] =>
  Object.entries(results.native ?? {})
    .filter(([scene]) => isWanted(scene))
    .flatMap(([, result]) => {
      const y = pick(result);
      return y === undefined ? [] : ([[result.triangles, y]] as [number, number][]);
    })
    .sort(([a], [b]) => a - b);

const isGrown = (scene: string): boolean => /^[\d.]+[kM]$/.test(scene);
const isFixed = (scene: string): boolean => scene === '4.8k' || scene.endsWith('-fixed-cage');

function webSeries({ web, native }: Results, pick: (scene: string) => number | undefined): [number, number][] {
  return Object.keys(web?.chromium ?? {})
    .filter(isGrown)
    .flatMap((scene) => {
      const y = pick(scene);
      const x = native?.[scene]?.triangles;
      return x === undefined || y === undefined ? [] : ([[x, y]] as [number, number][]);
    });
}

/** Time against size, both on logarithmic axes. */
export function scalingPlot(results: Results): string {
  const series: Series[] = [
    {
      name: 'three-mesh-bvh, Chromium',
      colour: colours.bvh,
      points: webSeries(results, (scene) => results.web!.chromium[scene]!.peer?.total.median),
    },
    {
      name: 'Embree, native',
      colour: colours.embree,
      points: nativeSeries(results, (r) => r.peers['embree']?.times.total.median, isGrown),
    },
    {
      name: 'Cagecast, Chromium',
      colour: colours.wasm,
      points: webSeries(results, (scene) => results.web!.chromium[scene]!.cagecast.median),
    },
    {
      name: 'Cagecast, native',
      colour: colours.ours,
      points: nativeSeries(results, (r) => r.cagecast.total.median, isGrown),
    },
    {
      name: 'Cagecast, native, the sample’s cage at every size',
      colour: colours.fixed,
      points: nativeSeries(results, (r) => r.cagecast.total.median, isFixed),
      dashed: true,
    },
  ];
  const height = 460;
  const frame = { left: 64, right: width - 20, top: 60, bottom: height - 116 };
  const points = series.flatMap(({ points: p }) => p);
  const decade = (values: number[], round: (x: number) => number, pick: (...v: number[]) => number): number =>
    round(Math.log10(pick(...values)));
  const [y0, y1] = [
    decade(
      points.map(([, y]) => y),
      Math.floor,
      Math.min,
    ),
    decade(
      points.map(([, y]) => y),
      Math.ceil,
      Math.max,
    ),
  ];
  const [x0, x1] = [3, 6.5];
  const px = (x: number): number => frame.left + ((Math.log10(x) - x0) / (x1 - x0)) * (frame.right - frame.left);
  const py = (y: number): number => frame.bottom - ((Math.log10(y) - y0) / (y1 - y0)) * (frame.bottom - frame.top);
  const body: string[] = [];
  for (let e = y0; e <= y1; ++e) {
    const y = py(10 ** e);
    body.push(
      `<line x1="${frame.left}" x2="${frame.right}" y1="${y.toFixed(1)}" y2="${y.toFixed(1)}" class="grid"/>`,
      text(frame.left - 8, y + 4, `${10 ** e >= 1 ? 10 ** e : (10 ** e).toFixed(-e)}`, 'text-anchor="end"'),
    );
  }
  for (const n of [...new Set(points.map(([x]) => x))]) {
    if (Object.values(results.native ?? {}).some((r) => r.triangles === n))
      body.push(
        `<line x1="${px(n).toFixed(1)}" x2="${px(n).toFixed(1)}" y1="${frame.top}" y2="${frame.bottom}" class="grid"/>`,
        text(px(n), frame.bottom + 18, short(Number(n.toPrecision(2))), 'text-anchor="middle"'),
      );
  }
  body.push(
    text(frame.left - 8, frame.top - 14, 'ms', 'text-anchor="end"'),
    text(frame.right, frame.bottom + 36, 'triangles of the target', 'text-anchor="end"'),
  );
  series.forEach(({ name, colour, points: line, dashed }, i) => {
    if (line.length === 0) return;
    body.push(
      `<polyline fill="none" stroke="${colour}" stroke-width="2"${dashed ? ' stroke-dasharray="5 4"' : ''} points="${line.map(([x, y]) => `${px(x).toFixed(1)},${py(y).toFixed(1)}`).join(' ')}"/>`,
      ...line.map(([x, y]) => `<circle cx="${px(x).toFixed(1)}" cy="${py(y).toFixed(1)}" r="3" fill="${colour}"/>`),
    );
    const legendY = frame.bottom + 58 + 18 * Math.floor(i / 2);
    const legendX = frame.left + (i % 2) * 340;
    body.push(
      `<line x1="${legendX}" x2="${legendX + 22}" y1="${legendY - 4}" y2="${legendY - 4}" stroke="${colour}" stroke-width="3"${dashed ? ' stroke-dasharray="5 4"' : ''}/>`,
      text(legendX + 30, legendY, name),
    );
  });
  return picture(height, 'Whole transfer, from raw arrays to zones, by size', body);
}

interface Bar {
  name: string;
  parts: { value: number; colour: string }[];
}

/** Stacked bars in groups, each group to its own scale. */
function bars(title: string, groups: Bar[][], legend: { name: string; colour: string }[]): string {
  const left = 230;
  const right = width - 70;
  const total = ({ parts }: Bar): number => parts.reduce((sum, { value }) => sum + value, 0);
  const body: string[] = [];
  let y = 46;
  for (const rows of groups) {
    const most = Math.max(...rows.map(total));
    for (const row of rows) {
      let x = left;
      body.push(text(left - 10, y + 15, row.name, 'text-anchor="end"'));
      for (const { value, colour } of row.parts) {
        const w = (value / most) * (right - left);
        body.push(`<rect x="${x.toFixed(1)}" y="${y}" width="${w.toFixed(1)}" height="20" fill="${colour}"/>`);
        x += w;
      }
      body.push(text(x + 6, y + 15, `${number(total(row))} ms`));
      y += 28;
    }
    y += 10;
  }
  const step = (width - 40) / legend.length;
  legend.forEach(({ name, colour }, i) => {
    const x = 20 + i * step;
    body.push(
      `<rect x="${x.toFixed(1)}" y="${y}" width="12" height="12" fill="${colour}"/>`,
      text(x + 17, y + 10, name),
    );
  });
  return picture(y + 28, title, body);
}

/** The steps of each at the sample's size, one after the other. */
export function stagesPlot({ native, web }: Results): string {
  const steps = stages.filter((stage) => stage !== 'total');
  const stacked = (name: string, of: (stage: Exclude<Stage, 'total'>) => number | undefined): Bar => ({
    name,
    parts: steps.map((stage) => ({ value: of(stage) ?? 0, colour: stageColours[stage] })),
  });
  const sample = native?.['4.8k'];
  const page = web?.chromium['4.8k'];
  const inC: Bar[] = [];
  const inJs: Bar[] = [];
  if (sample) {
    inC.push(stacked('Cagecast, native', (stage) => sample.cagecast[stage].median));
    for (const [name, title] of [
      ['nanoflann', 'nanoflann, native, no filter'],
      ['embree', 'Embree, native'],
    ] as const) {
      const peer = sample.peers[name];
      if (peer) inC.push(stacked(title, (stage) => peer.times[stage].median));
    }
  }
  if (page) {
    inJs.push(stacked('Cagecast, Chromium', (stage) => page.stages[stage]));
    if (page.peer) inJs.push(stacked('three-mesh-bvh, Chromium', (stage) => page.peer!.stages[stage]));
  }
  return bars(
    'Where the time goes, 4.8k triangles (native and Chromium each to its own scale)',
    [inC, inJs].filter((rows) => rows.length > 0),
    steps.map((stage) => ({ name: stageNames[stage], colour: stageColours[stage] })),
  );
}

/** The totals of each, size by size; each size to its own scale. */
export function totalsPlot({ native, web }: Results): string {
  const groups = Object.keys(native ?? {}).filter(isGrown);
  const left = 250;
  const right = width - 80;
  const body: string[] = [];
  let y = 44;
  for (const scene of groups) {
    const rows = [
      { name: 'Cagecast, native', colour: colours.ours, value: native![scene]!.cagecast.total.median },
      { name: 'Cagecast, Chromium', colour: colours.wasm, value: web?.chromium[scene]?.cagecast.median },
      {
        name: 'nanoflann, native, no filter',
        colour: colours.nanoflann,
        value: native![scene]!.peers['nanoflann']?.times.total.median,
      },
      { name: 'Embree, native', colour: colours.embree, value: native![scene]!.peers['embree']?.times.total.median },
      { name: 'three-mesh-bvh, Chromium', colour: colours.bvh, value: web?.chromium[scene]?.peer?.total.median },
    ].filter((row): row is typeof row & { value: number } => row.value !== undefined);
    const most = Math.max(...rows.map(({ value }) => value));
    body.push(text(16, y + 13, `${scene} triangles`, 'font-weight="600"'));
    for (const { name, colour, value } of rows) {
      const w = Math.max(1, (value / most) * (right - left));
      body.push(
        text(left - 10, y + 13, name, 'text-anchor="end"'),
        `<rect x="${left}" y="${y}" width="${w.toFixed(1)}" height="16" fill="${colour}"/>`,
        text(left + w + 6, y + 13, `${number(value)} ms`),
      );
      y += 20;
    }
    y += 14;
  }
  return picture(y, 'Whole transfer by size (each size to its own scale)', body);
}
