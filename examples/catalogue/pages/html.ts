// The plain pages of the catalogue.

/** A text in HTML, also as the value of an attribute. */
export const text = (value: string): string => value.replace(/[&<>"]/g, (symbol) => `&#${symbol.charCodeAt(0)};`);
export const section = (title: string, content: string): string => `<h2>${title}</h2>\n${content}`;

export function table(head: string[], rows: string[][]): string {
  if (rows.length === 0) return '<p>None.</p>';
  const row = (cells: string[], tag: string) =>
    `<tr>${cells.map((cell) => `<${tag}>${text(cell)}</${tag}>`).join('')}</tr>`;
  return `<table>${row(head, 'th')}${rows.map((cells) => row(cells, 'td')).join('')}</table>`;
}

export const page = (sections: string[]): string => `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Catalogue</title>
<style>
  body { font: 15px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem; color: #1c1f24; background: #fff; }
  h1 { font-size: 1.4rem; } h2 { font-size: 1.1rem; margin-top: 2.2rem; } h3 { font-size: 1rem; margin: 0; overflow-wrap: anywhere; }
  table { border-collapse: collapse; } td, th { padding: .2rem 1rem .2rem 0; text-align: left; vertical-align: top; font-weight: normal; overflow-wrap: break-word; }
  th { color: #555; border-bottom: 1px solid #ccc; } article { margin: 1.2rem 0 2rem; } article p { margin: .2rem 0 .6rem; color: #555; }
  article img { width: 24%; height: auto; background: #f3f3f0; border-radius: .3rem; margin-right: 1%; }
</style>
<h1>Catalogue</h1>
${sections.join('\n')}
</html>
`;
