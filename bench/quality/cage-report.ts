import type { Spread } from '../cages/fit-score.js';
import { mean } from '../cages/measure.js';
import { table } from '../table.js';
import type { CageQuality, FitQuality, MadeQuality } from './cages.js';

const percent = (share: number, digits = 2): string =>
  Number.isFinite(share) ? `${Number((100 * share).toFixed(digits))} %` : '–';
const both = ({ suppressed, kept }: { suppressed: number; kept: number }): string =>
  `${percent(suppressed)} · ${percent(kept)}`;
const spread = ({ median, most }: Spread): string => `${(100 * median).toFixed(2)} / ${percent(most)}`;
const seconds = (value: number): string => `${value.toFixed(1)} s`;

/** The cages that were made, with those made by hand beside them. */
export function madeTable(made: CageQuality['made']): string {
  const head = ['', '', 'made', 'by hand', 'triangles', 'charts', 'by hand', 'overlap', 'verdict', 'time'];
  const row = ([name, { kind, named, made: own, byHand, seconds: time }]: [string, MadeQuality]): string[] => [
    name,
    named ? kind : `${kind}, no part names`,
    both(own),
    byHand ? both(byHand) : '',
    String(own.triangles),
    String(own.charts),
    byHand ? String(byHand.charts) : '',
    percent(own.overlap),
    own.verdict,
    seconds(time),
  ];
  return table(head, Object.entries(made).map(row));
}

const fitHead = [
  '',
  'error',
  'by similarity',
  'by displacement',
  'landmarks',
  'eye cover',
  'spill',
  'outside',
  'folded',
  'angle',
  'suppressed · kept',
  'verdict',
  'time',
];

const average = (spreads: readonly Spread[]): Spread => ({
  median: mean(spreads.map(({ median }) => median)),
  most: mean(spreads.map(({ most }) => most)),
});

/** One row for some fits: their means. */
function fitRow(name: string, fits: readonly FitQuality[]): string[] {
  const of = (value: (fit: FitQuality) => number): number => mean(fits.map(value));
  const eyes = fits.flatMap((fit) => fit.eyes);
  return [
    name,
    spread(average(fits.map((fit) => fit.correspondence))),
    spread(average(fits.map((fit) => fit.similarity))),
    spread(average(fits.map((fit) => fit.floor))),
    percent(of((fit) => fit.unused.mean)),
    percent(mean(eyes.map(({ cover }) => cover)), 0),
    percent(mean(eyes.map(({ spill }) => spill)), 0),
    percent(of((fit) => fit.outside)),
    String(Number(of((fit) => fit.folded).toFixed(1))),
    `${of((fit) => fit.angle).toFixed(1)}°`,
    both({ suppressed: of((fit) => fit.suppressed), kept: of((fit) => fit.kept) }),
    fits.length === 1 ? fits[0]!.verdict : '',
    seconds(of((fit) => fit.seconds)),
  ];
}

/** The fits, and the means over heads and over bodies. */
export function fitTable({ fitted, given }: CageQuality): string {
  const all = Object.entries(fitted);
  const groups = [
    { name: '**heads, mean**', fits: all.filter(([, { kind, named }]) => kind === 'head' && named) },
    { name: '**bodies, mean**', fits: all.filter(([, { kind }]) => kind === 'body') },
    { name: '**heads, 23 given landmarks, mean**', fits: Object.entries(given) },
  ].filter(({ fits }) => fits.length > 0);
  return table(fitHead, [
    ...all.map(([name, fit]) => fitRow(name, [fit])),
    ...groups.map(({ name, fits }) =>
      fitRow(
        name,
        fits.map(([, fit]) => fit),
      ),
    ),
  ]);
}

/** Two sections of the report, in Markdown. */
export function cageSections(cages: CageQuality): string[] {
  return [
    '## Made cages',
    `\`makeCage\` with no options. Suppressed · kept with preset \`default\`, with the made cage and with the one made by hand; UV charts; the
share of the used texture where charts overlap; the verdict of \`cagecast inspect\`; seconds in Node.`,
    madeTable(cages.made),
    ...(Object.keys(cages.fitted).length > 0
      ? [
          '## Fitted cages',
          `\`fitCage\` with no landmarks, unless the row says so. The template's target and the model have the same vertices, so that the correct
result is known. Lengths are shares of the diagonal.

- *error*: distance, on the template's cage, between the spot that a vertex of the skin has with the fitted cage and the spot that it
  should have: median / 95th percentile. *by similarity*: the same for the template moved by a similarity of the landmarks that the fit
  used. *by displacement*: the template moved along with the nearest skin, which no fit can know; about the least error there is.
- *landmarks*: mean error at the known landmarks that the fit did not use.
- *eye cover*, *spill*: of the visible part of the eyes, what is inside the holes for them; the area of the holes beside it, as a
  share of it. *outside*: the share of the skin outside the cage. *folded*: triangles that are folded over, and are not in the template.
  *angle*: 5th percentile of the smallest angles of the triangles.`,
          fitTable(cages),
        ]
      : []),
    ...(cages.failed.length > 0 ? [`Failed:\n\n${cages.failed.map((line) => `- ${line}`).join('\n')}`] : []),
  ];
}
