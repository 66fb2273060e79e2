import { statSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { cageGlb } from '../cages/cage-glb.js';
import { templateNames } from '../cages/template-names.js';
import type { Cage, Fit, Kind, Landmarks } from '../cages/types.js';
import { templateOf } from '../gltf/cage-file.js';
import { type ReadOptions, readBytes, standard } from '../gltf/files.js';
import { InputError, withName } from '../gltf/input-error.js';
import { counted } from '../inspect/finding.js';
import type { Verdict } from '../inspect/index.js';
import { isPosition } from '../parts/template-extras.js';
import { parseObject, shown } from './config/settings.js';
import { conclusionOf, inspectionReport } from './inspect-command.js';
import { inspectionPage } from './inspect-page.js';
import { fitCageTo, landmarksOf, makeCageFor } from './make-cage.js';
import { defaultRules } from './options.js';
import { writeFiles } from './output.js';
import type { Found } from './print.js';
import type { Progress } from './progress.js';
import { type ReadModel, readBack, readModel, transferModels, withUvs } from './run.js';
import { integer, listed } from './table.js';

interface CageOutput {
  output: string;
  html?: string | undefined;
  reading: ReadOptions;
}

/** The arguments of `cagecast make`. */
export interface MakeCommand extends CageOutput {
  target: string;
  /** Patterns of names that replace the default ones. */
  exclude?: string[] | undefined;
  triangles?: number | undefined;
  kind: Kind;
  /** A share of the model's diagonal. */
  closing?: number | undefined;
}

/** The arguments of `cagecast fit`. */
export interface FitCommand extends CageOutput {
  template: string;
  target: string;
  templateLandmarks?: string | undefined;
  landmarks?: string | undefined;
  /** Patterns of names that replace the default ones. */
  exclude?: string[] | undefined;
}

/** What a fit says of landmarks: lines for people, and all of it for programs. */
interface FitNotes {
  lines: string[];
  /** What could make the fit better. */
  advice: string;
  report: object;
}

/** What a command prints, and what `inspect` says of the cage. */
export interface CageVerdict extends Found {
  verdict: Verdict;
}

/**
 * Makes a cage for a model and inspects it.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function makeCommand(command: MakeCommand, progress: Progress): Promise<CageVerdict> {
  const { target, exclude, triangles, kind, closing, reading } = command;
  const model = await readModel(target, reading, progress);
  const options = { exclude, triangles, kind, closing };
  const cage = await makeCageFor(model, options, progress);
  return finish(command, model, { ...cage, landmarks: await landmarksOf(model, progress) }, progress);
}

/**
 * Fits a template cage to a model and inspects it.
 * @throws {InputError} that names the file at fault; then no file is written.
 */
export async function fitCommand(command: FitCommand, progress: Progress): Promise<CageVerdict> {
  const { template: templatePath, target, templateLandmarks, landmarks: landmarksPath, exclude, reading } = command;
  const read = withUvs(await readModel(templateFile(templatePath), reading, progress));
  const own = templateOf(read.file, read.extracted);
  const template = {
    ...own,
    ...(templateLandmarks !== undefined && { landmarks: await readLandmarks(templateLandmarks) }),
  };
  const count = Object.keys(template.landmarks).length;
  if (count < kMinLandmarks) {
    const has = `has ${count === 0 ? 'no landmarks' : counted(count, 'landmark')}`;
    if (templateLandmarks !== undefined)
      throw new InputError(`${has}; at least ${kMinLandmarks} are needed`).in(templateLandmarks);
    throw new InputError(
      `${has} in the extras of its nodes and meshes; give at least ${kMinLandmarks} of the model that it was made for: --template-landmarks T.json`,
    ).in(templatePath);
  }
  const landmarks = landmarksPath === undefined ? undefined : await readLandmarks(landmarksPath);
  const model = await readModel(target, reading, progress);
  const files = { template: templatePath, landmarks: landmarksPath };
  const fit = await fitCageTo(model, { template, landmarks, files, options: { exclude } }, progress);
  return finish(command, model, fit.cage, progress, describeFit(fit, landmarks ?? {}));
}

/** The file of a template: of one that comes with the package if its name is given, and no file is called so. */
function templateFile(path: string): string {
  const isFolder = statSync(path, { throwIfNoEntry: false })?.isDirectory();
  if (path === standard || isFolder === false || /[./\\]/.test(path)) return path;
  if (!(templateNames as readonly string[]).includes(path))
    throw new InputError(`no such file, and no template of the package: there are ${templateNames.join(', ')}`).in(
      path,
    );
  return fileURLToPath(new URL(`./templates/${path}.glb`, import.meta.url));
}

/** Reads landmarks: a JSON object, name → [x, y, z]. @throws {InputError} that names the file and the landmark. */
async function readLandmarks(path: string): Promise<Landmarks> {
  try {
    const landmarks = parseObject(new TextDecoder().decode(await readBytes(path)));
    for (const [name, position] of Object.entries(landmarks))
      if (!isPosition(position)) throw new InputError(`"${name}" is ${shown(position)}, not 3 numbers [x, y, z]`);
    return landmarks as Landmarks;
  } catch (error) {
    throw withName(error, path);
  }
}

/** How many landmarks `fitCage` needs of a template. */
const kMinLandmarks = 4;

/** How many landmarks are listed at most. */
const kMaxNames = 12;

/** Landmarks less certain than this are listed. */
const kCertain = 0.7;

function describeFit({ used, confidence, missing }: Fit, given: Landmarks): FitNotes {
  const all = Object.keys(used);
  const own = all.filter((name) => Object.hasOwn(given, name)).length;
  const list = (names: string[]) => listed(names, kMaxNames, ' (--json lists all)');
  const doubtful = all
    .filter((name) => confidence[name]! < kCertain)
    .sort((a, b) => confidence[a]! - confidence[b]!)
    .map((name) => `${name} (${confidence[name]!.toFixed(2)})`);
  const isJoint = (name: string) => name.startsWith('joint_');
  const lines = [
    `landmarks: ${integer(all.length)} used, ${integer(own)} of them given`,
    doubtful.length > 0 ? `found, but not certain (1 would be): ${list(doubtful)}` : '',
    missing.length > 0 ? `not found: ${list(missing)}` : '',
    missing.some(isJoint) && !all.some(isJoint)
      ? 'no joint is found: TARGET has no skeleton, or names of bones that are not known'
      : '',
  ].filter(Boolean);
  const advice = doubtful.length + missing.length > 0 ? 'give these for a better fit: --landmarks L.json' : '';
  return { lines, advice, report: { landmarks: { used, confidence, missing } } };
}

/** Said where findings advise flags that these commands do not have, or have for something else. */
const kOtherFlags = '--keep and --exclude, as advised here, are flags of cagecast transfer';

/** Inspects a cage and writes the files. */
async function finish(
  { output, html }: CageOutput,
  model: ReadModel,
  cage: Cage,
  progress: Progress,
  notes: FitNotes = { lines: [], advice: '', report: {} },
): Promise<CageVerdict> {
  const run = await transferModels(model, await readBack(cage, output), { preset: 'default' }, progress);
  progress.step('inspecting');
  // As `inspect` does without flags.
  const report = inspectionReport({ target: model.file.path, cage: output, rules: defaultRules }, run, []);
  writeFiles([
    { path: output, data: cageGlb(cage) },
    ...(html === undefined ? [] : [{ path: html, data: inspectionPage(report, run) }]),
  ]);
  const conclusion = conclusionOf(report);
  const lines = [
    `wrote ${output}: ${integer(report.cage.vertices)} vertices, ${integer(report.cage.triangles)} triangles, ${counted(report.uv.charts, 'chart')}, ${counted(report.holes.length, 'hole')}`,
    ...notes.lines,
    // A cage that is good needs nothing.
    ...(report.verdict === 'good' || notes.advice === '' ? [] : [notes.advice]),
    ...conclusion,
    ...(conclusion.some((line) => /--(keep|exclude) "/.test(line)) ? [kOtherFlags] : []),
    ...(html === undefined ? [] : [`wrote ${html}`]),
  ];
  return { lines, report: { ...report, ...notes.report }, verdict: report.verdict };
}
