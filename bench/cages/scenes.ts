// Writes every figure as JSON for `cagecast_cages_tool`, with what the scores need, into build/cages.
//
//   npx tsx bench/cages/scenes.ts
//
// Per figure: NAME.model.json (see bench/native/cages.cpp), NAME.cage.json (the hand-made cage, if there is one),
// NAME.landmarks.json (true ones), NAME.figure.json (truth and the like). Figures are the samples, whatever is in the folder
// that CAGECAST_ASSETS names, and the people in its subfolder `people`.

import { mkdirSync, writeFileSync } from 'node:fs';
import { readGlb } from '../read-glb.js';
import { cagesFolder, listFigures } from './figures.js';

mkdirSync(cagesFolder, { recursive: true });
const write = (name: string, value: unknown): void =>
  writeFileSync(`${cagesFolder}/${name}.json`, JSON.stringify(value));
const plain = (array: ArrayLike<number> | undefined): number[] | undefined => array && Array.from(array);

for (const { target, cage, landmarks, ...figure } of listFigures()) {
  const { mesh, parts, joints } = await readGlb(target);
  const found = mesh.positions.length / 3;
  if (found !== figure.truth.ncz.length)
    throw new Error(`${target} has ${found} vertices, its truth.json speaks of ${figure.truth.ncz.length}`);
  const { positions, indices, groups } = mesh;
  write(`${figure.name}.model`, {
    positions: plain(positions),
    indices: plain(indices),
    groups: plain(groups),
    parts,
    joints,
  });
  write(`${figure.name}.landmarks`, landmarks);
  write(`${figure.name}.figure`, figure);
  if (cage === undefined) continue;
  const { mesh: shell } = await readGlb(cage);
  write(`${figure.name}.cage`, {
    positions: plain(shell.positions),
    indices: plain(shell.indices),
    uvs: plain(shell.uvs),
    landmarks,
  });
}
