import { PNG } from 'pngjs';
import { Picture, type Rgb } from '../../gltf/thumbnail/picture.js';
import { Seen } from '../../gltf/thumbnail/seen.js';
import { type View, viewAt, views } from '../../gltf/thumbnail/views.js';
import { counted, percent, verdictOf } from '../../inspect/finding.js';
import { boxOf, pointAt, type Vector } from '../../inspect/geometry.js';
import { type Scene, sceneOf } from '../../inspect/scene.js';
import { InputError } from '../../scene/input-error.js';
import { integer, jsonText } from '../model/text.js';
import { kZoneNames } from '../model/zones.js';
import { adviceOn, holeTable, type InspectionReport, segmentTable } from './inspection.js';
import type { Run } from './run-transfer.js';

/** Pixels along each side of a picture. */
const kSize = 420;
/** Colours of the zones, after Okabe and Ito, so that colour-blind eyes tell them apart; what may be painted is clay. */
const kZoneColors: readonly Rgb[] = [
  [203, 198, 190],
  [0, 114, 178],
  [230, 159, 0],
  [204, 121, 167],
];
const kOutsideColor: Rgb = [213, 40, 30];
const kCageColor: Rgb = [60, 70, 90];
const kBorderColor: Rgb = [20, 20, 20];
/** Distances beyond this share of the diagonal all look alike. */
const kFarthest = 0.1;
/** How many triangles a UV layout is drawn with at most. */
const kMaxDrawn = 20000;
/** How many segments are listed at most. */
const kMaxSegments = 40;

const shownViews: readonly { name: string; view: View }[] = [
  { name: 'front', view: viewAt(views.front) },
  { name: 'its left', view: viewAt(views.left) },
  { name: 'back', view: viewAt(views.back) },
  { name: 'its right', view: viewAt(views.right) },
];

/** The file of a report, if one is asked for: a page with pictures, or JSON, by how its name ends. */
export function reportFiles(
  path: string | undefined,
  report: InspectionReport,
  run: Run,
): { path: string; data: string }[] {
  if (path === undefined) return [];
  const isPage = path.toLowerCase().endsWith('.html');
  return [{ path, data: isPage ? inspectionPage(report, run) : jsonText(report, 2) }];
}

/** Writes an inspection as a self-contained page, with pictures of zones, fit and UVs. */
function inspectionPage(report: InspectionReport, { target, cage, result }: Run): string {
  const { verdict, findings, holes, segments, placement, uv, options } = report;
  const { mesh, parts } = target.extracted;
  const scene = sceneOf(cage.extracted.mesh, mesh, result, { threshold: options.threshold }, parts);
  const figures = shownViews.map((shown) => figuresOf(scene, shown));
  const title = text(`${report.cage.file} on ${report.target.file}`);
  return `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>${verdict}: ${title}</title>
<style>
  body { font: 15px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #1c1f24; background: #fff; }
  h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin-top: 2.2rem; }
  .verdict { padding: .1em .6em; border-radius: .3em; color: #fff; text-transform: uppercase; letter-spacing: .04em; }
  .good { background: #1f7a4d; } .usable { background: #a86400; } .unfit { background: #b3261e; }
  ol { padding: 0; list-style: none; } li { margin: .6rem 0; padding-left: 1.4rem; position: relative; }
  li > i { position: absolute; left: 0; top: .45em; width: .8em; height: .8em; border-radius: 50%; }
  li small { display: block; color: #555; font-size: 1em; }
  .row { display: grid; grid-template-columns: repeat(auto-fit, minmax(11rem, 1fr)); gap: .5rem; }
  figure { margin: 0; } figure img, figure svg { width: 100%; height: auto; background: #f3f3f0; border-radius: .3rem; display: block; }
  figcaption { color: #555; font-size: .85rem; }
  table { border-collapse: collapse; font-variant-numeric: tabular-nums; } td, th { padding: .15rem .8rem .15rem 0; text-align: right; font-weight: normal; }
  td:first-child, th:first-child { text-align: left; } th { color: #555; border-bottom: 1px solid #ccc; }
  .key { display: inline-block; width: .9em; height: .9em; border-radius: .2em; margin: 0 .35em 0 1em; vertical-align: -.1em; }
  .key:first-child { margin-left: 0; }
</style>
<h1><span class="verdict ${verdict}">${verdict}</span> ${title}</h1>
<p>${integer(report.target.triangles)} triangles under a cage of ${integer(report.cage.triangles)}; preset ${text(options.preset)}, threshold ${options.threshold}. Cagecast ${text(report.versions.cagecast)}.</p>
${findings.length > 0 ? `<ol>${findings.map((finding) => `<li><i class="${verdictOf([finding])}"></i>${text(finding.sentence)}.<small>${text(adviceOn(finding))}</small></li>`).join('')}</ol>` : '<p>No problems found.</p>'}
<h2>Zones</h2>
<p>${kZoneNames.map((zone, z) => `<span class="key" style="background:rgb(${kZoneColors[z]!.join()})"></span>${zone} ${percent(report.coverage[zone])}`).join('')}</p>
<div class="row">${figures.map(({ zones }) => zones).join('')}</div>
<h2>Fit</h2>
<p><span class="key" style="background:rgb(${kOutsideColor.join()})"></span>outside the cage: ${percent(placement.outside.exposedArea)} of the exposed area<span class="key" style="background:rgb(${shade(0).join()})"></span>at the cage<span class="key" style="background:rgb(${shade(kFarthest).join()})"></span>${percent(kFarthest)} of the diagonal beneath. Median ${percent(placement.distances.p50)}, 99 % within ${percent(placement.distances.p99)}. Lines: edges of the cage, open edges dark.</p>
<div class="row">${figures.map(({ fit }) => fit).join('')}</div>
<h2>UVs</h2>
<p>${counted(uv.charts, 'chart')}, ${counted(uv.seams.edges, 'seam edge')}; ${percent(uv.used)} of the texture in use, ${percent(uv.overlap.share)} of that more than once.</p>
<div class="row" style="max-width: 28rem"><figure>${drawUvs(scene)}<figcaption>the cage in the texture; darker where triangles overlap</figcaption></figure></div>
<h2>Holes</h2>
${holes.length > 0 ? rows(holeTable(holes, holes.length)) : '<p>None.</p>'}
<h2>Segments</h2>
${rows(segmentTable(segments, kMaxSegments))}
</html>
`;
}

