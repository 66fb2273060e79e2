// Scores refined cages: the hand-made cage of each figure is moved or scaled, and brought back.
//
//   npx tsx bench/cages/score-refine.ts [--quick] [--all] [head|body|prop|NAME …]
//     --quick   moves of 3 % and scales of 0.97 and 1.03 only
//     --all     a line for each move, not the worst alone
//
// Runs build/release/bench/cagecast_cages_tool. Write the figures with scenes.ts before. Columns: suppressed / kept of the cage in
// place, moved, and refined; the mean distance of the refined cage's vertices from where they were, as % of the diagonal.

import { mkdirSync, writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { init } from 'cagecast';
import { table } from '../table.js';
import { cagesFolder } from './figures.js';
import { has, read, runTool, type StoredCage, type StoredModel, storedFigures } from './files.js';
import { mean, percent } from './measure.js';
import { type PaintScore, paintScore } from './paint-score.js';
import { diagonalOf } from './shape.js';

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: { quick: { type: 'boolean' }, all: { type: 'boolean' } },
});

/** A new place for a coordinate, and what it is called. */
type Move = [name: string, place: (x: number, axis: number) => number];

function movesOf({ positions }: StoredCage, diagonal: number): Move[] {
  const middle = [0, 1, 2].map((k) => mean(Array.from(positions).filter((_, i) => i % 3 === k)));
  const steps = options.quick ? [3] : [1, 2, 3];
  const moves = steps.flatMap((step) =>
    [0, 1, 2].flatMap((axis) =>
      [1, -1].map((sign): Move => {
        const by = (sign * step * diagonal) / 100;
        return [`${sign * step} % along ${'xyz'[axis]}`, (x, k) => (k === axis ? x + by : x)];
      }),
    ),
  );
  const scales = steps.flatMap((step) => [1 - step / 100, 1 + step / 100]);
  return [
    ['in place', (x) => x],
    ...moves,
    ...scales.map((scale): Move => [`scaled by ${scale}`, (x, k) => middle[k]! + scale * (x - middle[k]!)]),
  ];
}

const both = ({ suppressed, kept }: PaintScore): string => `${suppressed.toFixed(4)} / ${kept.toFixed(4)}`;

await init();
mkdirSync(`${cagesFolder}/refined`, { recursive: true });
const rows: string[][] = [];
for (const { name, truth } of storedFigures(positionals).filter(({ name }) => has(`${name}.cage`))) {
  const model = read<StoredModel>(`${name}.model`);
  const cage = read<StoredCage>(`${name}.cage`);
  const diagonal = diagonalOf(model.positions);
  const before = paintScore(cage, model, truth);
  const lines: { loss: number; row: string[] }[] = [];
  for (const [what, place] of movesOf(cage, diagonal)) {
    const moved = { ...cage, positions: Array.from(cage.positions, (x, i) => place(x, i % 3)) };
    const [from, to] = [`refined/${name}.from`, `refined/${name}`];
    writeFileSync(`${cagesFolder}/${from}.json`, JSON.stringify(moved));
    const outcome = await runTool(
      'refine',
      ...[from, `${name}.model`, to].map((file) => `${cagesFolder}/${file}.json`),
    );
    if (!outcome.endsWith('ok')) {
      lines.push({ loss: 2, row: [name, what, both(before), '', '', '', outcome] });
      continue;
    }
    const refined = read<StoredCage>(to);
    const after = paintScore(refined, model, truth);
    const loss = Math.max(before.suppressed - after.suppressed, before.kept - after.kept);
    const off = mean(
      Array.from({ length: cage.positions.length / 3 }, (_, v) =>
        Math.hypot(...[0, 1, 2].map((k) => refined.positions[3 * v + k]! - cage.positions[3 * v + k]!)),
      ),
    );
    const cells = [both(before), both(paintScore(moved, model, truth)), both(after), percent(off / diagonal), outcome];
    lines.push({ loss, row: [name, what, ...cells] });
  }
  const worst = lines.slice(1).sort((a, b) => b.loss - a.loss);
  rows.push(lines[0]!.row, ...(options.all ? worst : worst.slice(0, 1)).map(({ row }) => row));
}
if (rows.length > 0) console.log(table(['', '', 'in place', 'moved', 'refined', 'off', ''], rows));
