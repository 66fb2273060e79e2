import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join } from 'node:path';

const types: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/**
 * Serves a folder. A path that begins with /app/ is answered with a page if there is no such file, as servers of single-page
 * applications do.
 * @param folders  Where files are, the first that has one first.
 * @param headers  Of every answer.
 */
export async function serve(folders: string | readonly string[], headers: Record<string, string> = {}) {
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost');
    const places = [folders].flat().map((folder) => join(folder, pathname));
    const file = places.find((place) => existsSync(place)) ?? places[0]!;
    const type = types[extname(file)] ?? 'application/octet-stream';
    if (existsSync(file) && extname(file) !== '')
      response.writeHead(200, { 'content-type': type, ...headers }).end(readFileSync(file));
    else if (pathname.startsWith('/app/'))
      response.writeHead(200, { 'content-type': 'text/html' }).end('<!doctype html>');
    else response.writeHead(404).end();
  });
  await new Promise<void>((done) => server.listen(0, '127.0.0.1', done));
  return {
    origin: `http://127.0.0.1:${(server.address() as AddressInfo).port}`,
    close: () => {
      server.close();
      server.closeAllConnections();
    },
  };
}
