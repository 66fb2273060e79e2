// Scores made cages, with the hand-made ones beside them: a line per figure.
//
//   npx tsx bench/cages/score-make.ts [--run] [--cages folder] [head|body|prop|NAME …] [-- options of the tool]
//     --run     make first, with build/release/bench/cagecast_cages_tool
//     --cages   subfolder of build/cages with NAME.json for each figure (default made)
//
// Write the figures with scenes.ts before. Columns: suppressed / kept of a transfer (shares of area; what the hand-made cage
// says nothing about is not scored), those of the hand-made cage, triangles, charts (hand-made), overlaps as % of the used
// texture, inspect's verdict with its first finding, and time.

import { mkdirSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { init } from 'cagecast';
import { table } from '../table.js';
import { cagesFolder } from './figures.js';
import { has, read, runTool, type StoredCage, type StoredFigure, type StoredModel, storedFigures } from './files.js';
import { measureCage, percent } from './measure.js';
import type { PaintScore } from './paint-score.js';

const both = ({ suppressed, kept }: PaintScore): string => `${suppressed.toFixed(4)} / ${kept.toFixed(4)}`;

/** @returns none if there is no cage. */
function rowOf({ name, truth }: StoredFigure, folder: string, outcome: string): string[] | undefined {
  if (!has(`${folder}/${name}`)) return undefined;
  const model = read<StoredModel>(`${name}.model`);
  const measure = (file: string) => measureCage(read<StoredCage>(file), model, truth);
  const made = measure(`${folder}/${name}`);
  const hand = has(`${name}.cage`) ? measure(`${name}.cage`) : undefined;
  return [
    name,
    both(made),
    hand ? both(hand) : '',
    String(made.triangles),
    `${made.charts}${hand ? ` (${hand.charts})` : ''}`,
    percent(made.overlap),
    percent(made.used),
    percent(made.inside),
    `${made.verdict}${made.finding ? `: ${made.finding}` : ''}`,
    outcome,
  ];
}

const args = process.argv.slice(2);
const end = args.includes('--') ? args.indexOf('--') : args.length;
const own = args.slice(end + 1);
const { values: options, positionals } = parseArgs({
  args: args.slice(0, end),
  allowPositionals: true,
  options: { run: { type: 'boolean' }, cages: { type: 'string', default: 'made' } },
});
await init();
mkdirSync(`${cagesFolder}/${options.cages}`, { recursive: true });
const rows: string[][] = [];
for (const figure of storedFigures(positionals)) {
  const { name } = figure;
  const [model, cage] = [`${name}.model`, `${options.cages}/${name}`].map((file) => `${cagesFolder}/${file}.json`);
  const outcome = options.run ? await runTool('make', model!, cage!, ...own) : '';
  const row = rowOf(figure, options.cages, outcome);
  if (row) rows.push(row);
  else console.error(`${name}: no ${cage} ${outcome}`);
}
if (rows.length > 0) {
  const head = ['', 'made', 'by hand', 'triangles', 'charts', 'overlap', 'used', 'inside', 'verdict', ''];
  console.log(table(head, rows));
}
