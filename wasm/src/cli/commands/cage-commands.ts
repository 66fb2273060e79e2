import { type Command, Option } from 'commander';
import { cageGlb } from '../../cages/cage-glb.js';
import { templateNames } from '../../cages/template-names.js';
import type { Cage, Fit, Kind, Landmarks } from '../../cages/types.js';
import { bareParts, type ReadModel, readBack } from '../../gltf/read-model.js';
import { counted } from '../../inspect/finding.js';
import { landmarksMoved } from '../../parts/origin.js';
import type { Io } from '../io/io.js';
import { writeFiles } from '../io/output.js';
import { kExit } from '../model/failures.js';
import { type Rules, resolveSettings } from '../model/settings.js';
import { kAutoCage } from '../model/sources.js';
import { integer, type Line, listed } from '../model/text.js';
import { conclusionOf, inspectionReport } from '../transfer/inspection.js';
import { reportFiles } from '../transfer/inspection-page.js';
import { chooseCageFor, fitCageTo, makeCageFor } from '../transfer/made-cage.js';
import { transferOptions } from '../transfer/part-names.js';
import { readTarget } from '../transfer/read-target.js';
import { choiceLines, leftOutLines } from '../transfer/report-parts.js';
import { transferModels } from '../transfer/run-transfer.js';
import { readLandmarks, readTemplate } from '../transfer/template.js';
import * as common from './common-flags.js';
import { type Found, perform } from './perform.js';

/** The fewest and the most triangles that a cage can be asked to have. */
const kTriangleRange = [50, 20_000] as const;

/** The least and the most that gaps can be closed by, as a share of the diagonal. */
const kClosingRange = [0.0005, 0.2] as const;

interface CageFileFlags extends common.ReadFlags, common.PrintFlags {
  output: string;
  report?: string;
  keep?: string[];
  exclude?: string[];
}

interface MakeFlags extends CageFileFlags {
  triangles?: number;
  kind: Kind;
  closing?: number;
}

interface FitFlags extends CageFileFlags {
  template: string;
  landmarks?: LandmarkFiles;
}

/** Files of landmarks. */
interface LandmarkFiles {
  target?: string;
  template?: string;
}

/** Parses the flag of a file of landmarks, which may be given for either model. */
function landmarkFile(text: string, before: LandmarkFiles = {}): LandmarkFiles {
  const [, path] = /^template=(.+)$/s.exec(text) ?? [];
  return path === undefined ? { ...before, target: text } : { ...before, template: path };
}

/** The rules of a transfer with no other flags. */
const rulesOf = ({ ignore = [], keep = [], exclude = [] }: CageFileFlags): Rules =>
  resolveSettings([{ settings: { ignore, keep, exclude } }]).rules;

/** The parts that flags name. */
const partsOf = (flags: CageFileFlags, model: ReadModel) => transferOptions(rulesOf(flags), model, []).parts;

const kExitCode = '\nExit code 3: the cage is unfit.';

/** Adds the commands that make and fit cages. */
export function addCageCommands(program: Command, io: Io): void {
  const make = program
    .command('make')
    .argument('<TARGET>', 'GLB, glTF, VRM, FBX, OBJ, PLY, STL or USDZ of a head, a figure or a thing')
    .description(
      'make a cage for TARGET: a hull with UVs, and a hole over each part that is not painted; print a verdict',
    )
    .addOption(
      common.parsed(
        '--triangles <N>',
        `about how many triangles; ${kTriangleRange[0]} to ${kTriangleRange[1]} (default: by kind)`,
        common.wholeNumberWithin(...kTriangleRange),
      ),
    )
    .addOption(
      new Option('--kind <KIND>', 'what TARGET is, which decides how tight the cage is and where its seams are')
        .choices(['automatic', 'head', 'body', 'prop'])
        .default('automatic'),
    )
    .addOption(
      common.parsed(
        '--closing <SHARE>',
        `bridge gaps narrower than twice this share of TARGET's diagonal; ${kClosingRange[0]} to ${kClosingRange[1]} (default: by kind)`,
        common.numberWithin(...kClosingRange),
      ),
    );
  common.addFlags(make, 'Cage file', 'Parts', 'Reading', 'Printing');
  make
    .addHelpText(
      'after',
      `${kExitCode}

Example: cagecast make head.glb --exclude visor --keep "hair*" --triangles 800 -o cage.glb`,
    )
    .action((target: string, flags: MakeFlags) =>
      perform(io, flags, { inputs: [target], outputs: [flags.output, flags.report] }, () => makeFor(target, flags, io)),
    );

  const fit = program
    .command('fit')
    .argument('<TARGET>', 'GLB, glTF, VRM, FBX, OBJ, PLY, STL or USDZ of the model that gets the cage')
    .description('move a template cage onto TARGET, so that one texture fits both; print a verdict')
    .requiredOption(
      '--template <TEMPLATE>',
      `GLB, glTF or OBJ of a cage for another model; or ${templateNames.join(', ')}; or auto: one of those, or a cage made as by make, whichever fits best`,
    )
    .addOption(
      common.parsed(
        '--landmarks <L.json>',
        'landmarks of TARGET, which override those that are found; template=T.json, those of the model that TEMPLATE was made for (default: those in its file, as extras.landmarks); may be repeated',
        landmarkFile,
      ),
    );
  common.addFlags(fit, 'Cage file', 'Parts', 'Reading', 'Printing');
  fit
    .addHelpText(
      'after',
      `
Files of landmarks are JSON, name → [x, y, z] in the model's space: { "nose_tip": [0, 1.52, 0.11], … }${kExitCode}

Examples:
  cagecast fit head.glb --template human-head -o cage.glb
  cagecast fit head.glb --template template.glb --landmarks head.json -o cage.glb --report report.html`,
    )
    .action((target: string, flags: FitFlags) => {
      const inputs = [flags.template, target, ...Object.values(flags.landmarks ?? {})];
      return perform(io, flags, { inputs, outputs: [flags.output, flags.report] }, () =>
        fitTo(flags.template, target, flags, io),
      );
    });
}

