// Draws the figures of the documentation: node docs/figures/make.mjs [--check]
// Cross-sections, unless a caption says otherwise: the cage is a blue line, the target a grey one.

import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';
import { architecture } from './architecture.mjs';
import {
  arrow,
  circle,
  cross,
  curve,
  dot,
  figure,
  kColors,
  line,
  lines,
  polygon,
  rectangle,
  text,
  title,
} from './draw.mjs';

const { cage, target, cosmetic, occluded, uncovered, culled, faint } = kColors;
/** Points, from text: x,y x,y … */
const at = (points) => points.split(' ').map((point) => point.split(',').map(Number));
const small = { size: 12 };
const mid = { size: 12, anchor: 'middle' };
const label = (at, content, color = kColors.text) => text(at, content, { color, size: 13 });
const between = ([x0, y0], [x1, y1], t) => [x0 + t * (x1 - x0), y0 + t * (y1 - y0)];
/** A coloured dot and what it stands for. */
const key = ([x, y], color, content) => [dot([x, y - 4], color), text([x + 11, y], content, small)];

const weld = () => {
  const grid = (x, y) => [
    polygon(
      [
        [x, y],
        [x + 70, y - 30],
        [x + 70, y + 50],
      ],
      '#eeeeee',
      { color: target },
    ),
    polygon(
      [
        [x + 86, y - 30],
        [x + 156, y],
        [x + 86, y + 50],
      ],
      '#eeeeee',
      { color: target },
    ),
  ];
  return figure(700, 190, 'Vertices with equal positions and equal group become one point', [
    title(20, 'In the file'),
    grid(25, 90),
    at('95,60 95,140 111,60 111,140').map((p) => dot(p, target)),
    text([103, 172], 'four vertices along a UV seam', mid),
    arrow([205, 95], [245, 95], faint),
    title(270, 'Welded, same group'),
    polygon(at('275,90 345,60 345,140'), '#eeeeee', { color: target }),
    polygon(at('345,60 415,90 345,140'), '#eeeeee', { color: target }),
    at('345,60 345,140').map((p) => dot(p, cosmetic, 6)),
    text([345, 172], 'two points, one segment', mid),
    title(480, 'Two groups'),
    polygon(at('490,90 560,60 560,140'), '#eeeeee', { color: target }),
    polygon(at('560,60 630,90 560,140'), '#e6dff0', { color: culled }),
    at('557,60 557,140').map((p) => dot(p, cosmetic, 6)),
    at('563,60 563,140').map((p) => dot(p, culled, 6)),
    text([560, 172], 'four points, two segments', mid),
  ]);
};

const project = () => {
  const a = [30, 110];
  const b = [170, 62];
  const c = [320, 105];
  const p = [214, 168];
  const foot = between(b, c, 0.42);
  return figure(700, 225, 'The closest point on the cage, and the ray along the normal of its triangle', [
    title(20, 'The closest point'),
    line([a, b, c], cage, { width: 3 }),
    line([p, foot], faint, { dash: '5 4' }),
    arrow(foot, [foot[0] + 17, foot[1] - 60], cage, { width: 2 }),
    label([foot[0] + 22, foot[1] - 42], '*n*', cage),
    dot(foot, cage),
    label([foot[0] - 22, foot[1] - 8], '*q*', cage),
    dot(p, target),
    label([p[0] + 10, p[1] + 6], '*p*'),
    label([p[0] - 38, p[1] - 38], '*d*'),
    text([20, 203], 'UV(p): blend of the triangle’s UVs at q', small),
    title(380, 'A tie, at a shared edge'),
    line(at('400,52 520,100 660,84'), cage, { width: 3 }),
    line(at('520,100 620,140'), faint, { dash: '3 5' }),
    line(at('520,100 400,113.7'), faint, { dash: '3 5' }),
    line(at('520,100 533,158'), faint, { dash: '5 4' }),
    dot([520, 100], cage),
    dot([533, 158], target),
    label([545, 163], '*p*'),
    label([515, 88], '*q*', cage),
    label([440, 58], 'T₁', cage),
    label([610, 78], 'T₂', cage),
    lines(
      [380, 186],
      ['q lies on both. The triangle whose plane is farthest', 'from p is taken (here T₂), then the lowest index.'],
      small,
    ),
  ]);
};

