import type { Document } from '@gltf-transform/core';
import {
  type CutTarget,
  cutBorders,
  init,
  type Mesh,
  type TransferOptions,
  type TransferResult,
  transfer,
} from '../../api/index.js';
import { faultOfParts, type Parts } from '../../api/parts.js';
import { CagecastError, show } from '../../core/error.js';
import { plainArray } from '../../core/typed-arrays.js';
import { moved, type Origin } from '../../parts/origin.js';
import { hasCages, moveApart } from '../../parts/own-cages.js';
import { extrasIn, partsWithout } from '../../scene/cage-model.js';
import { type Extracted, extract } from '../../scene/extract.js';
import { InputError } from '../../scene/input-error.js';
import { isUvSetNumber, uvSetNumberText } from '../../scene/uv-sets.js';
import { type MaskSources, masksOf } from '../bake/mask-sources.js';
import { type Paint, paintOf } from '../overlay.js';
import { DocumentModel } from './document-model.js';
import { DocumentSource } from './document-source.js';

/** Options of a transfer from a cage to a document. */
interface DocumentTransferOptions extends Omit<TransferOptions, 'parts'>, MaskSources {
  cage?: Document | Mesh | undefined;
  cageUvs?: number | undefined;
  texture?: Uint8Array | undefined;
  parts?: Parts | undefined;
}

/** A transfer to a document, which is not changed by it. */
interface DocumentTransfer {
  target: ExtractedDocument;
  /** The cage as it was given, around the origin of the target. */
  around: Mesh;
  model: DocumentModel;
  result: TransferResult;
  /** With borders that are cut. */
  cut: CutTarget | undefined;
  paint: Paint | undefined;
}

/**
 * Transfers a cage's UVs to a document.
 * @param caller The function that errors name.
 * @throws {CagecastError} that names the argument, the element and the value.
 */
export async function transferDocument(
  caller: string,
  document: Document,
  given: DocumentTransferOptions,
  cuts: boolean,
): Promise<DocumentTransfer> {
  const { cage, cageUvs, texture, parts, maskImages, maskColors, ...options } = given;
  if (cage !== undefined && (typeof cage !== 'object' || cage === null))
    throw wrong(caller, 'cage', cage, 'a document or a mesh');
  const image = texture && plainArray(texture, 'Uint8Array');
  if (texture !== undefined && !image) throw wrong(caller, 'texture', texture, 'a Uint8Array');
  if (cageUvs !== undefined && !isUvSetNumber(cageUvs)) throw wrong(caller, 'cageUvs', cageUvs, uvSetNumberText);
  const fault = faultOfParts(caller, parts);
  if (fault !== undefined) throw new CagecastError('badOption', caller, fault);
  if (Object.keys(maskImages ?? {}).some((name) => name !== 'never' && name !== 'always'))
    throw wrong(caller, 'maskImages', maskImages, '{ never, always }');
  await init();
  const paint = image && within(caller, 'texture', () => paintOf(image));
  const target = read(caller, 'target', document, () => extractDocument(document, 'own', parts));
  const { origin } = target;
  const around = isDocument(cage ?? document)
    ? within(caller, 'cage', () => extractDocument((cage ?? document) as Document, origin, 'cage', cageUvs))
    : { mesh: moved(cage as Mesh, origin), parts: [], source: undefined };
  if (cage === undefined && !hasCages(around.parts)) throw wrong(caller, 'cage', cage, kNoCage);
  const apart = within(caller, 'target', () => moveApart(around, target, (text) => new InputError(text)));
  const [source, own] = [apart?.cage ?? around.mesh, apart?.target ?? target.mesh];
  const model = new DocumentModel(document, target.source, target.parts);
  const masks = within(caller, 'target', () =>
    masksOf(model, options.masks, { images: maskImages, colors: maskColors }),
  );
  const extras = around.source ? extrasIn(around.source, around.parts) : [];
  const bare = [...target.accessories, ...partsWithout(target.source, target.parts, [cage, ...extras])];
  const rules = { ...options, masks, parts: { keep: target.kept, exclude: [...bare, ...target.excluded] } };
  const result = transfer(source, own, rules);
  const cut = cuts ? cutBorders(source, own, result, rules) : undefined;
  apart?.mend(result);
  return { target, around: around.mesh, model, result, cut, paint };
}

/** The triangles of a document's scene, and the document as they are read of it. */
export interface ExtractedDocument extends Extracted {
  source: DocumentSource;
}

function extractDocument(
  document: Document,
  origin: Origin,
  whichCount: Parts | 'cage' | undefined,
  cageUvs?: number,
): ExtractedDocument {
  const source = new DocumentSource(document, undefined, cageUvs);
  return { ...extract(source, origin, whichCount), source };
}

/** What a cage has to be. */
const kNoCage = 'a document or a mesh, and no mesh of the target is named as its outer cage: Head_OuterCage';

/** The error of an argument, or of a member of one, of the wrong type. @param name  As in "cage.positions". */
export const wrong = (caller: string, name: string, value: unknown, type: string) =>
  new CagecastError('badArgument', caller, `${name} is ${show(value)}, not ${type}`, { argument: name.split('.')[0] });

export const isDocument = (value: unknown): value is Document =>
  typeof (value as Document | null | undefined)?.getRoot === 'function';

/** Reads a document, if it is one. Errors name the argument. */
export function read<T>(caller: string, argument: string, document: unknown, work: () => T): T {
  if (!isDocument(document)) throw wrong(caller, argument, document, 'a document of glTF-Transform');
  return within(caller, argument, work);
}

/** Names the argument in errors of a file or document. */
export function within<T>(caller: string, argument: string, read: () => T): T {
  try {
    return read();
  } catch (error) {
    throw ofArgument(caller, argument, error);
  }
}

/** An error that names the argument, if it is of a file or document; any other as it is. */
export const ofArgument = (caller: string, argument: string, error: unknown): unknown =>
  error instanceof InputError
    ? new CagecastError('badArgument', caller, `${argument}: ${error.message}`, { argument, cause: error })
    : error;
