// Writes the first page of the documentation that `npm run docs` makes, build/docs/index.html: it leads each kind of user to a page. All pages
// work offline, from any folder. A link that leads nowhere is an error.
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const site = fileURLToPath(new URL('../build/docs', import.meta.url));

const links = {
  'javascript/index.html': 'Overview, and the JavaScript reference',
  'javascript/documents/three.html': 'In a three.js page',
  'javascript/documents/tooling.html': 'Model files in JavaScript tooling: the command and functions',
  'cpp/index.html': 'In C++, and its reference',
  'javascript/documents/page.html': 'The demo page',
};
const items = Object.entries(links).map(([to, text]) => `<li><a href="${to}">${text}</a></li>`);
writeFileSync(
  join(site, 'index.html'),
  `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>Cagecast</title>
<style>body { font: 1.1em/1.6 system-ui; max-width: 40em; margin: 3em auto; padding: 0 1em }</style>
<h1>Cagecast</h1>
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
