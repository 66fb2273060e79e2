import type { TransferResult } from '../../api/index.js';
import { CagecastError } from '../../core/error.js';
import type { PreparedPart } from '../../parts/prepare.js';
import type { BakeReport } from '../bake/plan.js';
import { removeOverlays } from '../earlier-in-file.js';
import { type Form, GlbWriter } from '../glb-writer.js';
import type { Regions, SavedLayers } from '../look/saved-layers.js';
import type { Paint } from '../overlay.js';
import type { ReadModel } from '../read-model.js';
import type { PaintOptions } from './options.js';

/** How a look is written. */
interface LookWriting extends Pick<PaintOptions, 'size' | 'decode' | 'encode'> {
  result: TransferResult;
  prepared: readonly PreparedPart[];
  /** Of the cage. */
  regions: Regions;
  form: Form;
  /** Reads the file with what is painted by then. */
  read: (painted: Uint8Array) => Promise<ReadModel>;
  /** Writes overlays. */
  write: (model: ReadModel, parts: readonly PreparedPart[], shown: Paint) => Promise<{ data: Uint8Array }>;
}

/** A model with a look in its own textures, and its colours in overlays where it has none. */
export async function withLook(
  look: SavedLayers,
  { file, extracted: { parts } }: ReadModel,
  { result, prepared, regions, size, form, read, write, ...codec }: LookWriting,
): Promise<{ data: Uint8Array } & Pick<BakeReport, 'left' | 'moving'>> {
  // A file of its own, which is only loaded for a look.
  const { bakeLook } = await import('../look/index.js');
  const writer = await GlbWriter.from(file, form);
  removeOverlays(
    writer,
    file,
    parts.map(({ mesh }) => writer.json.meshes![mesh]!),
  );
  const {
    report: { left, moving },
    baked,
    overlay,
  } = await bakeLook(
    look,
    { file, parts, writer, regions, result, size, prepared: (part) => prepared[parts.indexOf(part)]! },
    codec,
  ).catch((error: unknown) => {
    if (!(error instanceof CagecastError) || error.fn === 'paintGlb') throw error;
    throw new CagecastError(error.code, 'paintGlb', error.reason, { argument: 'look', cause: error });
  });
  const data = writer.finish();
  const rest = prepared.map((one, p) =>
    baked.has(parts[p]!) ? { ...one, cosmeticTriangles: new Uint8Array(one.cosmeticTriangles.length) } : one,
  );
  if (!overlay) return { data, left, moving };
  return { data: (await write(await read(data), rest, overlay)).data, left, moving };
}
