/**
 * Makes the sample models into build/assets: `npm run assets [-- --force] [--templates] [model …]`.
 *
 * Nothing is made twice: a model is skipped while the sources it comes from are unchanged, unless --force is given. Models of
 * different sources are made at once, each in a process of its own. With --templates, the template cages are then copied to
 * examples/assets/templates, where the package takes them from.
 */
import { fork } from 'node:child_process';
import { createHash } from 'node:crypto';
import {
  copyFileSync,
  existsSync,
  mkdirSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  writeFileSync,
} from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { faultsOf } from './check.ts';
import { writeGlb } from './glb.ts';
import { drawTexture } from './image.ts';
import { triangleCount, withMeshNormals } from './mesh.ts';
import type { Model } from './model.ts';
import { animalHead } from './models/animal-head.ts';
import { car } from './models/car.ts';
import { human, humanFused, humanMisaligned } from './models/human.ts';
import { humanBody } from './models/human-body.ts';
import { lizard } from './models/lizard.ts';
import { templateFaults, writeTemplate } from './template.ts';
import { offCageOf, truthOf } from './truth.ts';

const here = dirname(fileURLToPath(import.meta.url));
const root = join(here, '../..');
const out = join(root, 'build/assets');
const kPaintSize = 1024;
const kRays = 256; // of a vertex, to see what of it is seen
const kFewRays = 64; // where a model is only to show that a template fits
const checkIn = process.argv.includes('--templates'); // put the templates where they are checked in

/**
 * Each model's maker, and the files in models/ that it comes from; those whose first file is the same are made in one process.
 * A sample that borrows paints comes after their owner. Some models are no samples: they only have a template made of them.
 */
const models: Record<string, { make: () => Model; sources: readonly [string, ...string[]]; isSample?: false }> = {
  lizard: { make: lizard, sources: ['lizard.ts'] },
  human: { make: human, sources: ['human.ts'] },
  'human-fused': { make: humanFused, sources: ['human.ts'] },
  'human-misaligned': { make: humanMisaligned, sources: ['human.ts'] },
  car: { make: car, sources: ['car.ts'] },
  'human-body': { make: humanBody, sources: ['human-body.ts', 'body.ts', 'human.ts'], isSample: false },
  'animal-head': { make: animalHead, sources: ['animal-head.ts'], isSample: false },
};

/** One entry of build/assets/index.json; paths are relative to build/assets. */
interface Entry {
  name: string;
  title: string;
  target: string;
  cage: string;
  truth: string;
  paints: { name: string; title: string; file: string }[];
}

/** A number of everything a model's bytes depend on: its sources, and the versions of the libraries they call. */
const fingerprint = (name: string): string => {
  const hash = createHash('sha256');
  const shared = readdirSync(here)
    .filter((f) => f.endsWith('.ts'))
    .sort();
  for (const file of [...shared, ...models[name]!.sources.map((f) => join('models', f))])
    hash.update(file).update(readFileSync(join(here, file)));
  for (const library of ['manifold-3d', 'meshoptimizer', '@gltf-transform/core', 'pngjs', 'three', 'three-mesh-bvh'])
    hash.update(JSON.parse(readFileSync(join(root, 'node_modules', library, 'package.json'), 'utf8')).version);
  return hash.digest('hex');
};

