// Writes the first page of the documentation that `npm run docs` makes, build/docs/index.html: it leads each kind of user to a page. All pages
// work offline, from any folder. A link that leads nowhere is an error.
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const site = fileURLToPath(new URL('../build/docs', import.meta.url));

const kPages = {
  'javascript/documents/three.html': ['A three.js page', 'paint models that your page loads'],
  'javascript/documents/tooling.html': ['Model files', 'the command, and functions that take and give bytes'],
  'cpp/index.html': ['C++', 'two libraries, and their reference'],
  'javascript/documents/page.html': ['The demo page', 'what it can do, its keys, and how to serve it'],
  'javascript/index.html': ['All else', 'overview, method, evaluation, and the JavaScript reference'],
};
const items = Object.entries(kPages).map(
  ([to, [title, text]]) => `<li><a href="${to}"><b>${title}</b><span>${text}</span></a></li>`,
);
writeFileSync(
  join(site, 'index.html'),
  `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Cagecast: documentation</title>
<link rel="icon" href="data:,">
<style>
  :root { color-scheme: light dark }
  body { font: 1.1em/1.5 system-ui; max-width: 44em; margin: 0 auto; padding: 2em 1em }
  img { width: 100%; max-width: 26em; height: auto; border-radius: 0.5em }
  ul { display: grid; grid-template-columns: repeat(auto-fit, minmax(15em, 1fr)); gap: 0.8em; padding: 0; list-style: none }
  a { display: block; height: 100%; box-sizing: border-box; padding: 0.8em 1em; border: 1px solid #8886; border-radius: 0.5em; color: inherit; text-decoration: none }
  a:is(:hover, :focus-visible) { border-color: #0c6e56 }
  span { display: block; font-size: 0.9em }
</style>
<h1>Cagecast</h1>
<p>Draw a texture once for a cage, a simple mesh around a character. Cagecast transfers it to any mesh, and leaves out what must not be painted.</p>
<img src="javascript/media/compare.jpg" alt="A lizard's head. Left half: a naive transfer paints eye, teeth and tongue. Right half: Cagecast leaves them unpainted">
<ul>${items.join('')}</ul>
</html>
`,
);

const pages = readdirSync(site, { recursive: true }).filter((file) => file.endsWith('.html'));
const dead = [];
for (const page of pages) {
  const file = join(site, page);
  const text = readFileSync(file, 'utf8');
  // TypeDoc leaves the address of its link to C++ as it is in every folder.
  if (/^javascript[\\/]\w+[\\/]/.test(page))
    writeFileSync(file, text.replaceAll('href="../cpp/index.html"', 'href="../../cpp/index.html"'));
  for (const [, link] of readFileSync(file, 'utf8').matchAll(/(?:href|src)="([^"#?]+)[^"]*"/g))
    if (!/^(\w+:|\/\/)/.test(link) && !existsSync(join(dirname(file), decodeURIComponent(link))))
      dead.push(`${page}: ${link}`);
}
if (dead.length > 0) {
  console.error(`These links lead nowhere:\n${dead.join('\n')}`);
  process.exit(1);
}
