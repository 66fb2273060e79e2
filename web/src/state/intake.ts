/** Files that were chosen or dropped together. */
export interface Intake {
  target?: File | undefined;
  cage?: File | undefined;
  texture?: File | undefined;
  /** An image that came alone: a paint or a sticker, by its size. */
  image?: File | undefined;
  /** A saved project: everything at once. */
  project?: File | undefined;
  /** Two models whose names do not say which is a cage, or whether any is. */
  unclear: File[];
  /** Warnings to show. */
  warnings: string[];
  /** All files: a model finds its .bin, .mtl and images here. */
  all: File[];
}

export const kModel = /\.(glb|gltf|vrm|fbx|obj|ply|stl|usd[acz]?)$/i;
const kForeign = /\.(blend|dae)$/i;
export const kProject = /\.cagecast$/i;
export const kCage = /cage/i;
export const kImage = /\.(png|jpe?g|webp)$/i;

/** The models among files: those that are named as cages, and the others. */
export function modelsAmong(files: readonly File[]): { cages: File[]; targets: File[] } {
  const models = files.filter(({ name }) => kModel.test(name));
  return {
    cages: models.filter(({ name }) => kCage.test(name)),
    targets: models.filter(({ name }) => !kCage.test(name)),
  };
}

/**
 * Assigns files to roles: models by their names, images with them as paint unless a .gltf, or the .mtl of an .obj, came with them.
 * A model of another format, or any other file if there is nothing else, becomes the target, so that the reader reports what is wrong with it.
 */
export function sortFiles(all: readonly File[]): Intake {
  const { cages, targets: rest } = modelsAmong(all);
  const models = all.filter(({ name }) => kModel.test(name));
  const others = all.filter((file) => !models.includes(file));
  // The images belong to these.
  const withImages = all.some(({ name }) => /\.(gltf|mtl)$/i.test(name));
  const images = withImages ? [] : others.filter(({ name, type }) => kImage.test(name) || type.startsWith('image/'));
  const project = others.find(({ name }) => kProject.test(name));
  if (project) return { project, unclear: [], warnings: [], all: [...all] };
  const intake: Intake = { texture: images.at(-1), unclear: [], warnings: [], all: [...all] };
  const known = cages.length === 1 || (cages.length > 0 && rest.length > 0) || models.length === 1;
  if (known) [intake.cage, intake.target] = [cages[0], rest[0]];
  else if (models.length > 1) intake.unclear = models.slice(0, 2);
  else intake.target = others.find(({ name }) => kForeign.test(name)) ?? (images.length > 0 ? undefined : others[0]);

  if (models.length === 0 && !intake.target) {
    intake.image = intake.texture;
    intake.texture = undefined;
  }
  const used = [intake.target, intake.cage, intake.texture, intake.image, ...intake.unclear];
  const [left, ...more] = (withImages ? models : all).filter((file) => !used.includes(file));
  if (left)
    intake.warnings.push(
      `${left.name}${more.length > 0 ? ` and ${more.length} more were` : ' was'} ignored: only one target, one cage and one paint can be opened at a time.`,
    );
  return intake;
}
