import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import type { AddressInfo } from 'node:net';
import { tmpdir } from 'node:os';
import { extname, join, resolve } from 'node:path';

/** The packages of this folder: bundlers, test runners, old compilers, and peers that only examples need. */
export const hostTools = resolve('tests/release/hosts/node_modules');

/** Runs a command, which must succeed. @returns what it wrote. */
export function run(command: string, args: string[], cwd: string, env: Record<string, string> = {}): string {
  const { status, stdout, stderr } = spawnSync(command, args, {
    cwd,
    encoding: 'utf8',
    env: { ...process.env, NODE_OPTIONS: '', ...env },
  });
  assert.equal(status, 0, `${command} ${args.join(' ')}:\n${stdout}${stderr}`);
  return stdout + stderr;
}

/** An empty folder of a user, into which the packed package is installed as npm does it, without a network. */
export function installPacked(): string {
  const user = mkdtempSync(join(tmpdir(), 'cagecast-host-'));
  const pack = run('npm', ['pack', '--json', '--ignore-scripts', '--pack-destination', user], process.cwd());
  const file = /"filename": "([^"]+)"/.exec(pack)![1]!;
  // Without the setting Parcel does not read "exports".
  const manifest = { private: true, type: 'module', '@parcel/resolver-default': { packageExports: true } };
  writeFileSync(join(user, 'package.json'), JSON.stringify(manifest));
  run('npm', ['install', '--offline', '--no-audit', '--no-fund', '--ignore-scripts', join(user, file)], user);
  return user;
}

const types: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript', '.wasm': 'application/wasm' };

/**
 * Serves a folder. A path that begins with /app/ is answered with a page if there is no such file, as servers of single-page
 * applications do.
 * @param headers  Of every answer.
 */
export async function serve(folder: string, headers: Record<string, string> = {}) {
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url ?? '/', 'http://localhost');
    const file = join(folder, pathname);
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