const write = async (model: Model, folder: string, lent: (name: string) => Entry['paints']): Promise<Entry> => {
  const target = await writeGlb(model.title, model.parts);
  const cage = {
    name: 'cage',
    mesh: withMeshNormals(model.cage),
    colour: [0.8, 0.8, 0.8, 1] as const,
    roughness: 0.9,
    ncz: false,
  };
  const cageGlb = await writeGlb(`${model.title}: cage`, [cage]);
  const isSample = models[model.name]!.isSample !== false;
  const truth = truthOf(model.parts, model.cage, model.inside, isSample ? kRays : kFewRays);
  const faults = await faultsOf(model, truth, { target, cage: cageGlb });
  if (faults.length > 0) throw new Error(`assets: ${model.name} is not as it should be:\n  ${faults.join('\n  ')}`);
  // Whatever has a target and a cage is taken for a sample.
  writeFileSync(join(folder, isSample ? 'target.glb' : 'model.glb'), target);
  if (isSample) writeFileSync(join(folder, 'cage.glb'), cageGlb);
  writeFileSync(join(folder, 'truth.json'), JSON.stringify(truth));
  if (model.template) {
    const bytes = await writeTemplate(model.template);
    const wrong = templateFaults(model.template, bytes);
    if (wrong.length > 0)
      throw new Error(`assets: ${model.template.name} is not as it should be:\n  ${wrong.join('\n  ')}`);
    writeFileSync(join(folder, 'template.glb'), bytes);
    writeFileSync(
      join(folder, 'template.json'),
      JSON.stringify({ offCage: offCageOf(model.parts, model.template.cage) }),
    );
  }
  const own = 'of' in model.paints ? [] : model.paints;
  for (const paint of own)
    writeFileSync(
      join(folder, `paint-${paint.name}.png`),
      drawTexture(cage.mesh, kPaintSize, paint.shade, paint.far, 2),
    );
  return {
    name: model.name,
    title: model.title,
    target: `${model.name}/target.glb`,
    cage: `${model.name}/cage.glb`,
    truth: `${model.name}/truth.json`,
    paints:
      'of' in model.paints
        ? lent(model.paints.of)
        : own.map(({ name, title }) => ({ name, title, file: `${model.name}/paint-${name}.png` })),
  };
};

const wanted = process.argv.slice(2).filter((a) => !a.startsWith('--'));
const force = process.argv.includes('--force');
const unknown = wanted.find((name) => !(name in models));
if (unknown !== undefined) {
  console.error(`assets: no model is called "${unknown}"; there are ${Object.keys(models).join(', ')}`);
  process.exit(2);
}

interface Made {
  print: string;
  entry: Entry;
  template?: string; // what its template.glb is called in the package
}

const stampOf = (name: string): string => join(out, name, 'made.json');

/** What was made of a model, if it was. */
const madeOf = (name: string): Made | undefined =>
  existsSync(stampOf(name)) ? JSON.parse(readFileSync(stampOf(name), 'utf8')) : undefined;

/** Makes a model aside and moves it into place whole, so that nobody finds half of one. */
const makeHere = async (name: string): Promise<void> => {
  const { make } = models[name]!;
  const started = performance.now();
  const folder = join(out, name);
  const aside = join(out, `.${name}-${process.pid}`);
  try {
    mkdirSync(aside, { recursive: true });
    const model = make();
    const entry = await write(model, aside, (other) => madeOf(other)?.entry.paints ?? []);
    const { template } = model;
    const made: Made = { print: fingerprint(name), entry, ...(template && { template: template.name }) };
    writeFileSync(join(aside, 'made.json'), JSON.stringify(made));
    rmSync(folder, { recursive: true, force: true });
    renameSync(aside, folder);
    const triangles = model.parts.reduce((n, p) => n + triangleCount(p.mesh), 0);
    console.log(
      `${name}: ${triangles} triangles, cage ${triangleCount(model.cage)}, ${((performance.now() - started) / 1000).toFixed(1)} s`,
    );
  } finally {
    rmSync(aside, { recursive: true, force: true });
  }
};

/** Makes models in a process of their own. @returns Whether that went well; else it has said why not. */
const makeAside = (names: string[]): Promise<boolean> =>
  new Promise((done) =>
    fork(fileURLToPath(import.meta.url), ['--force', ...names]).on('close', (code) => done(code === 0)),
  );

mkdirSync(out, { recursive: true });
const stale = Object.keys(models).filter((name) => {
  if (wanted.length > 0 && !wanted.includes(name)) return false;
  return force || madeOf(name)?.print !== fingerprint(name);
});
const sourceOf = (name: string): string => models[name]!.sources[0];
const sources = [...new Set(stale.map(sourceOf))];
if (sources.length > 1) {
  const went = await Promise.all(sources.map((source) => makeAside(stale.filter((name) => sourceOf(name) === source))));
  if (!went.every(Boolean)) process.exit(1);
} else for (const name of stale) await makeHere(name);

const list = join(out, `.index-${process.pid}.json`);
const samples = Object.keys(models).filter((name) => models[name]!.isSample !== false);
const index = samples.flatMap((name) => madeOf(name)?.entry ?? []);
writeFileSync(list, `${JSON.stringify(index, null, 2)}\n`);
renameSync(list, join(out, 'index.json'));

for (const name of checkIn ? Object.keys(models) : []) {
  const template = madeOf(name)?.template;
  if (template) copyFileSync(join(out, name, 'template.glb'), join(here, 'templates', `${template}.glb`));
}