const occludedFigure = () => {
  const gum = at('20,190 70,150 120,118 165,110 190,122 196,142 180,156 140,160 100,178 70,205');
  const outer = at('14,140 70,92 140,62 215,70 300,130');
  return figure(700, 256, 'A self-intersection hides a point; the ray ends a little beyond the cage', [
    title(20, '2 · A tooth behind a lip'),
    curve(outer, cage, { width: 3 }),
    curve(gum, target),
    text([98, 112], 'lip', { ...small, color: target }),
    curve(at('150,225 146,190 160,176 176,190 172,225'), target),
    text([184, 215], 'tooth', { ...small, color: target }),
    arrow([160, 176], [163, 74], occluded),
    cross([161, 158], occluded),
    cross([163, 110], occluded),
    dot([160, 176], occluded),
    label([172, 172], '*p*', occluded),
    lines([215, 178], ['The ray meets the target:', 'p is *occluded*.'], small),
    title(370, '2′ · Two legs'),
    line(at('420,60 420,205'), target),
    line(at('480,60 480,205'), target),
    line(at('580,60 580,205'), target),
    line(at('640,60 640,205'), target),
    line(at('405,50 405,208'), cage, { width: 3 }),
    line(at('495,50 495,208'), cage, { width: 3 }),
    line(at('565,50 565,208'), cage, { width: 3 }),
    line(at('655,50 655,208'), cage, { width: 3 }),
    rectangle(495, 118, 26, 44, occluded, { opacity: 0.15 }),
    arrow([480, 140], [522, 140], cosmetic),
    line(at('522,140 578,140'), faint, { dash: '4 4' }),
    cross([580, 140], faint),
    dot([480, 140], cosmetic),
    label([460, 132], '*p*', cosmetic),
    text([508, 178], 'reach', mid),
    lines(
      [530, 228],
      ['The other leg lies farther beyond the cage than', 'the reach of 0.03, so p is not occluded.'],
      mid,
    ),
  ]);
};

const uncoveredFigure = () =>
  figure(700, 230, 'The ray leaves through a hole of the cage; a point slightly outside counts as covered', [
    title(20, '3 · A hole for an eye'),
    curve(at('20,170 70,120 120,96'), cage, { width: 3 }),
    curve(at('220,92 270,112 325,165'), cage, { width: 3 }),
    dot([120, 96], cage, 4),
    dot([220, 92], cage, 4),
    circle(170, 160, 44, target),
    curve(at('20,200 80,140 128,118'), target),
    curve(at('214,115 262,136 320,195'), target),
    arrow([168, 116], [160, 46], uncovered),
    dot([168, 116], uncovered),
    label([178, 112], '*p*', uncovered),
    line(at('168,116 220,92'), faint, { dash: '5 4' }),
    arrow([75, 144], [52, 100], cosmetic),
    dot([75, 144], cosmetic),
    key([200, 44], uncovered, 'no cage hit: *uncovered*'),
    key([20, 64], cosmetic, 'hits the cage'),
    title(380, '3′ · A nose that pokes through'),
    curve(at('400,190 470,110 530,90 590,110 660,190'), cage, { width: 3 }),
    curve(at('400,215 470,130 512,92 530,74 548,92 590,130 660,215'), target),
    line(at('530,74 530,90'), faint),
    dot([530, 74], cosmetic),
    label([542, 72], '*p*', cosmetic),
    lines([530, 178], ['outside the cage by at', 'most 0.0025: covered'], mid),
  ]);

