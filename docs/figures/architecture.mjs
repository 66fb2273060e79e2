import { arrow, figure, kColors, line, lines, rectangle, text } from './draw.mjs';

const { cage, cosmetic, culled, faint, target, uncovered } = kColors;

/** A box with a heading and a few lines. */
const box = (x, y, width, height, heading, contents, color) => [
  rectangle(x, y, width, height, '#ffffff', { color, radius: 6 }),
  text([x + 12, y + 22], heading, { bold: true, size: 13, color }),
  lines([x + 12, y + 42], contents, { size: 11.5 }),
];

/** Who calls whom, and what the steps hand on. */
export function architecture() {
  const step = (i, number, name, result) => {
    const y = 300 + 33 * i;
    return [
      rectangle(300, y, 210, 26, '#f3f8f4', { color: cosmetic, radius: 4 }),
      text([310, y + 17.5], `${number}  ${name}`, { size: 12 }),
      line(
        [
          [510, y + 13],
          [528, y + 13],
        ],
        faint,
      ),
      text([534, y + 17], result, { size: 11.5 }),
    ];
  };
  const folders = ['clip', 'seams', 'steps', 'cage', 'search', 'input', 'geometry', 'simd', 'base'];
  const what = [
    'cut borders',
    'UVs per corner',
    'steps 1 to 8',
    'boundary loops, UV charts',
    'k-d ordered trees, rays, closest points',
    'validate, weld, half-edges',
    'vectors, triangles, Hilbert',
    'one vector type, four back ends',
    'arena, tolerances, containers',
  ];
  return figure(860, 690, 'The parts of Cagecast, the call path, and the steps', [
    box(20, 20, 180, 84, 'web/', ['the page; imports the', 'package by its name'], culled),
    box(220, 20, 180, 84, 'three, gltf, command', ['adapters in wasm/src:', 'models in, models out'], culled),
    box(420, 20, 180, 84, 'examples/, bench/', ['programs that use it'], culled),
    box(640, 20, 200, 84, 'C++ programs', ['cagecast::cagecast (CMake)', 'spans in, arrays out'], culled),
    arrow([110, 104], [110, 132], target),
    arrow([310, 104], [310, 132], target),
    arrow([510, 104], [510, 132], target),
    box(
      20,
      134,
      580,
      80,
      'wasm/src, wasm/bindings.cpp',
      ['TypeScript: option names, lifetimes, CagecastError', 'embind: arrays copied in, records copied out; no logic'],
      cage,
    ),
    arrow([310, 214], [310, 240], target),
    arrow([740, 104], [740, 240], target),
    box(
      20,
      242,
      820,
      36,
      'core/include/cagecast: project · classify · transfer · splitVertices · cutBorders',
      [],
      cage,
    ),
    arrow([120, 278], [120, 298], target),
    arrow([405, 278], [405, 298], target),
    rectangle(20, 300, 230, 366, '#fafafa', { color: faint, radius: 6 }),
    text([34, 324], 'core/src, highest first', { bold: true, size: 13 }),
    text([34, 342], 'each may use those below it', { size: 11.5 }),
    text([34, 366], 'transfer.cpp', { bold: true, size: 12, color: cage }),
    text([120, 366], 'the steps in order', { size: 11 }),
    folders.map((name, i) => [
      text([34, 392 + 30 * i], name, { bold: true, size: 12, color: cage }),
      text([34, 405 + 30 * i], what[i], { size: 10.5 }),
    ]),
    step(0, '–', 'validate', 'Status, or units and scale'),
    step(1, '–', 'weld, build', 'points · trees · boundary loops · charts'),
    step(2, '1', 'project', 'cage triangle, q, distance, UV'),
    step(3, '2', 'occluded', 'zone occluded'),
    step(4, '3', 'uncovered', 'zone uncovered'),
    step(5, '4', 'segments, areas', 'SegmentStats A, E, C, D, twins'),
    step(6, '6', 'recheck occluded', 'recovery: always'),
    step(7, '7', 'assign holes', 'recovery: through hole h · holeShares'),
    step(8, '9', 'corner UVs', 'cornerUvs'),
    text([300, 616], 'Projection: independent of the threshold', { size: 12, color: uncovered }),
    line(
      [
        [300, 604],
        [820, 604],
      ],
      uncovered,
      { dash: '5 4' },
    ),
    step(9.8, '5, 8', 'classify', 'scores · culled · zones · cosmeticTriangles'),
  ]);
}
