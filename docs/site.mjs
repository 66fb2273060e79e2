// Writes the first page of the documentation that `npm run docs` makes, build/docs/index.html: it leads to both references. All pages
// work offline, from any folder.
import { writeFileSync } from 'node:fs';

const links = {
  'javascript/index.html': 'Overview, guides and the JavaScript reference',
  'javascript/documents/cli.html': 'The command',
  'cpp/index.html': 'The C++ reference',
};
const items = Object.entries(links).map(([to, text]) => `<li><a href="${to}">${text}</a></li>`);
writeFileSync(
  new URL('../build/docs/index.html', import.meta.url),
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
