import type { Part } from '../../scene/extract.js';
import type { ImageCodec } from '../../scene/materials.js';
import { FileModel } from '../bake/bake-file.js';
import { type BakeInput, type BakeReport, bakeModel, isPainted } from '../bake/plan.js';
import type { GlbWriter } from '../glb-writer.js';
import { checkedDecode, hostDecode } from '../host-decode.js';
import type { GltfFile } from '../open-gltf.js';
import { type Paint, paintOf } from '../overlay.js';
import { coatsOfLook } from './coats.js';
import { composeLook, type Look } from './compose.js';
import { overlaidLook, withoutFringes } from './overlaid.js';
import { decodePng, encodePng } from './png.js';
import { type Regions, readSavedLayers } from './saved-layers.js';

/** What reads and writes images; by default, what the host has, and else a reader of PNGs and a writer of them. */
export interface Codec {
  decode?: ImageCodec['decode'] | undefined;
  encode?: ImageCodec['encode'] | undefined;
}

/** What a look is drawn on. */
interface Drawn extends Pick<BakeInput, 'result' | 'prepared' | 'size'> {
  file: GltfFile;
  parts: readonly Part[];
  /** Of the file. */
  writer: GlbWriter;
  /** Of the cage. */
  regions: Regions;
}

export { coatsOfLook } from './coats.js';

/** What is lost of a part that gets an overlay but no copy of its surface. */
const kOfVariants = 'its material has variants: neither the base tint nor what lies beneath the colours is shown';

/**
 * Reads and draws saved layers.
 * @throws {CagecastError} as `load` of layers does; for an image that cannot be read, too.
 */
export const readLook = (saved: unknown, regions: Regions, decode: ImageCodec['decode']): Promise<Look> =>
  composeLook(readSavedLayers(saved, regions), regions, decode);

/**
 * Draws a look into the textures of a file's materials.
 * @returns what was done, and what an overlay shows if some part cannot have all in textures of its own.
 */
export async function bakeLook(
  saved: unknown,
  { file, parts, writer, regions, ...input }: Drawn,
  { decode: given, encode = encodePng }: Codec,
): Promise<{ report: BakeReport; baked: Set<Part>; overlay: Paint | undefined }> {
  const decode = given ? checkedDecode('paintGlb', 'options.decode', given) : (hostDecode() ?? decodePng);
  const look = await readLook(saved, regions, decode);
  const codec = { decode, encode };
  const model = new FileModel(file, parts, writer);
  const coats = coatsOfLook(look);
  const done = await bakeModel(model, { ...input, coats, codec });
  const rest = parts.filter((part) => !done.baked.has(part) && isPainted(part, input.result));
  if (rest.length === 0 || Object.keys(coats).length === 0) return { ...done, overlay: undefined };
  const { tint, roughness, metalness, normal, glow } = look;
  if (tint || roughness || metalness || normal || glow)
    for (const part of rest)
      if (model.variantsOf(part).length > 0) done.report.left.push({ part: part.name, reason: kOfVariants });
  const bytes = await encodePng(
    look.color ? withoutFringes(look.color) : { width: 1, height: 1, data: new Uint8Array(4) },
  );
  const overlaid = await overlaidLook(look, model, rest, encodePng);
  return { ...done, overlay: { ...paintOf(bytes, 'look'), look: overlaid } };
}
