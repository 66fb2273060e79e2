// Scores fitted cages: a line per figure, and the means over those whose parts have names.
//
//   npx tsx bench/cages/score-fit.ts [--run] [--given auto|5|9|23|all|name,name…] [--cages folder] [--template NAME] [head|body|NAME …]
//     --run     fit first, with build/release/bench/cagecast_cages_tool
//     --given   true landmarks that the fit is given (default auto: none)
//     --cages   subfolder of build/cages with NAME.json for each figure (default fitted-GIVEN)
//     --template  name of another figure whose cage is fitted, to all that have eyes or landmarks; without correspondence, errors
//               are those of landmarks only
//     --json    all numbers as JSON, instead of the table
//
// Write the figures with scenes.ts before. Columns, lengths as % of the diagonal, areas as % of the skin's:
//   fit         error of correspondence, median / 95th percentile, on the template's cage (see fit-score.ts)
//   similarity  the same for the template brought there by a similarity of the landmarks that the fit used
//   floor       the same for the template carried by the true displacement of the skin
//   unused      true landmarks that the fit did not use: mean / largest error
//   found       landmarks that the fit used: mean / largest distance from the true ones
//   eyes        of the left and the right eye: share of the visible eye inside its hole / area of the hole beside the visible
//               eye, as a share of it; eyeballs: the same as if there were no lids
//   out         skin outside of the cage; folded: folded triangles beyond the template's own; angle: 5th percentile of the
//               triangles' smallest angles; sup/kept: of a transfer with the fitted cage

import { mkdirSync, writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { init } from 'cagecast';
import { table } from '../table.js';
import { cagesFolder } from './figures.js';
import { has, personOf, read, runTool, type StoredCage, type StoredFigure, storedFigures } from './files.js';
import { type EyeScore, FitScorer, type Spread } from './fit-score.js';
import { type FitMeasures, givenOf, mean, measureFit, percent } from './measure.js';

/** What is printed of a figure. */
interface Line extends FitMeasures {
  name: string;
  outcome: string;
}

const scorers = new Map<string, FitScorer>();
function scorerOf(template: string): FitScorer {
  if (!scorers.has(template)) {
    const figure = read<StoredFigure>(`${template}.figure`);
    scorers.set(template, new FitScorer({ ...personOf(figure), cage: read<StoredCage>(`${template}.cage`) }));
  }
  return scorers.get(template)!;
}

function lineOf(figure: StoredFigure, template: string, folder: string, outcome: string): Line | undefined {
  if (!has(`${folder}/${figure.name}`)) return undefined;
  const cage = read<StoredCage>(`${folder}/${figure.name}`);
  const person = { ...personOf(figure), corresponds: figure.template === template };
  const measures = measureFit(scorerOf(template), person, cage, cage.used ?? {});
  return { name: figure.name, ...measures, outcome };
}

const both = ({ median, most }: Spread): string => `${percent(median)} / ${percent(most)}`;
const errorsOf = ({ mean: middle, most, count }: Line['found']): string =>
  count > 0 ? `${percent(middle)} / ${percent(most)} (${count})` : '–';
type Cover = Pick<EyeScore, 'cover' | 'spill'>;
/** Cover and spill of both eyes apart, or the means over all. */
function eyesOf(lines: readonly Line[], of: (eye: EyeScore) => Cover, each?: string): string {
  const list = (values: readonly number[]): string =>
    (each === undefined ? [mean(values)] : values).map((x) => (Number.isFinite(x) ? x.toFixed(2) : '–')).join(each);
  const eyes = lines.flatMap((line) => line.eyes.map(of));
  return `${list(eyes.map(({ cover }) => cover))} / ${list(eyes.map(({ spill }) => spill))}`;
}

const row = (line: Line): string[] => [
  line.name,
  both(line.correspondence),
  both(line.similarity),
  both(line.floor),
  errorsOf(line.unused),
  errorsOf(line.found),
  eyesOf([line], (eye) => eye, ' '),
  eyesOf([line], ({ ball }) => ball, ' '),
  percent(line.outside),
  String(line.folded),
  line.angle.toFixed(1),
  `${line.suppressed.toFixed(4)} / ${line.kept.toFixed(4)}`,
  line.verdict,
  line.outcome,
];
const head = 'fit,similarity,floor,unused,found,eyes,eyeballs,out,folded,angle,sup / kept,verdict,'.split(',');

function meanOf(lines: readonly Line[]): string[] {
  const spread = (of: (line: Line) => Spread): string =>
    both({ median: mean(lines.map((line) => of(line).median)), most: mean(lines.map((line) => of(line).most)) });
  const errors = (of: (line: Line) => Line['found']): string =>
    `${percent(mean(lines.map((line) => of(line).mean)))} / ${percent(mean(lines.map((line) => of(line).most)))}`;
  return [
    `mean of ${lines.length} with part names`,
    spread((line) => line.correspondence),
    spread((line) => line.similarity),
    spread((line) => line.floor),
    errors((line) => line.unused),
    errors((line) => line.found),
    eyesOf(lines, (eye) => eye),
    eyesOf(lines, ({ ball }) => ball),
    percent(mean(lines.map(({ outside }) => outside))),
    mean(lines.map(({ folded }) => folded)).toFixed(1),
    mean(lines.map(({ angle }) => angle)).toFixed(1),
    `${mean(lines.map(({ suppressed }) => suppressed)).toFixed(4)} / ${mean(lines.map(({ kept }) => kept)).toFixed(4)}`,
    '',
    '',
  ];
}

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    run: { type: 'boolean' },
    given: { type: 'string', default: 'auto' },
    cages: { type: 'string' },
    template: { type: 'string' },
    json: { type: 'boolean' },
  },
});
await init();
const suffix = options.template === undefined ? '' : `-${options.template}`;
const folder = options.cages ?? `fitted-${options.given.replace(/,/g, '+')}${suffix}`;
mkdirSync(`${cagesFolder}/${folder}`, { recursive: true });
const figures = storedFigures(positionals).filter((figure) =>
  options.template === undefined
    ? figure.template !== undefined
    : figure.name !== options.template && (figure.truth.eyes.includes(1) || figure.template !== undefined),
);
const lines: Line[] = [];
for (const figure of figures) {
  const { name } = figure;
  const template = options.template ?? figure.template!;
  let outcome = '';
  if (options.run) {
    const at = (file: string): string => `${cagesFolder}/${file}.json`;
    const given = `${folder}/${name}.given`;
    writeFileSync(at(given), JSON.stringify(givenOf(read(`${name}.landmarks`), options.given)));
    const files = [`${template}.cage`, `${template}.landmarks`, `${name}.model`, `${folder}/${name}`].map(at);
    outcome = await runTool('fit', ...files, '--landmarks', at(given));
  }
  const line = lineOf(figure, template, folder, outcome);
  if (line) lines.push(line);
  else console.error(`${name}: no ${folder}/${name}.json ${outcome}`);
}
if (options.json) console.log(JSON.stringify(lines, null, 1));
else if (lines.length > 0) {
  const groups = (['head', 'body', 'prop'] as const).flatMap((kind) => {
    const some = lines.filter(({ name }) => read<StoredFigure>(`${name}.figure`).kind === kind);
    const named = some.filter(({ name }) => read<StoredFigure>(`${name}.figure`).named);
    return some.length > 0 ? [...some.map(row), meanOf(named)] : [];
  });
  console.log(table(['', ...head], groups));
}