const segments = () => {
  const window = (x, y) => {
    const corners = [
      [x, y],
      [x + 130, y],
      [x + 130, y + 90],
      [x, y + 90],
    ];
    const samples = (a, b, c) => {
      const at = (u, v, w) => [(u * a[0] + v * b[0] + w * c[0]) / 6, (u * a[1] + v * b[1] + w * c[1]) / 6];
      return [at(4, 1, 1), at(1, 4, 1), at(1, 1, 4), at(2, 2, 2)].map((p) => dot(p, uncovered));
    };
    const [a, b, c, d] = corners;
    return [
      rectangle(x - 14, y - 14, 158, 118, '#e9f1fa', { color: 'none' }),
      polygon(corners, '#ffffff', { color: target }),
      line([a, c], target, { width: 1.5 }),
      rectangle(x + 7, y + 7, 116, 76, 'none', { color: cage, dash: '6 4' }),
      samples(a, b, c),
      samples(a, c, d),
      corners.map((p) => dot(p, cosmetic)),
    ];
  };
  const strip = (x, y, n, color) =>
    Array.from({ length: n }, (_, i) => [
      polygon(
        [
          [x + 34 * i, y],
          [x + 34 * i + 34, y],
          [x + 34 * i + 17, y + 30],
        ],
        'none',
        { color },
      ),
      polygon(
        [
          [x + 34 * i + 34, y],
          [x + 34 * i + 51, y + 30],
          [x + 34 * i + 17, y + 30],
        ],
        'none',
        { color },
      ),
    ]);
  return figure(
    700,
    240,
    'Segments are connected components; big triangles near a hole are judged by samples inside them',
    [
      title(20, '4 · Segments'),
      strip(30, 60, 5, cosmetic),
      text([30, 110], 'segment 0: the skin', small),
      strip(30, 130, 2, culled),
      text([30, 180], 'segment 1: an eye', small),
      strip(180, 130, 2, occluded),
      text([180, 180], 'segment 2: a tooth', small),
      lines([20, 212], ['A triangle gives a third of its area to each point.'], small),
      title(360, '4′ · Interior samples'),
      window(376, 60),
      key([530, 70], cosmetic, 'corners, on the frame:'),
      text([541, 87], 'under the cage', small),
      key([530, 116], uncovered, 'samples inside:'),
      text([541, 133], 'under the hole', small),
      line(at('526,160 548,160'), cage, { dash: '6 4' }),
      text([556, 164], 'boundary loop', small),
      lines(
        [360, 200],
        ['A pane of two triangles, from the front. Each gives', 'a quarter of its area to each of its four samples.'],
        small,
      ),
    ],
  );
};

const score = () => {
  const bar = (y, name, [a, e, c, d]) => {
    const at = (share) => 130 + 210 * share;
    return [
      text([122, y + 20], name, { ...small, anchor: 'end' }),
      rectangle(130, y, 210 * a, 28, '#dddddd', { color: '#999999' }),
      rectangle(130, y, 210 * e, 28, '#f6d9ae', { color: uncovered }),
      rectangle(130, y, 210 * c, 28, '#bfe3c8', { color: cosmetic }),
      rectangle(130, y + 9, 210 * d, 10, cosmetic),
      text([at(a) + 8, y + 20], '', small),
    ];
  };
  return figure(700, 250, 'Areas of a segment, and depth under the cage', [
    title(20, '5 · What is compared'),
    bar(48, 'skin', [1, 0.93, 0.9, 0.87]),
    bar(90, 'skin under a coat', [1, 0.16, 0.15, 0.14]),
    bar(132, 'an eye', [1, 0.42, 0.13, 0.1]),
    bar(174, 'a tooth', [1, 0.47, 0.47, 0.08]),
    rectangle(20, 222, 12, 12, '#dddddd', { color: '#999999' }),
    text([38, 233], 'A whole', small),
    rectangle(100, 222, 12, 12, '#f6d9ae', { color: uncovered }),
    text([118, 233], 'E exposed', small),
    rectangle(195, 222, 12, 12, '#bfe3c8', { color: cosmetic }),
    text([213, 233], 'C covered', small),
    rectangle(292, 224, 12, 8, cosmetic),
    text([310, 233], 'D by depth', small),
    title(430, '5′ · Depth'),
    curve(at('440,90 500,62 570,58 640,70 685,92'), cage, { width: 3 }),
    curve(at('440,106 490,84 530,76 548,90 542,110'), target),
    curve(at('604,112 598,92 612,78 650,88 685,108'), target),
    curve(at('552,200 556,158 572,140 588,158 592,200'), target),
    line(at('520,78 519,62'), cosmetic),
    line(at('628,81 630,68'), cosmetic),
    line(at('572,140 571,59'), occluded, { dash: '4 3' }),
    dot([520, 78], cosmetic),
    dot([628, 81], cosmetic),
    dot([572, 140], occluded),
    text([600, 160], 'tongue', small),
    text([455, 128], 'lip', small),
    text([650, 128], 'lip', small),
    lines([440, 222], ['d is several times the typical depth:', 'its area counts (typical / d)² times.'], small),
  ]);
};

