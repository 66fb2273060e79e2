// One avatar through one door, in a process of its own: makes its cage, paints it, measures, and draws it from four sides.
//
//   tsx bench/avatars/door.ts FILE DOOR PLACE AVATAR.json [marked]
//
// Writes PLACE.png, .cage.glb, .painted.glb, and its row to PLACE.json. `marked` gives a fit the marks of the face as landmarks.

import { readFileSync, rmSync, writeFileSync } from 'node:fs';
import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { cageGlb, loadTemplate, type TemplateName } from 'cagecast/cages';
import { cagecast, cageModel, cageTemplate, toGlb } from 'cagecast/gltf';
import draco from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';
import { PNG } from 'pngjs';
import { root } from '../native.js';
import type { Avatar } from './labels.js';
import { frameOf, type Score, scoreOf } from './score.js';

/** A row of the table. Without a verdict, `failed` says why. */
export interface Row extends Score {
  verdict?: string;
  /** What `auto` came to. */
  template?: string;
  failed?: string;
  /** Processor time of making or fitting. */
  seconds?: number;
}

/** Pixels of a picture, and the half of a close-up's side in distances from eyes to mouth. */
const [kPixels, kCloseUp] = [256, 2.2];
/** From where an avatar is seen, in degrees to the left of its front. */
const kAzimuths = [0, 35, 90];

const { runCommand } = await import(`${root}dist/command.js`);
/** Runs the command. @throws {Error} with what it says if it cannot. */
async function command(...args: string[]): Promise<string> {
  let [out, errors] = ['', ''];
  const exit = await runCommand(args, {
    stdout: (data: Uint8Array | string) =>
      void (out += typeof data === 'string' ? data : new TextDecoder().decode(data)),
    stderr: (text: string) => void (errors += text),
  });
  if (exit !== 0 && exit !== 3) throw new Error(errors.trim() || `exit code ${exit}`);
  return out;
}

await MeshoptDecoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  'draco3d.decoder': await draco.createDecoderModule(),
  'meshopt.decoder': MeshoptDecoder,
});

/** @param template  That was fitted, if one was: a hole that was closed is where its vertices are. */
async function score(
  file: string,
  cage: string,
  template: string | undefined,
  { face, parts }: Avatar,
): Promise<Score> {
  const isGltf = /\.(glb|vrm)$/.test(file);
  const document = await (isGltf ? io.read(file) : io.readBinary(await toGlb(readFileSync(file))));
  const fitted = await io.read(cage);
  const model = await cageModel(document);
  let zones = new Uint8Array();
  await document.transform(
    cagecast({ cage: fitted, onResult: (result) => void (zones = Uint8Array.from(result.zones)) }),
  );
  const holes = template && (await loadTemplate(template as TemplateName)).holes;
  return scoreOf({ ...cageTemplate(fitted), ...(holes && { holes }) }, model, zones, face, parts);
}

/** A paint that shows its UVs: checks of 16 to a side, redder to the right and greener downwards. */
function loudPaint(): Buffer {
  const paint = new PNG({ width: kPixels, height: kPixels });
  for (let i = 0; i < kPixels * kPixels; ++i) {
    const [x, y] = [i % kPixels, Math.floor(i / kPixels)];
    paint.data.set([x, y, ((x ^ y) & 16) === 0 ? 255 : 0, 255], 4 * i);
  }
  return PNG.sync.write(paint);
}

/** Draws an avatar from its front, between front and side, from its side, and its face. */
async function draw(painted: string, to: string, { face }: Avatar): Promise<void> {
  const { z, middle, unit } = face ? frameOf(face) : { z: { x: 0, z: 1 }, middle: undefined, unit: 1 };
  const front = file.endsWith('.vrm') ? 0 : Math.round((180 / Math.PI) * Math.atan2(z.x, z.z)); // A VRM's views are its own.
  const views = kAzimuths.map((azimuth) => ['--view', `${front + azimuth},5`]);
  if (middle) {
    const corner = (k: number): number[] =>
      middle.toArray().map((x, a) => x + (k & (1 << a) ? 1 : -1) * kCloseUp * unit);
    const positions = Float32Array.from([0, 1, 2, 3, 4, 5, 6, 7].flatMap(corner));
    writeFileSync(
      `${to}.box.glb`,
      cageGlb({ positions, indices: Uint32Array.of(0, 1, 3, 4, 5, 7), uvs: new Float32Array(16) }),
    );
    views.push(['--view', `${front},0`, '--cage', `${to}.box.glb`]);
  }
  const sheet = new PNG({ width: 4 * kPixels, height: kPixels, fill: true });
  for (const [n, view] of views.entries()) {
    await command(
      'thumbnail',
      painted,
      ...view,
      '--size',
      `${kPixels}`,
      '--background',
      '#808080',
      '-o',
      `${to}.png`,
      '--quiet',
    );
    PNG.bitblt(PNG.sync.read(readFileSync(`${to}.png`)), sheet, 0, 0, kPixels, kPixels, n * kPixels, 0);
  }
  writeFileSync(`${to}.png`, PNG.sync.write(sheet));
  rmSync(`${to}.box.glb`, { force: true });
}

const [file, door, to, label, marked] = process.argv.slice(2) as [string, string, string, string, string?];
const avatar = JSON.parse(label) as Avatar;
const row: Row = {};
try {
  const [cage, painted] = [`${to}.cage.glb`, `${to}.painted.glb`];
  const before = process.cpuUsage();
  const [what, template] = door.split(' ') as [string, string?];
  const options = template ? ['--template', template] : [];
  if (marked && template && avatar.face) {
    const { eyeL, eyeR, mouth } = avatar.face;
    const landmarks = {
      eye_centre_left: eyeL,
      eye_centre_right: eyeR,
      ...(!avatar.face.guessed && { lip_lower: mouth }),
    };
    writeFileSync(`${to}.marks.json`, JSON.stringify(landmarks));
    options.push('--landmarks', `${to}.marks.json`);
  }
  const report = JSON.parse(await command(what, file, ...options, '-o', cage, '--json'));
  [row.verdict, row.template] = [report.verdict, report.template];
  const { user, system } = process.cpuUsage(before);
  row.seconds = (user + system) / 1e6;
  writeFileSync(`${to}.paint.png`, loudPaint());
  await command('transfer', file, '--cage', cage, '--texture', `${to}.paint.png`, '-o', painted, '--quiet');
  rmSync(`${to}.paint.png`);
  await draw(painted, to, avatar);
  Object.assign(row, await score(file, cage, row.template === 'made' ? undefined : (row.template ?? template), avatar));
} catch (error) {
  row.failed = (error as Error).message.split('\n')[0]!;
}
writeFileSync(`${to}.json`, JSON.stringify(row));
process.exit();
