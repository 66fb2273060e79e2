// Draws cages and what they paint: a sheet per kind of figure, a grid as the texture, from the front, the side and the back.
//
//   npx tsx bench/cages/pictures.ts FOLDER SHEET.jpg [head|body|prop|NAME …]
//     FOLDER  subfolder of build/cages with NAME.json for each figure: made, fitted-auto, …
//
// Write the figures with scenes.ts before.

import { type Cell, drawCells } from '../quality/sheet.js';
import { writeCageGlb } from './cage-glb.js';
import { listFigures } from './figures.js';
import { has, read, type StoredCage, storedFigures } from './files.js';

const [folder, path, ...only] = process.argv.slice(2);
if (folder === undefined || path === undefined) throw new Error('say a folder of build/cages and a file for the sheet');

/** How a cell shows its model. */
type View = Pick<Cell, 'look' | 'turn' | 'rise' | 'upper'> & { head: string };
const front = { turn: 0, rise: 6 };
const views: View[] = [
  { head: 'cage', look: 'cage', ...front },
  { head: 'front', look: 'default', ...front },
  { head: 'side', look: 'default', turn: 90, rise: 6 },
  { head: 'back', look: 'default', turn: 180, rise: 10 },
];
/** Of the height of a body: its head and shoulders. */
const upper = 0.2;
const face: View = { head: 'face', look: 'default', ...front, turn: 20, upper };

const targets = new Map(listFigures().map(({ name, target }) => [name, target]));
const figures = storedFigures(only).filter(({ name }) => has(`${folder}/${name}`));
const hasBodies = figures.some(({ kind }) => kind === 'body');
const shown = hasBodies ? [...views, { ...face, head: 'cage', look: 'cage' as const }, face] : views;
const rows = [];
for (const { name } of figures) {
  const cage = writeCageGlb(`${folder}-${name}`, read<StoredCage>(`${folder}/${name}`));
  const cells = shown.map(
    ({ head: _, ...view }): Cell => ({ target: targets.get(name)!, cage, paint: undefined, ...view }),
  );
  rows.push({ name, cells });
}
const cell = { width: 340, height: hasBodies ? 420 : 320 };
await drawCells({ heads: shown.map(({ head }) => head), rows, cell }, path);