const holeContents = () =>
  figure(700, 240, 'A small part that a hole of the cage is meant for', [
    title(20, '5‴ · Bare: the cage is a little aside'),
    curve(at('20,150 80,108 150,90'), cage, { width: 3 }),
    curve(at('222,88 270,104 330,150'), cage, { width: 3 }),
    dot([150, 90], cage, 4),
    dot([222, 88], cage, 4),
    circle(168, 150, 40, target),
    curve(at('20,190 80,150 124,124'), target),
    curve(at('212,122 262,146 325,190'), target),
    line(
      Array.from({ length: 12 }, (_, i) => [
        168 + 40 * Math.cos(-2.4 + i * 0.09),
        150 + 40 * Math.sin(-2.4 + i * 0.09),
      ]),
      cosmetic,
      { width: 4 },
    ),
    line(
      Array.from({ length: 16 }, (_, i) => [
        168 + 40 * Math.cos(-1.41 + i * 0.07),
        150 + 40 * Math.sin(-1.41 + i * 0.07),
      ]),
      uncovered,
      { width: 4 },
    ),
    lines(
      [20, 214],
      ['Mostly covered, but more than 0.15 of it lies', 'bare under a hole that no other part explains.'],
      small,
    ),
    title(380, '5‴ · Hidden: behind glasses'),
    curve(at('400,150 450,108 490,94'), cage, { width: 3 }),
    curve(at('590,94 630,108 680,150'), cage, { width: 3 }),
    dot([490, 94], cage, 4),
    dot([590, 94], cage, 4),
    line(at('470,76 610,76'), target, { width: 4 }),
    text([616, 72], 'lens', small),
    circle(540, 150, 40, target),
    curve(at('400,190 450,150 494,124'), target),
    curve(at('586,122 632,146 680,190'), target),
    line(
      Array.from({ length: 18 }, (_, i) => [
        540 + 40 * Math.cos(-2.2 + i * 0.075),
        150 + 40 * Math.sin(-2.2 + i * 0.075),
      ]),
      occluded,
      { width: 4 },
    ),
    arrow([540, 110], [540, 80], occluded),
    cross([540, 76], occluded),
    lines(
      [380, 214],
      ['The lens occludes most of the eye: more than', '0.25 of it lies hidden under the hole.'],
      small,
    ),
  ]);

const recheck = () => {
  const p = [150, 168];
  const fan = [-84, -70, -56, -42, -28, -14, 14, 28, 42, 56, 70, 84];
  const seen = new Set([14, 28]);
  return figure(700, 250, 'Occluded points are recovered if rays in other directions reach the cage', [
    title(20, '6 · Twelve directions'),
    curve(at('20,108 90,62 170,50 250,62 325,108'), cage, { width: 3 }),
    curve(
      [
        [20, 140],
        [70, 96],
        [110, 84],
        [142, 92],
        [138, 112],
        [112, 128],
        [104, 146],
        [120, 164],
        p,
        [186, 156],
        [230, 120],
        [270, 104],
        [320, 140],
      ],
      target,
    ),
    fan.map((degrees) => {
      const angle = ((degrees - 90) * Math.PI) / 180;
      const good = seen.has(degrees);
      const reach = good ? 118 : degrees < 0 ? 46 : 40;
      const tip = [p[0] + reach * Math.cos(angle), p[1] + reach * Math.sin(angle)];
      return good ? arrow(p, tip, cosmetic, { width: 2 }) : line([p, tip], faint, { width: 1.5 });
    }),
    dot(p, occluded),
    label([p[0] - 4, p[1] + 20], '*p*', occluded),
    lines([20, 214], ['Two rays reach the cage past the target:', 'p becomes cosmetic.'], small),
    title(380, 'How it spreads'),
    Array.from({ length: 9 }, (_, i) => {
      const x = 400 + 33 * i;
      const color = i < 2 ? cosmetic : i < 5 ? cosmetic : occluded;
      return [
        i < 8
          ? line(
              [
                [x, 120],
                [x + 33, 120],
              ],
              target,
            )
          : '',
        dot([x, 120], color, 7),
        i === 2 || i === 3 || i === 4 ? circle(x, 120, 11, cosmetic, { width: 1.5 }) : '',
        i === 5 ? cross([x, 96], occluded) : '',
      ];
    }),
    arrow([450, 92], [540, 92], cosmetic),
    text([386, 160], 'not occluded', small),
    text([476, 160], 'recovered', small),
    text([556, 160], 'rejected', small),
    text([612, 160], 'not tested', small),
    lines(
      [380, 196],
      [
        'Begin next to points that are not occluded.',
        'After a recovered point, its occluded',
        'neighbours are tested too.',
      ],
      small,
    ),
  ]);
};

