// Draws cages and what they paint: a sheet per kind of figure, a grid as the texture, from the front, the side and the back.
//
//   npx tsx bench/cages/pictures.ts FOLDER SHEET.jpg [head|body|prop|NAME …]
//     FOLDER  subfolder of build/cages with NAME.json for each figure: made, fitted-auto, …
//
// Write the figures with scenes.ts before.

import { mkdirSync, writeFileSync } from 'node:fs';
import { Document, NodeIO } from '@gltf-transform/core';
import { type Cell, drawCells } from '../quality/sheet.js';
import { cagesFolder, listFigures } from './figures.js';
import { has, read, type StoredCage, storedFigures } from './files.js';

const [folder, path, ...only] = process.argv.slice(2);
if (folder === undefined || path === undefined) throw new Error('say a folder of build/cages and a file for the sheet');

/** Writes a cage as GLB, for three.js. @returns its path. */
async function glbOf(name: string): Promise<string> {
  const { positions, uvs, indices } = read<StoredCage>(`${folder}/${name}`);
  const document = new Document();
  const buffer = document.createBuffer();
  const accessor = (array: Float32Array<ArrayBuffer> | Uint32Array<ArrayBuffer>, type: 'VEC3' | 'VEC2' | 'SCALAR') =>
    document.createAccessor().setBuffer(buffer).setArray(array).setType(type);
  const primitive = document
    .createPrimitive()
    .setAttribute('POSITION', accessor(Float32Array.from(positions), 'VEC3'))
    .setAttribute('TEXCOORD_0', accessor(Float32Array.from(uvs), 'VEC2'))
    .setIndices(accessor(Uint32Array.from(indices), 'SCALAR'));
  const node = document.createNode('cage').setMesh(document.createMesh('cage').addPrimitive(primitive));
  document.createScene().addChild(node);
  mkdirSync(`${cagesFolder}/glb`, { recursive: true });
  const file = `${cagesFolder}/glb/${folder}-${name}.glb`;
  writeFileSync(file, await new NodeIO().writeBinary(document));
  return file;
}

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
  const cage = await glbOf(name);
  const cells = shown.map(
    ({ head: _, ...view }): Cell => ({ target: targets.get(name)!, cage, paint: undefined, ...view }),
  );
  rows.push({ name, cells });
}
const cell = { width: 340, height: hasBodies ? 420 : 320 };
await drawCells({ heads: shown.map(({ head }) => head), rows, cell }, path);
