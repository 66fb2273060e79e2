// Draws the pictures of docs/cages.md.
//
//   CAGECAST_ASSETS=folder npx tsx bench/cages/guide.ts [landmarks|templates|make|fit|refine …] [--png]
//     --png  into build/cages, as PNG
//
// Uses the samples and the package's templates, and for fits the people in the given folder.

import { NodeIO } from '@gltf-transform/core';
import { init } from 'cagecast';
import { fitCage, makeCage, refineCage, terminate } from 'cagecast/cages';
import { cageTemplate } from 'cagecast/gltf';
import { root } from '../native.js';
import { type Cell, drawCells, type Sheet } from '../quality/sheet.js';
import { readGlb } from '../read-glb.js';
import { writeCageGlb } from './cage-glb.js';
import { cagesFolder } from './figures.js';
import { meshOf } from './paint-score.js';

const assets = process.env['CAGECAST_ASSETS'];
const human = `${root}examples/samples/human/target.glb`;
const headTemplate = `${root}examples/samples/templates/human-head.glb`;

async function modelOf(path: string) {
  const { mesh, parts, joints } = await readGlb(path);
  const { positions, indices, groups } = meshOf(mesh);
  return { positions, indices, ...(groups && { groups }), parts, joints };
}

const readTemplate = async (path: string) => cageTemplate(await new NodeIO().read(path));

const front = { turn: 16, rise: 6, paint: undefined };
const wide = { width: 400, height: 400 };

async function makeSheet(): Promise<Sheet> {
  const cage = writeCageGlb('guide-make', await makeCage(await modelOf(human)));
  const cell = (look: Cell['look'], turn: number): Cell => ({ target: human, cage, ...front, turn, look });
  return {
    heads: ['model', 'made cage', 'painted', 'from behind'],
    rows: [{ cells: [cell('plain', 16), cell('cage', 16), cell('default', 16), cell('default', 160)] }],
    cell: wide,
  };
}

async function landmarksSheet(): Promise<Sheet> {
  const { landmarks } = await readTemplate(headTemplate);
  const pick = (isShown: (name: string) => boolean) =>
    Object.fromEntries(Object.entries(landmarks).filter(([name]) => isShown(name)));
  const isOfSide = (name: string): boolean =>
    /crown|occiput|nape|menton|ear_.*left|forehead|nasion|glabella/.test(name);
  const shared = { target: human, cage: headTemplate, paint: undefined, rise: 0, look: 'plain' as const };
  const cells: Cell[] = [
    { ...shared, turn: 0, marks: pick((name) => !/^(crown|occiput|nape|ear_)/.test(name)) },
    { ...shared, turn: 90, marks: pick(isOfSide) },
  ];
  return { heads: ['front', 'left side'], rows: [{ cells }], cell: { width: 760, height: 640 } };
}

async function fitSheet(): Promise<Sheet> {
  if (assets === undefined) throw new Error('CAGECAST_ASSETS is not set: fits are shown on people');
  const template = await readTemplate(headTemplate);
  const rows: { name: string; cells: Cell[] }[] = [
    {
      name: 'template',
      cells: (['plain', 'cage', 'default'] as const).map(
        (look): Cell => ({ target: human, cage: headTemplate, ...front, look }),
      ),
    },
  ];
  for (const name of ['dora', 'emil', 'fumi']) {
    const target = `${assets}/people/${name}/head.glb`;
    const fit = await fitCage(template, await modelOf(target));
    const cage = writeCageGlb(`guide-fit-${name}`, fit.cage);
    const cells = (['plain', 'cage', 'default'] as const).map((look): Cell => ({ target, cage, ...front, look }));
    rows.push({ name: '', cells });
  }
  return { heads: ['model', 'cage', 'painted'], rows, cell: { width: 400, height: 360 } };
}

function templatesSheet(): Sheet {
  const cells = [
    { name: 'human-head', target: human, turn: 24 },
    { name: 'human-body', target: `${root}examples/samples/human-body/target.glb`, turn: 24 },
    { name: 'animal-head', target: `${root}examples/samples/animal-head/target.glb`, turn: 42 },
    { name: 'car', target: `${root}examples/samples/car/target.glb`, turn: 38 },
  ].map(({ name, ...view }): Cell => {
    const cage = `${root}examples/samples/templates/${name}.glb`;
    return { ...view, cage, paint: undefined, rise: 8, look: 'cage' };
  });
  return {
    heads: ['human-head', 'human-body', 'animal-head', 'car'],
    rows: [{ cells }],
    cell: { width: 400, height: 440 },
  };
}

/** How far off the cage is that is refined, as a share of its height. */
const off = 0.03;

async function refineSheet(): Promise<Sheet> {
  const { mesh } = await readGlb(`${root}examples/samples/human/cage.glb`);
  const heights = mesh.positions.filter((_, i) => i % 3 === 1);
  const shift = off * (Math.max(...heights) - Math.min(...heights));
  const moved = { ...meshOf(mesh), positions: mesh.positions.map((x, i) => (i % 3 === 1 ? x - shift : x)) };
  const refined = await refineCage({ ...moved, uvs: mesh.uvs! }, await modelOf(human));
  const before = writeCageGlb('guide-moved', { ...moved, uvs: mesh.uvs! });
  const after = writeCageGlb('guide-refined', refined);
  const paint = `${root}examples/samples/human/paint-skull.png`;
  const cells = [before, after].flatMap((cage) =>
    (['cage', 'default'] as const).map((look): Cell => ({ target: human, cage, ...front, paint, look })),
  );
  return { heads: ['cage out of place', 'painted', 'refined', 'painted'], rows: [{ cells }], cell: wide };
}

const sheets = {
  landmarks: landmarksSheet,
  templates: templatesSheet,
  make: makeSheet,
  fit: fitSheet,
  refine: refineSheet,
};
const words = process.argv.slice(2);
const only = words.filter((word) => word !== '--png');
await init();
for (const [name, sheet] of Object.entries(sheets)) {
  if (only.length > 0 && !only.includes(name)) continue;
  const path = words.includes('--png') ? `${cagesFolder}/guide-${name}.png` : `${root}docs/pictures/cages-${name}.jpg`;
  await drawCells(await sheet(), path);
}
terminate();