const holes = () =>
  figure(700, 240, 'Uncovered points are recovered unless the hole is meant for them', [
    title(20, '7 · A lid over an explained hole'),
    curve(at('20,140 70,104 130,88'), cage, { width: 3 }),
    curve(at('236,88 280,102 330,140'), cage, { width: 3 }),
    dot([130, 88], cage, 4),
    dot([236, 88], cage, 4),
    circle(183, 160, 42, culled),
    curve(at('20,176 80,132 130,112 152,112 150,122'), target),
    curve(at('214,122 214,112 240,112 282,132 326,176'), target),
    line(at('130,88 130,70'), faint),
    line(at('152,112 152,70'), faint),
    arrow([141, 75], [131, 75], target, { width: 1 }),
    arrow([141, 75], [151, 75], target, { width: 1 }),
    text([141, 64], 'h', mid),
    dot([152, 112], cosmetic),
    lines([183, 160], ['eyeball,', 'culled'], { ...mid, color: culled }),
    lines([20, 220], ['h ≤ 0.03, and an eyeball explains the hole.'], small),
    title(380, 'The open end of a cage at a neck'),
    line(at('440,60 440,132'), cage, { width: 3 }),
    line(at('640,60 640,132'), cage, { width: 3 }),
    dot([440, 132], cage, 4),
    dot([640, 132], cage, 4),
    curve(at('456,50 458,90 456,132'), target),
    curve(at('624,50 622,90 624,132'), target),
    curve(at('456,132 450,165 410,195'), uncovered),
    curve(at('624,132 630,165 672,195'), uncovered),
    dot([452, 160], uncovered),
    dot([629, 160], uncovered),
    text([540, 100], 'neck', mid),
    text([540, 182], 'no part lies here', mid),
    lines([380, 220], ['No part explains it: points below stay uncovered.'], small),
  ]);

const triangles = () => {
  const one = (x, colors, isPainted, caption) => {
    const corners = [
      [x, 130],
      [x + 90, 130],
      [x + 45, 60],
    ];
    return [
      polygon(corners, isPainted ? '#bfe3c8' : '#f2f2f2', { color: target }),
      corners.map((p, i) => dot(p, colors[i], 7)),
      lines([x + 45, 158], caption, mid),
    ];
  };
  return figure(700, 225, 'Which triangles are cosmetic', [
    title(20, '8 · Cosmetic triangles'),
    one(40, [cosmetic, cosmetic, cosmetic], true, ['all cosmetic', 'painted']),
    one(205, [cosmetic, occluded, occluded], true, ['the rest occluded', 'painted']),
    one(370, [cosmetic, cosmetic, uncovered], false, ['one uncovered', 'not painted']),
    one(535, [occluded, occluded, occluded], false, ['none cosmetic', 'not painted']),
    key([40, 212], cosmetic, 'cosmetic'),
    key([150, 212], occluded, 'occluded'),
    key([260, 212], uncovered, 'uncovered (or culled)'),
  ]);
};

