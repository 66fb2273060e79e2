import type { ExtractedMesh } from '../../state/model';
import { titleOfExpression } from './expression-names';
import { morphNames } from './morph-names';

/** An expression of a VRM file: weights of morphs, by name. */
export interface Expression {
  title: string;
  weights: ReadonlyMap<string, number>;
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

/** The expressions of a VRM 0 or VRM 1 file that move morphs; none for other files. */
export function expressionsOf({ parser }: Loaded, { primitives }: ExtractedMesh): Expression[] {
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
