// What the page needs for files that are not its own: it loads when there is one.
import { checkGltf, checkImage, fileKind } from 'cagecast/gltf';
import { reasonOf } from '../state/wording';
import { companionOf } from './file-paths';

export { embeddedIn } from '../platform/embedded';

export { damageOf } from './image-damage';

/** Refuses a file that the loader, which trusts it, would take all memory for. @throws Error without the file's name. */
export async function checkCost(bytes: ArrayBuffer, companions: readonly File[]): Promise<void> {
  try {
    checkGltf(new Uint8Array(bytes), { otherBytes: companions.reduce((sum, { size }) => sum + size, 0) });
    for (const companion of companions) checkImage(new Uint8Array(await companion.arrayBuffer()));
  } catch (error) {
    throw new Error(reasonOf(error), { cause: error });
  }
}

/** Refuses a picture whose pixels would take all memory. @returns the size that it says to have. @throws Error that names the file. */
export async function checkPicture(file: File): Promise<ReturnType<typeof checkImage>> {
  const bytes = await file.arrayBuffer().catch(() => new ArrayBuffer(0)); // what decodes it says what is wrong
  try {
    return checkImage(new Uint8Array(bytes));
  } catch (error) {
    throw new Error(`${file.name}: ${reasonOf(error)}`, { cause: error });
  }
}

/** Pixels that the images and paintings of a project may have together, whatever its size: what its layers have at most as the page shows them. */
const kMaxPixels = 2 ** 27;
/** As `expansion` of `checkGltf`: how many times larger than its files they may be. */
const kExpansion = 100;

/**
 * Refuses pictures that would take all memory together, before any of them is decoded.
 * @param painted  The files of paintings, and their pixels.
 * @throws Error that names the file, its pixels and the limit.
 */
export async function checkPictures(
  files: readonly File[],
  painted: { files: readonly File[]; pixels: number },
): Promise<void> {
  let pixels = painted.pixels;
  // A file that is used again is decoded again, but its bytes count once.
  const bytes = [...new Set([...files, ...painted.files])].reduce((sum, { size }) => sum + size, 0);
  const most = Math.max(kMaxPixels, (kExpansion * bytes) / 4);
  for (const file of files) {
    const { width, height } = (await checkPicture(file)) ?? { width: 0, height: 0 };
    pixels += width * height;
    if (pixels <= most) continue;
    const [w, h, all, limit] = [width, height, pixels, most].map((n) => Math.floor(n).toLocaleString('en'));
    throw new Error(`${file.name}: it has ${w} × ${h} pixels; up to it, the layers have ${all}, more than ${limit}`);
  }
}

/**
 * A model and its bytes; those of the GLB that is made of it, if it has another format.
 * @param signal  Ends the reading.
 * @throws Error without the file's name.
 */
export async function readAsGltf(
  file: File,
  companions: readonly File[],
  signal: AbortSignal | undefined,
): Promise<{ file: File; bytes: ArrayBuffer }> {
  const bytes = await file.arrayBuffer().catch(() => {
    throw new Error(
      `the browser cannot read this file (${(file.size / 1e6).toLocaleString('en', { maximumFractionDigits: 1 })} MB); it may be too large, or deleted`,
    );
  });
  const kind = fileKind(new Uint8Array(bytes));
  if (!kind) return { file, bytes };
  if (!kind.format) throw new Error(`this is ${kind.name}; ${kind.advice}`);
  const read = async (name: string) => {
    const found = companionOf(name, companions, file);
    return found && new Uint8Array(await found.arrayBuffer());
  };
  const { toGlb } = await import('cagecast/gltf');
  const glb = (await toGlb(new Uint8Array(bytes), { read, signal })) as Uint8Array<ArrayBuffer>;
  const made = new File([glb], `${file.name.replace(/\.[^.]*$/, '')}.glb`);
  return { file: made, bytes: glb.buffer };
}
