import { matcher } from '#three';
import type { ExtractedMesh } from '../model';

/** What is known of each vertex of a model, as a 1 for yes. */
export interface Labels {
  /** Must not be painted. */
  ncz: Uint8Array;
  /** Not scored. */
  ignore: Uint8Array;
  /** The cage says nothing about it. */
  offCage: Uint8Array;
}

type Labelled = Pick<ExtractedMesh, 'positions' | 'groups' | 'names'>;

/**
 * Reads labels: an object of JSON whose `ncz`, and `ignore` and `offCage` if there are any, are a 0 or a 1 for each vertex, or names of
 * parts, with `*` for anything.
 * @param name Of the file, for errors.
 * @throws Error that says what is wrong and expected.
 */
export function readLabels(text: string, name: string, mesh: Labelled): Labels {
  let file: Record<string, unknown> | undefined;
  try {
    file = JSON.parse(text);
  } catch {
    // As below.
  }
  if (!file?.['ncz']) throw new Error(`${name}: no labels; an object of JSON is expected, such as {"ncz": ["*eye*"]}`);
  const of = (field: keyof Labels): Uint8Array => perVertex(file[field] ?? [], `${name}: ${field}`, mesh);
  return { ncz: of('ncz'), ignore: of('ignore'), offCage: of('offCage') };
}

function perVertex(given: unknown, what: string, { positions, groups, names }: Labelled): Uint8Array {
  const count = positions.length / 3;
  const values = typeof given === 'string' ? [...given] : Array.isArray(given) ? given : [given];
  if (typeof given !== 'string' && values.every((value) => typeof value === 'string')) {
    const meant = values.map((value) => matcher(value as string));
    const isMeant = names.map((all) => all.some((name) => meant.some((matches) => matches(name))));
    return Uint8Array.from(groups, (group) => Number(isMeant[group]));
  }
  if (values.some((value) => !/^[01]$/.test(String(value))))
    throw new Error(`${what}: names of parts are expected, or a 0 or a 1 for each vertex`);
  if (values.length !== count)
    throw new Error(`${what}: it has ${values.length} values, and the model ${count} vertices; one each is expected`);
  return Uint8Array.from(values, Number);
}
