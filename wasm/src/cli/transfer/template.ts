import { statSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { isTemplateName, templateNames } from '../../cages/template-names.js';
import type { Landmarks, Template } from '../../cages/types.js';
import { withUvs } from '../../gltf/read-model.js';
import { counted } from '../../inspect/finding.js';
import { readObj } from '../../parts/obj.js';
import { isPosition, readTemplate as withExtras } from '../../parts/template-extras.js';
import { templateOf } from '../../scene/cage-model.js';
import { InputError, naming } from '../../scene/input-error.js';
import { readBytes, standard } from '../io/files.js';
import type { Io } from '../io/io.js';
import { parseObject } from '../model/json.js';
import type { ReadOptions } from '../model/reading.js';
import { kAutoCage } from '../model/sources.js';
import { shown } from '../model/text.js';
import { readModel } from './models.js';

/** Whether a template is none that has to be read from a file of the user's. */
export const isKnownTemplate = (text: unknown): boolean =>
  typeof text === 'string' && (text === kAutoCage || isTemplateName(text));

/** How many landmarks `fitCage` needs of a template. */
const kMinLandmarks = 4;

/**
 * Reads a template with its landmarks.
 * @param templateLandmarks  A file of them, if they are not in the template.
 * @throws {InputError} that names the file at fault.
 */
export async function readTemplate(
  path: string,
  reading: ReadOptions,
  io: Io,
  templateLandmarks?: string,
): Promise<Template> {
  const own = isObj(path) ? await readObjTemplate(path, io) : await readGltfTemplate(path, reading, io);
  const landmarks = templateLandmarks === undefined ? own.landmarks : await readLandmarks(templateLandmarks);
  const count = Object.keys(landmarks).length;
  if (count >= kMinLandmarks) return { ...own, landmarks };
  const has = `has ${count === 0 ? 'no landmarks' : counted(count, 'landmark')}`;
  if (templateLandmarks !== undefined)
    throw new InputError(`${has}; at least ${kMinLandmarks} are needed`).in(templateLandmarks);
  const place = isObj(path) ? '' : ' in the extras of its nodes and meshes';
  throw new InputError(
    `${has}${place}; give at least ${kMinLandmarks} of the model that it was made for: --landmarks template=T.json`,
  ).in(path);
}

const isObj = (path: string) => /\.obj$/i.test(path);

async function readGltfTemplate(path: string, reading: ReadOptions, io: Io): Promise<Template> {
  const { file, extracted } = withUvs(await readModel(templateFile(path), reading, io));
  return templateOf(file, extracted);
}

async function readObjTemplate(path: string, io: Io): Promise<Template> {
  io.step(`reading ${path}`);
  const wrong = (text: string) => new InputError(text).in(path);
  return withExtras(readObj(new TextDecoder().decode(await readBytes(path)), wrong), [], wrong);
}

/** The file of a template: of one that comes with the package if its name is given, and no file is called so. */
function templateFile(path: string): string {
  const isFolder = statSync(path, { throwIfNoEntry: false })?.isDirectory();
  if (path === standard || isFolder === false || /[./\\]/.test(path)) return path;
  if (!isTemplateName(path))
    throw new InputError(`no such file, and no template of the package: there are ${templateNames.join(', ')}`).in(
      path,
    );
  return fileURLToPath(new URL(`./templates/${path}.glb`, import.meta.url));
}

/** Reads landmarks: a JSON object, name → [x, y, z]. @throws {InputError} that names the file and the landmark. */
export function readLandmarks(path: string): Promise<Landmarks> {
  return naming(path, async () => {
    const landmarks = parseObject(new TextDecoder().decode(await readBytes(path)));
    for (const [name, position] of Object.entries(landmarks))
      if (!isPosition(position)) throw new InputError(`"${name}" is ${shown(position)}, not 3 numbers [x, y, z]`);
    return landmarks as Landmarks;
  });
}
