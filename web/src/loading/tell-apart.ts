import { ask } from '../platform/ask';
import { kCage } from '../state/intake';
import { paths } from './file-paths';
import { readGltfHead } from './gltf-file';

/**
 * Opens one of two models that came together, or both: as a model and its cage only if one of them says that it is a cage, by its name or
 * by what is in it. Otherwise people are asked.
 * @param both Opens them beside each other; undefined where that cannot be.
 */
export async function tellApart(
  files: readonly File[],
  open: (target: File, cage?: File) => void,
  both: (() => void) | undefined,
): Promise<void> {
  const [one, other] = files as [File, File];
  const [isCage, isOtherCage] = await Promise.all([saysCage(one), saysCage(other)]);
  if (isCage !== isOtherCage) return isCage ? open(other, one) : open(one, other);
  const [name, otherName] = namesOf(one, other);
  if (isCage) {
    ask({
      text: `${name} and ${otherName} are both cages. Which one is the model?`,
      answers: [
        { title: name, run: () => open(one, other) },
        { title: otherName, run: () => open(other, one) },
      ],
      isDialog: true,
    });
    return;
  }
  ask({
    text: both ? 'Open both?' : 'Which one?',
    answers: [
      ...(both ? [{ title: 'Wardrobe: one paint on both', run: both }] : []),
      { title: `Only ${name}`, run: () => open(one) },
      { title: `Only ${otherName}`, run: () => open(other) },
    ],
    isDialog: true,
  });
}

/** Their names; with their folders if they are the same. */
const namesOf = (...files: [File, File]): [string, string] =>
  files.map((file) => (files[0].name === files[1].name && paths.get(file)?.slice(1)) || file.name) as [string, string];

interface Head {
  nodes?: { name?: string; mesh?: number }[];
  meshes?: { primitives?: { attributes?: object }[] }[];
}

/** Whether a model is named as a cage, or all that it draws is, and has UVs. Cages that are made here are. */
async function saysCage(file: File): Promise<boolean> {
  if (kCage.test(file.name)) return true;
  try {
    const { nodes = [], meshes = [] } = readGltfHead(await file.arrayBuffer()).json as Head;
    const drawn = nodes.filter(({ mesh }) => mesh !== undefined);
    const hasUvs = meshes.every(({ primitives = [] }) =>
      primitives.every(({ attributes = {} }) => 'TEXCOORD_0' in attributes),
    );
    return hasUvs && drawn.length > 0 && drawn.every(({ name = '' }) => kCage.test(name));
  } catch {
    return false; // what is wrong with it is said when it is opened
  }
}
