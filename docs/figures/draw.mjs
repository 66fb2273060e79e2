// A few lines of SVG for the figures of the documentation. Coordinates are pixels, y points down.

export const kColors = {
  cage: '#2f6fb7',
  target: '#4a4a4a',
  cosmetic: '#2a9d4a',
  occluded: '#d1495b',
  uncovered: '#e08a1e',
  culled: '#7b5ea7',
  faint: '#b5b5b5',
  text: '#222222',
};

const number = (x) => String(Math.round(x * 100) / 100);
const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');
const attributes = (values) =>
  Object.entries(values)
    .filter(([, value]) => value !== undefined)
    .map(([name, value]) => ` ${name}="${typeof value === 'number' ? number(value) : value}"`)
    .join('');
const element = (name, values) => `<${name}${attributes(values)}/>`;
const stroke = (color, { width = 2, dash } = {}) => ({
  stroke: color,
  'stroke-width': width,
  'stroke-dasharray': dash,
  'stroke-linecap': 'round',
  'stroke-linejoin': 'round',
});

/** A straight line through points. */
export const line = (points, color, style = {}) =>
  element('polyline', {
    points: points.map((p) => p.map(number).join(',')).join(' '),
    fill: 'none',
    ...stroke(color, style),
  });

/** A smooth curve through points (Catmull-Rom). */
export function curve(points, color, style = {}) {
  const at = (i) => points[Math.min(Math.max(i, 0), points.length - 1)];
  let path = `M${points[0].map(number).join(' ')}`;
  for (let i = 0; i + 1 < points.length; ++i) {
    const [a, b, c, d] = [at(i - 1), at(i), at(i + 1), at(i + 2)];
    const first = [b[0] + (c[0] - a[0]) / 6, b[1] + (c[1] - a[1]) / 6];
    const second = [c[0] - (d[0] - b[0]) / 6, c[1] - (d[1] - b[1]) / 6];
    path += `C${[...first, ...second, ...c].map(number).join(' ')}`;
  }
  return element('path', { d: path, fill: style.fill ?? 'none', ...stroke(color, style) });
}

/** A filled polygon. */
export const polygon = (points, fill, { color = 'none', opacity, width = 1.5 } = {}) =>
  element('polygon', {
    points: points.map((p) => p.map(number).join(',')).join(' '),
    fill,
    'fill-opacity': opacity,
    stroke: color,
    'stroke-width': width,
    'stroke-linejoin': 'round',
  });

export const rectangle = (x, y, width, height, fill, { color = 'none', radius = 0, opacity, dash } = {}) =>
  element('rect', {
    x,
    y,
    width,
    height,
    rx: radius,
    fill,
    'fill-opacity': opacity,
    stroke: color,
    'stroke-width': 1.5,
    'stroke-dasharray': dash,
  });

export const circle = (x, y, radius, color, { fill = 'none', width = 2, dash } = {}) =>
  element('circle', { cx: x, cy: y, r: radius, fill, stroke: color, 'stroke-width': width, 'stroke-dasharray': dash });

/** A point of the target, or a place on the cage. */
export const dot = ([x, y], color, radius = 5) => circle(x, y, radius, '#ffffff', { fill: color, width: 1.5 });

/** An arrow from one point to another. */
export function arrow([x0, y0], [x1, y1], color, style = {}) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length];
  const [bx, by] = [x1 - 9 * ux, y1 - 9 * uy];
  const head = [
    [x1, y1],
    [bx - 4.5 * uy, by + 4.5 * ux],
    [bx + 4.5 * uy, by - 4.5 * ux],
  ];
  return (
    line(
      [
        [x0, y0],
        [bx, by],
      ],
      color,
      style,
    ) + polygon(head, color)
  );
}

/** A line of text; `anchor` is start, middle or end. Text between asterisks is italic. */
export function text([x, y], content, { color = kColors.text, size = 13, anchor = 'start', bold = false } = {}) {
  const styled = escaped(content).replace(/\*([^*]+)\*/g, '<tspan font-style="italic">$1</tspan>');
  const values = { x, y, fill: color, 'font-size': size, 'text-anchor': anchor, 'font-weight': bold ? 600 : undefined };
  return `<text${attributes(values)}>${styled}</text>`;
}

/** Several lines of text. */
export const lines = ([x, y], contents, style = {}) =>
  contents.map((content, i) => text([x, y + 17 * i], content, style)).join('\n');

/** A heading of a panel. */
export const title = (x, content) => text([x, 24], content, { bold: true, size: 14 });

/** A mark over a hit that counts, or does not. */
export const cross = ([x, y], color, size = 5) =>
  line(
    [
      [x - size, y - size],
      [x + size, y + size],
    ],
    color,
    { width: 2.5 },
  ) +
  line(
    [
      [x - size, y + size],
      [x + size, y - size],
    ],
    color,
    { width: 2.5 },
  );

/** A whole figure. Its background is white, so that it can be read on dark pages too. */
export function figure(width, height, description, parts) {
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" width="${width}" height="${height}" role="img" font-family="system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif">
<title>${escaped(description)}</title>
${rectangle(0, 0, width, height, '#ffffff', { radius: 8 })}
${parts.flat(3).join('\n')}
</svg>
`;
}