/** Makes a cage for a model and inspects it. @throws {InputError} that names the file at fault; then no file is written. */
async function makeFor(target: string, flags: MakeFlags, io: Io): Promise<Found> {
  const { triangles, kind, closing } = flags;
  const model = await readTarget(target, common.readingOf(flags), io, rulesOf(flags));
  const cage = await makeCageFor(model, { parts: partsOf(flags, model), triangles, kind, closing }, io);
  return finish(cage, model, flags, io);
}

/** Fits a template cage to a model and inspects it. @throws {InputError} that names the file at fault; then no file is written. */
async function fitTo(path: string, target: string, flags: FitFlags, io: Io): Promise<Found> {
  const template =
    path === kAutoCage ? undefined : await readTemplate(path, common.readingOf(flags), io, flags.landmarks?.template);
  const own = flags.landmarks?.target;
  const given = own === undefined ? undefined : await readLandmarks(own);
  const model = await readTarget(target, common.readingOf(flags), io, rulesOf(flags));
  const { origin } = model.extracted;
  const landmarks = given && landmarksMoved(given, origin, -1);
  const files = { template: path, landmarks: own };
  const sources = { landmarks, files, options: { parts: partsOf(flags, model) } };
  const chosen = template
    ? await fitCageTo(model, { ...sources, template }, io).then((fit) => ({ cage: fit.cage, fit, choice: undefined }))
    : await chooseCageFor(model, sources, io);
  const { cage, fit, choice } = chosen;
  const notes = fit
    ? describeFit({ ...fit, used: landmarksMoved(fit.used, origin, 1) }, landmarks ?? {})
    : { lines: [], report: {} };
  return finish(cage, model, flags, io, {
    ...notes,
    lines: [...choiceLines(choice), ...notes.lines],
    report: { ...choice, ...notes.report },
  });
}

/** How many landmarks are listed at most. */
const kMaxNames = 12;

/** How many landmarks are asked for where too little was found. */
const kMaxAsked = 4;

/** Landmarks less certain than this are listed. */
const kCertain = 0.7;

/** What a fit says of landmarks: lines for people, what could make it better, and all of it for programs. */
interface FitNotes {
  lines: Line[];
  advice?: Line;
  /** What to do instead if the cage does not fit. */
  otherwise?: Line;
  report: object;
}

function describeFit({ used, confidence, missing, guessed }: Fit, given: Landmarks): FitNotes {
  const all = Object.keys(used);
  const own = all.filter((name) => Object.hasOwn(given, name)).length;
  const list = (names: string[]) => listed(names, kMaxNames, ' (--json lists all)');
  const doubtful = all
    .filter((name) => confidence[name]! < kCertain && !guessed.includes(name))
    .sort((a, b) => confidence[a]! - confidence[b]!)
    .map((name) => `${name} (${confidence[name]!.toFixed(2)})`);
  const isJoint = (name: string) => name.startsWith('joint_');
  const lines = [
    `landmarks: ${integer(all.length)} used, ${integer(own)} of them given`,
    doubtful.length > 0 && `found, but not certain (1 would be): ${list(doubtful)}`,
    guessed.length > 0 && `guessed by size and symmetry, as too little was found: ${list(guessed)}`,
    missing.length > 0 && `not found: ${list(missing)}`,
    missing.some(isJoint) &&
      !all.some(isJoint) &&
      'no joint is found: TARGET has no skeleton, or names of bones that are not known',
  ];
  const ask = guessed.length > 0 ? guessed.slice(0, kMaxAsked).join(', ') : 'these';
  const isAsking = doubtful.length + missing.length + guessed.length > 0;
  const advice = isAsking && `give ${ask} for a better fit: --landmarks L.json`;
  const otherwise = 'a texture for this model alone needs no template: cagecast make TARGET -o CAGE';
  return { lines, advice, otherwise, report: { landmarks: { used, confidence, missing, guessed } } };
}

/** Inspects a cage, as `inspect` does without flags, and writes the files. */
async function finish(
  cage: Cage,
  model: ReadModel,
  flags: CageFileFlags,
  io: Io,
  notes: FitNotes = { lines: [], report: {} },
): Promise<Found> {
  const { output } = flags;
  const rules = rulesOf(flags);
  const written = await readBack(cage, output, model);
  const options = transferOptions(rules, model, bareParts(model, written));
  const run = await transferModels(model, written, options, io);
  io.step('inspecting');
  const report = inspectionReport({ target: model.file.path, cage: output, rules }, run, []);
  const all = { ...report, ...notes.report };
  const cageFile = { path: output, data: cageGlb({ ...cage, origin: model.extracted.origin }) };
  writeFiles([cageFile, ...reportFiles(flags.report, all, run)], io);
  const conclusion = conclusionOf(report);
  const { verdict, uv, holes } = report;
  const lines = [
    `wrote ${output}: ${integer(report.cage.vertices)} vertices, ${integer(report.cage.triangles)} triangles, ${counted(uv.charts, 'chart')}, ${counted(holes.length, 'hole')}`,
    ...notes.lines,
    ...leftOutLines(report.target),
    verdict !== 'good' && notes.advice,
    ...conclusion,
    verdict === 'unfit' && notes.otherwise,
    flags.report && `wrote ${flags.report}`,
  ];
  const exitCode = verdict === 'unfit' ? kExit.unfit : 0;
  return { lines, report: all, exitCode };
}
