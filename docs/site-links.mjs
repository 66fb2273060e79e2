// Shows Doxygen a page of this folder with links that hold in the site of `npm run docs`: to its other pages, and to files in the repository.
//
//   node docs/site-links.mjs PAGE
import { readFileSync } from 'node:fs';
import { relative, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';

const root = fileURLToPath(new URL('..', import.meta.url));
const { repository } = JSON.parse(readFileSync(resolve(root, 'package.json'), 'utf8'));
const address = `${repository.url.replace(/^git\+|\.git$/g, '')}/blob/main`;

const text = readFileSync(process.argv[2], 'utf8').replace(/\[([^\]]*)\]\(([^)]*)\)/g, (link, words, to) => {
  if (/^\w+:/.test(to)) return link;
  if (to.startsWith('#')) return words; // Doxygen gives headings other names
  const [, page, heading = ''] = /^(\w+)\.md(#.*)?$/.exec(to) ?? [];
  // As HTML, because Doxygen looks for the pages of links among its own.
  const target = page
    ? `../javascript/documents/${page}.html${heading}`
    : `${address}/${relative(root, resolve(root, 'docs', to))}`;
  return `<a href="${target}">${words}</a>`;
});
process.stdout.write(text);
