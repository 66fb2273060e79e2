import type { ExtractedMesh } from '../../state/model';
import { titleOfExpression } from './expression-names';
import { guessed, moods, vowelsOf } from './guess-expressions';
import { morphNames, type Weights } from './morph-names';

/** What a face can show: weights of morphs, by name. */
export interface Expression {
  title: string;
  /** Where motion is not wanted, or if it has no sequence. */
  weights: Weights;
  /** Shapes that follow each other, at their seconds; it begins and ends at rest. */
  sequence?: readonly (readonly [at: number, weights: Weights])[];
}

/** What is said of a morph in the file. */
interface Bind {
  node?: number;
  mesh?: number;
  index: number;
  /** 0 to 1. */
  weight: number;
}

interface Named {
  name: string;
  binds: Bind[];
}

/** What of a loaded file says which expressions it has. */
interface Loaded {
  parser?:
    | {
        associations?: { get(object: object): { nodes?: number; meshes?: number } | undefined } | undefined;
        json?: { extensions?: object } | undefined;
      }
    | undefined;
}

const kBlink = [0.09, 0.15, 0.32]; // seconds: shut, still shut, open
/** What is said, by its vowels; the mouth closes at spaces. Each takes that many seconds. */
const [kSpeech, kSyllable] = ['ao ie au oea ei o', 0.16];

/** Smile, Blink and Speak first, then what a VRM file calls expressions, or what the names of other files' morphs tell. */
export function expressionsOf(loaded: Loaded, mesh: ExtractedMesh): Expression[] {
  const names = [...new Set(mesh.primitives.flatMap(({ mesh }) => morphNames(mesh)))];
  const own = new Map(vrmExpressions(loaded, mesh).map(({ title, weights }) => [title, weights]));
  const smile = own.get('Happy') ?? guessed('Smile', names);
  const blink = own.get('Blink') ?? guessed('Blink', names);
  const vowels = new Map(vowelsOf(names));
  for (const [letter, title] of Object.entries({ a: 'Aa', e: 'Ee', i: 'Ih', o: 'Oh', u: 'Ou' }))
    if (own.has(title)) vowels.set(letter, own.get(title)!);
  const rest: Weights = new Map();
  const [first] = vowels.values();
  const speech = [...kSpeech].map((letter, i) => {
    const weights = letter === ' ' ? rest : (vowels.get(letter) ?? first!);
    return [(i + 1) * kSyllable, weights] as const;
  });
  for (const title of ['Happy', 'Blink']) own.delete(title); // they are there by the names of all models
  if (own.size === 0) for (const title of moods) own.set(title, guessed(title, names) ?? rest);
  const [shut, still, open] = kBlink as [number, number, number];
  return [
    ...(smile ? [{ title: 'Smile', weights: smile }] : []),
    ...(blink
      ? [
          {
            title: 'Blink',
            weights: blink,
            sequence: [[shut, blink] as const, [still, blink] as const, [open, rest] as const],
          },
        ]
      : []),
    ...(first
      ? [{ title: 'Speak', weights: first, sequence: [...speech, [(speech.length + 1) * kSyllable, rest] as const] }]
      : []),
    ...[...own].flatMap(([title, weights]) => (weights.size > 0 ? [{ title, weights }] : [])),
  ];
}

/** The expressions of a VRM 0 or VRM 1 file that move morphs; none for other files. */
function vrmExpressions({ parser }: Loaded, { primitives }: ExtractedMesh): Expression[] {
  const extensions = parser?.json?.extensions as Record<string, unknown> | undefined;
  const named = [...vrm1(extensions?.VRMC_vrm), ...vrm0(extensions?.VRM)];
  if (named.length === 0) return [];
  return named.flatMap(({ name, binds }) => {
    const weights = new Map<string, number>();
    for (const { mesh } of primitives) {
      const names = morphNames(mesh);
      const found = parser?.associations?.get(mesh);
      // Several primitives of a mesh are in a group, which stands for the node.
      const nodeIndex = found?.nodes ?? parser?.associations?.get(mesh.parent ?? mesh)?.nodes;
      const isOf = ({ node, mesh: index }: Bind): boolean =>
        node === undefined ? found?.meshes === index : nodeIndex === node;
      for (const bind of binds)
        if (isOf(bind) && names[bind.index] !== undefined && bind.weight > 0)
          weights.set(names[bind.index]!, Math.min(1, bind.weight));
    }
    return weights.size > 0 ? { title: titleOfExpression(name), weights } : [];
  });
}

/** The expression of these weights, however they were set; not a passing one. */
export const shownBy = (expressions: readonly Expression[], weights: Weights): Expression | undefined =>
  expressions.find(
    ({ sequence, weights: own }) =>
      !sequence && own.size > 0 && [...own].every(([name, weight]) => weights.get(name) === weight),
  );

const isRecord = (value: unknown): value is Record<string, unknown> => typeof value === 'object' && value !== null;
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
const toBind = (value: unknown, most: number): Bind[] =>
  isRecord(value) && Number.isInteger(value.index) && typeof value.weight === 'number'
    ? [{ ...(value as { node?: number; mesh?: number }), index: value.index as number, weight: value.weight / most }]
    : [];

function vrm1(extension: unknown): Named[] {
  const expressions = isRecord(extension) && isRecord(extension.expressions) ? extension.expressions : {};
  return [expressions.preset, expressions.custom].flatMap((group) =>
    Object.entries(isRecord(group) ? group : {}).map(([name, expression]) => ({
      name,
      binds: list(isRecord(expression) && expression.morphTargetBinds).flatMap((bind) => toBind(bind, 1)),
    })),
  );
}

function vrm0(extension: unknown): Named[] {
  const master = isRecord(extension) && isRecord(extension.blendShapeMaster) ? extension.blendShapeMaster : {};
  return list(master.blendShapeGroups).flatMap((group) => {
    if (!isRecord(group)) return [];
    const { presetName, name } = group;
    const called = [presetName, name].find((one) => typeof one === 'string' && one !== '' && one !== 'unknown');
    // Weights of VRM 0 are percentages.
    return called ? { name: called as string, binds: list(group.binds).flatMap((bind) => toBind(bind, 100)) } : [];
  });
}
