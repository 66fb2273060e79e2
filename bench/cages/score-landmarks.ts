// Scores found landmarks: distance from the true ones, as % of the diagonal; a line per landmark, a column per figure.
//
//   npx tsx bench/cages/score-landmarks.ts [head|body|NAME …]
//
// Runs build/release/bench/cagecast_cages_tool. Write the figures with scenes.ts before. "?" stands for a landmark that is
// said to be missing, an empty cell for one that is neither found nor missing.

import { table } from '../table.js';
import { cagesFolder } from './figures.js';
import { read, runTool, type StoredModel, storedFigures } from './files.js';
import { mean, percent } from './measure.js';
import { diagonalOf } from './shape.js';

type Landmarks = Record<string, [number, number, number]>;
interface Found {
  landmarks: Landmarks;
  missing: string[];
  rig: string;
  kind: string;
}

const columns: { name: string; cells: Map<string, string>; errors: Map<string, number> }[] = [];
for (const { name } of storedFigures(process.argv.slice(2))) {
  const truth = read<Landmarks>(`${name}.landmarks`);
  if (Object.keys(truth).length === 0) continue;
  const [model, out] = [`${name}.model`, `${name}.found`].map((file) => `${cagesFolder}/${file}.json`);
  const outcome = await runTool('landmarks', model!, out!);
  console.log(`${name}: ${outcome}`);
  if (!outcome.endsWith('ok')) continue;
  const found = read<Found>(`${name}.found`);
  const size = diagonalOf(read<StoredModel>(`${name}.model`).positions);
  const column = { name, cells: new Map<string, string>(), errors: new Map<string, number>() };
  for (const missing of found.missing) column.cells.set(missing, '?');
  for (const [landmark, at] of Object.entries(found.landmarks)) {
    const there = truth[landmark];
    if (there === undefined) continue;
    const error = Math.hypot(...at.map((x, k) => x - there[k]!)) / size;
    column.cells.set(landmark, percent(error));
    column.errors.set(landmark, error);
  }
  column.cells.set('kind', found.kind).set('rig', found.rig);
  column.cells.set('MEAN', percent(mean([...column.errors.values()])));
  columns.push(column);
}
const names = [...new Set(columns.flatMap(({ cells }) => [...cells.keys()]))].sort();
const rows = names.map((name) => [
  name,
  ...columns.map(({ cells }) => cells.get(name) ?? ''),
  percent(mean(columns.flatMap(({ errors }) => errors.get(name) ?? []))),
]);
if (columns.length > 0) console.log(table(['', ...columns.map(({ name }) => name), 'mean'], rows));