function text(value: string): string {
  return value.replace(/[&<>"]/g, (symbol) => `&#${symbol.charCodeAt(0)};`);
}

function rows([head, ...body]: string[][]): string {
  const row = (cells: readonly string[], tag: string) =>
    `<tr>${cells.map((cell) => `<${tag}>${text(cell)}</${tag}>`).join('')}</tr>`;
  return `<table>${row(head!, 'th')}${body.map((cells) => row(cells, 'td')).join('')}</table>`;
}

/** Pictures of one view, side by side: the zones and the fit, or why there is none. */
function figuresOf(scene: Scene, { name, view }: (typeof shownViews)[number]): { zones: string; fit: string } {
  try {
    const seen = new Seen(pictureOf(scene, view), scene.target);
    const [zones, fit] = [drawZones(scene, view, seen), drawFit(scene, view, seen)];
    return { zones: figure(name, zones), fit: figure(name, fit) };
  } catch (error) {
    if (!(error instanceof InputError)) throw error;
    const none = `<figure><figcaption>${name}: ${text(error.message)}</figcaption></figure>`;
    return { zones: none, fit: none };
  }
}

function figure(name: string, picture: Picture): string {
  const png = new PNG({ width: kSize, height: kSize });
  png.data.set(picture.image().data);
  return `<figure><img alt="${name === 'front' || name === 'back' ? `the ${name}` : `from ${name}`}" src="data:image/png;base64,${PNG.sync.write(png).toString('base64')}"><figcaption>${name}</figcaption></figure>`;
}

function pictureOf({ targetBox: { min, max } }: Pick<Scene, 'targetBox'>, view: View): Picture {
  const middle: Vector = [(min[0] + max[0]) / 2, (min[1] + max[1]) / 2, (min[2] + max[2]) / 2];
  const radius = 0.56 * Math.max(max[0] - min[0], max[1] - min[1], max[2] - min[2]);
  return new Picture({ size: kSize, view, middle, radius });
}

function drawZones({ target: { indices }, result: { zones }, ...scene }: Scene, view: View, seen: Seen): Picture {
  const picture = pictureOf(scene, view);
  picture.mesh(seen, (t) => {
    const [p, q, r] = [zones[indices[3 * t]!]!, zones[indices[3 * t + 1]!]!, zones[indices[3 * t + 2]!]!];
    return kZoneColors[Math.max(p, q, r)]!;
  });
  return picture;
}

/** From white, touching the cage, to a dark green, far beneath it. */
function shade(distance: number): Rgb {
  const t = Math.min(1, distance / kFarthest);
  return [Math.round(245 - 215 * t), Math.round(245 - 130 * t), Math.round(238 - 138 * t)];
}

function drawFit(scene: Scene, view: View, seen: Seen): Picture {
  const picture = pictureOf(scene, view);
  const { signed } = scene.sides;
  const { positions } = scene.cage;
  const { indices } = scene.target;
  picture.mesh(seen, (t) => {
    const sum = signed[indices[3 * t]!]! + signed[indices[3 * t + 1]!]! + signed[indices[3 * t + 2]!]!;
    const mean = sum / 3 / scene.diagonal;
    return mean > 0 ? kOutsideColor : shade(-mean);
  });
  for (const { a, b, uses } of scene.surface.edges) {
    picture.line(pointAt(positions, a), pointAt(positions, b), uses.length === 1 ? kBorderColor : kCageColor);
  }
  return picture;
}

function drawUvs({ cage, surface }: Scene): string {
  const uvs = cage.uvs ?? new Float32Array(0);
  const box = boxOf(
    Float32Array.from({ length: (uvs.length / 2) * 3 }, (_, i) =>
      i % 3 === 2 ? 0 : uvs[2 * Math.floor(i / 3) + (i % 3)]!,
    ),
  );
  // The texture, and whatever lies outside of it.
  const [left, top] = [Math.min(0, box.min[0]), Math.min(0, box.min[1])];
  const side = Math.max(1, box.max[0] - left, box.max[1] - top);
  const place = (v: number) =>
    [uvs[2 * v]!, uvs[2 * v + 1]!]
      .map((value, k) => Number((((value - (k === 0 ? left : top)) / side) * 1000).toFixed(1)))
      .join(' ');
  let paths = '';
  for (let t = 0; t < Math.min(surface.areas.length, kMaxDrawn); ++t) {
    paths += `<path d="M${place(cage.indices[3 * t]!)}L${place(cage.indices[3 * t + 1]!)}L${place(cage.indices[3 * t + 2]!)}Z"/>`;
  }
  const frame = `<rect x="${((0 - left) / side) * 1000}" y="${((0 - top) / side) * 1000}" width="${1000 / side}" height="${1000 / side}" fill="none" stroke="#b3261e" stroke-width="3"/>`;
  return `<svg viewBox="-5 -5 1010 1010" role="img" aria-label="the cage's UVs"><g fill="#0072b2" fill-opacity=".3" stroke="#1c1f24" stroke-width="1">${paths}</g>${frame}</svg>`;
}
