import { colours, picture, text, width } from '../plots.js';
import { type Quality, thresholds } from './measure.js';
import type { Score } from './score.js';

const presets = ['paper', 'default'] as const;
type Preset = (typeof presets)[number];
const looks: Record<Preset, string> = { paper: colours.embree, default: colours.ours };
const panels = [
  ['suppressed', 'of the area that must not be painted'],
  ['kept', 'of the area that is to be painted'],
] as const satisfies readonly (readonly [keyof Score, string])[];

/**
 * Suppressed and kept by threshold, by both presets: thin lines for models, thick ones for the worst of them. Without the traps,
 * some of which `paper` does not paint at all.
 */
export function thresholdPlot(results: Readonly<Record<string, Quality>>): string {
  const models = Object.values(results).filter(({ kind }) => kind === 'sample' || kind === 'asset');
  const valuesOf = ({ thresholds: by }: Quality, preset: Preset, measure: keyof Score): number[] =>
    thresholds.map((threshold) => by[preset][threshold.toFixed(1)]![measure]);
  const least = Math.min(
    ...models.flatMap((model) =>
      presets.flatMap((preset) => panels.flatMap(([measure]) => valuesOf(model, preset, measure))),
    ),
  );
  const bottom = Math.floor(least * 20 - 1e-9) / 20;
  const [top, height, gap, left] = [76, 200, 60, 56];
  const panelWidth = (width - left - gap - 16) / 2;
  const py = (value: number): number => top + height * ((1 - value) / (1 - bottom));
  const body: string[] = [];
  panels.forEach(([measure, words], p) => {
    const x0 = left + p * (panelWidth + gap);
    const px = (threshold: number): number => x0 + panelWidth * ((threshold - 0.1) / 0.8);
    body.push(text(x0, top - 26, measure, 'font-weight="600"'), text(x0 + 8.5 * measure.length, top - 26, words));
    for (let value = bottom; value < 1 + 1e-9; value += 0.05) {
      const y = py(value).toFixed(1);
      body.push(`<line x1="${x0}" x2="${x0 + panelWidth}" y1="${y}" y2="${y}" class="grid"/>`);
      body.push(text(x0 - 8, py(value) + 4, value.toFixed(2), 'text-anchor="end"'));
    }
    for (const threshold of thresholds)
      body.push(text(px(threshold), top + height + 18, threshold.toFixed(1), 'text-anchor="middle"'));
    for (const preset of presets) {
      const line = (values: readonly number[], look: string): string => {
        const points = values.map((value, i) => `${px(thresholds[i]!).toFixed(1)},${py(value).toFixed(1)}`);
        return `<polyline fill="none" stroke="${looks[preset]}" ${look} points="${points.join(' ')}"/>`;
      };
      const all = models.map((model) => valuesOf(model, preset, measure));
      const worst = thresholds.map((_, i) => Math.min(...all.map((values) => values[i]!)));
      body.push(
        ...all.map((values) => line(values, 'stroke-opacity="0.45"')),
        line(worst, 'stroke-width="3" stroke-linejoin="round"'),
      );
    }
  });
  const legendY = top + height + 50;
  body.push(text(width - 16, legendY, 'threshold', 'text-anchor="end"'));
  presets.forEach((preset, i) => {
    const x = left + 290 * i;
    body.push(
      `<line x1="${x}" x2="${x + 22}" y1="${legendY - 4}" y2="${legendY - 4}" stroke="${looks[preset]}" stroke-width="3"/>`,
    );
    body.push(text(x + 30, legendY, `${preset}: the worst of ${models.length} models, and each`));
  });
  return picture(legendY + 16, 'Suppressed and kept at every threshold', body);
}
