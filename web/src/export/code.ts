import { type Lock, presetOptions } from 'cagecast';
import { asLock, type Locks, type Rules } from '../state/choices';
import { namesLeftOut, numbersWithout } from '../state/left-out';
import type { Shown } from '../state/scene';
import type { Session } from '../state/session';

/** Code that reproduces the view. */
export interface Code {
  three: string;
  command: string;
}

/** Generates code for the current scene and options, for three.js and for the command line. Needs `init`. */
export function codeFor({ shown, rules, locks, bare }: Session): Code {
  const noted = (code: string, comment: string): string => (bare ? `${comment} ${kMarked}\n${code}` : code);
  return {
    three: noted(threeCode(shown!, rules, locks), '//'),
    command: noted(commandLine(shown!, rules, locks), '#'),
  };
}

const kMarked = 'What you marked to stay bare is not in it: give masks, too.';

function threeCode(shown: Shown, rules: Rules, locks: Readonly<Locks>): string {
  const { target, cage, projection } = shown;
  const { preset, threshold, weldTolerance, borders } = nonDefault(rules);
  const nameOf = (group: number) => target.mesh.primitives[group]!.mesh.name;
  const [keep, exclude] = kLocks.map((lock) => partsLocked(shown, locks, lock, nameOf).whole) as [string[], string[]];
  const lists = Object.entries({ ignore: projection.leftOut.map(nameOf), keep, exclude }).flatMap(([list, names]) =>
    names.length > 0 ? [`${list}: [${[...new Set(names)].map((name) => JSON.stringify(name)).join(', ')}]`] : [],
  );
  const numbers = numbersWithout(projection);
  const segments = Object.entries(locks).flatMap(([segment, lock]) => {
    const number = numbers[Number(segment)];
    if (lock === 'auto' || number === undefined) return [];
    const name = nameOf(projection.segmentStats[Number(segment)]!.group);
    return keep.includes(name) || exclude.includes(name) ? [] : [`${number}: '${asLock(lock)}'`];
  });
  const options = [
    'cage',
    'texture',
    ...(preset ? [`preset: '${preset}'`] : []),
    ...(threshold === undefined ? [] : [`threshold: ${threshold}`]),
    ...(weldTolerance ? [`weldTolerance: ${weldTolerance}`] : []),
    ...(borders ? [`borders: '${borders}'`] : []),
    ...(lists.length > 0 ? [`parts: { ${lists.join(', ')} }`] : []),
    ...(segments.length > 0 ? [`locks: { ${segments.join(', ')} }`] : []),
  ];
  return `${noteOn(locks, '//')}import { init } from 'cagecast'
import { applyTransfer } from 'cagecast/three'
import { SRGBColorSpace, TextureLoader } from 'three'
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js'

await init()
const loader = new GLTFLoader()
const files = [${JSON.stringify(target.name)}, ${JSON.stringify(cage.name)}]
const [target, cage] = await Promise.all(files.map((file) => loader.loadAsync(file)))
const texture = await new TextureLoader().loadAsync('paint.png')
texture.flipY = false
texture.colorSpace = SRGBColorSpace
applyTransfer(target, { ${options.join(', ')} })
scene.add(target.scene)`;
}

function commandLine(shown: Shown, rules: Rules, locks: Readonly<Locks>): string {
  const { preset, threshold, weldTolerance, borders } = nonDefault(rules);
  const words = [
    'npx cagecast transfer',
    shell(shown.target.name),
    '--cage',
    shell(shown.cage.name),
    '--texture paint.png',
  ];
  if (preset) words.push(`--set preset=${preset}`);
  if (threshold !== undefined) words.push(`--threshold ${threshold}`);
  if (weldTolerance) words.push(`--set weldTolerance=${weldTolerance}`);
  if (borders) words.push(`--borders ${borders}`);
  for (const name of new Set(namesLeftOut(shown))) words.push(`--ignore ${shell(name)}`);
  const partly: string[] = [];
  for (const lock of kLocks) {
    const { whole, some } = partsLocked(shown, locks, lock);
    for (const name of whole) words.push(`--${lock} ${shell(name)}`);
    partly.push(...some);
  }
  const note =
    partly.length > 0 ? `# The command can only lock whole parts; you locked pieces of ${partly.join(', ')}.\n` : '';
  return `${noteOn(locks, '#')}${note}${words.join(' ')} -o painted.glb`;
}

/** What the code leaves out. */
const noteOn = (locks: Readonly<Locks>, comment: string): string =>
  Object.values(locks).includes('always')
    ? `${comment} Parts that you paint anyway are only kept here: give masks, too.\n`
    : '';

const kLocks = ['keep', 'exclude'] as const;

/** The meshes with this lock on all of their segments that have area, or on some. */
function partsLocked(
  { target, projection }: Shown,
  locks: Readonly<Locks>,
  lock: Lock,
  nameOf = (group: number): string => target.mesh.primitives[group]!.name,
): { whole: string[]; some: string[] } {
  const [locked, others] = [new Set<string>(), new Set<string>()];
  projection.segmentStats.forEach(({ group, area }, segment) => {
    // What is left out has no area.
    if (area > 0) (asLock(locks[segment] ?? 'auto') === lock ? locked : others).add(nameOf(group));
  });
  return {
    whole: [...locked].filter((name) => !others.has(name)),
    some: [...locked].filter((name) => others.has(name)),
  };
}

/** The options that differ from the defaults. */
function nonDefault({ preset, threshold, weldTolerance, borders }: Rules): Partial<Rules> {
  return {
    ...(preset !== 'default' && { preset }),
    ...(threshold !== presetOptions(preset).threshold && { threshold }),
    ...(weldTolerance > 0 && { weldTolerance }),
    ...(borders !== 'triangle' && { borders }),
  };
}

/** Quotes a word for a shell. */
const shell = (word: string): string =>
  /^[\w.,:/@+-]+$/.test(word) ? word : `'${word.replaceAll("'", String.raw`'\''`)}'`;