const seams = () => {
  const texture = (x, content) => [
    rectangle(x, 60, 150, 130, '#f7fafd', { color: faint }),
    text([x + 75, 54], 'texture', mid),
    content,
  ];
  const left = at('0,0 52,0 52,110 0,110');
  const chart = (x, y, fill) =>
    polygon(
      left.map(([u, v]) => [x + u, y + v]),
      fill,
      { color: cage },
    );
  const corners = at('70,96 70,150 142,120');
  return figure(700, 225, 'A triangle across a seam of the texture gets UVs per corner', [
    title(20, '9 · On the target'),
    polygon(at('30,70 106,70 106,190 30,190'), '#e9f1fa', { color: faint }),
    polygon(at('106,70 182,70 182,190 106,190'), '#fdf1e0', { color: faint }),
    line(at('106,70 106,190'), cage, { width: 3 }),
    polygon(corners, '#bfe3c8', { color: target, opacity: 0.8 }),
    corners.map((p, i) => dot(p, i === 2 ? uncovered : cosmetic)),
    text([106, 210], 'a seam runs through it', mid),
    title(240, 'UVs per vertex'),
    texture(240, [
      chart(248, 70, '#e9f1fa'),
      chart(330, 70, '#fdf1e0'),
      polygon(at('285,92 285,142 352,118'), occluded, { opacity: 0.35, color: occluded }),
      at('285,92 285,142').map((p) => dot(p, cosmetic)),
      dot([352, 118], uncovered),
    ]),
    text([315, 210], 'smeared over the texture', mid),
    title(470, 'UVs per corner'),
    texture(470, [
      chart(478, 70, '#e9f1fa'),
      chart(560, 70, '#fdf1e0'),
      polygon(at('505,92 505,142 530,116'), cosmetic, { opacity: 0.5, color: cosmetic }),
      at('505,92 505,142 530,116').map((p) => dot(p, cosmetic)),
    ]),
    lines([545, 208], ['all three projected onto the part of', 'one chart that is near'], { ...mid, size: 11 }),
  ]);
};

const borders = () => {
  const loop = (t) => [40 + 250 * t, 120 + 34 * Math.sin(5 * t)];
  const wave = (dx) =>
    curve(
      Array.from({ length: 21 }, (_, i) => [loop(i / 20)[0] + dx, loop(i / 20)[1]]),
      cage,
      { width: 3 },
    );
  const above = ([x, y], dx) => y < 120 + 34 * Math.sin((5 * (x - dx - 40)) / 250);
  const cells = (dx) => {
    const out = [];
    for (let i = 0; i < 5; ++i)
      for (let j = 0; j < 3; ++j) {
        const [x, y] = [40 + dx + 50 * i, 60 + 44 * j];
        out.push(
          [
            [x, y],
            [x + 50, y],
            [x, y + 44],
          ],
          [
            [x + 50, y],
            [x + 50, y + 44],
            [x, y + 44],
          ],
        );
      }
    return out;
  };
  const region = Array.from({ length: 41 }, (_, i) => loop(i / 40)).map(([x, y]) => [x + 340, y]);
  return figure(700, 240, 'Triangles painted whole, and triangles cut along the projected boundary loop', [
    title(20, '10 · Triangles as a whole'),
    cells(0).map((t) => polygon(t, t.every((p) => above(p, 0)) ? '#bfe3c8' : '#ffffff', { color: faint })),
    wave(0),
    text([165, 218], 'the paint ends at jagged triangles', mid),
    title(360, 'Cut at the projected boundary loop'),
    polygon([[380, 60], [630, 60], ...region.reverse()], '#bfe3c8'),
    cells(340).map((t) => polygon(t, 'none', { color: faint })),
    wave(340),
    text([505, 218], 'it ends where the cage does', mid),
  ]);
};

const figures = {
  weld: weld(),
  project: project(),
  occluded: occludedFigure(),
  uncovered: uncoveredFigure(),
  segments: segments(),
  score: score(),
  'hole-contents': holeContents(),
  recheck: recheck(),
  holes: holes(),
  triangles: triangles(),
  seams: seams(),
  borders: borders(),
  architecture: architecture(),
};
// With --check nothing is written; what differs is named.
const isCheck = process.argv.includes('--check');
for (const [name, svg] of Object.entries(figures)) {
  const file = fileURLToPath(new URL(`${name}.svg`, import.meta.url));
  if (!isCheck) writeFileSync(file, svg);
  else if (!existsSync(file) || readFileSync(file, 'utf8') !== svg)
    console.log(`docs/figures/${name}.svg is stale: node docs/figures/make.mjs`);
}
