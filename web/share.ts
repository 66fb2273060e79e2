import { copyFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import type { Plugin } from 'vite';

const kPicture = fileURLToPath(new URL('../docs/pictures/share.jpg', import.meta.url));

/**
 * Gives the page the picture, title and text that messengers and social networks show for a link to it (Open Graph), and
 * its canonical address.
 * The protocol wants whole URLs: set CAGECAST_URL to the address at which the page will be. Without it, the picture is named as a
 * file beside the page, which some readers understand.
 */
export function share(address = process.env['CAGECAST_URL']): Plugin {
  if (address !== undefined && !URL.canParse(address))
    throw new Error(`CAGECAST_URL is “${address}”, not a URL such as https://example.org/cagecast/`);
  const picture = address ? new URL('share.jpg', address).href : './share.jpg';
  const meta = (property: string, content: string) => ({ tag: 'meta', attrs: { property, content } });
  let folder: string;
  return {
    name: 'cagecast-share',
    apply: 'build',
    configResolved: (config) => void (folder = path.resolve(config.root, config.build.outDir)),
    transformIndexHtml: (html) => {
      const description = /<meta\s+name="description"\s+content="([^"]*)"/.exec(html)?.[1] ?? '';
      return [
        meta('og:type', 'website'),
        meta('og:title', /<title>(.*?)<\/title>/.exec(html)?.[1] ?? ''),
        meta('og:description', description),
        ...(address ? [meta('og:url', address), { tag: 'link', attrs: { rel: 'canonical', href: address } }] : []),
        meta('og:image', picture),
        meta('og:image:width', '1200'),
        meta('og:image:height', '630'),
        meta('og:image:alt', 'A lizard’s head, a human head and a car, painted by Cagecast'),
        { tag: 'meta', attrs: { name: 'twitter:card', content: 'summary_large_image' } },
      ];
    },
    writeBundle: () => copyFile(kPicture, path.join(folder, 'share.jpg')),
  };
}
