// npm run status: the queue as a page and as JSON, its metrics, and the report.
import { createServer, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname } from 'node:path';
import { pipeline } from 'node:stream/promises';
import { asFailure, Failure, meaningOf, publicOf, withoutSecrets } from './failure.ts';
import { type Catalogue, openCatalogue, type Result, resultOf } from './jobs.ts';
import { refusal } from './pages/guard.ts';
import { page, section, table } from './pages/html.ts';
import { watch } from './pages/metrics.ts';
import { settings } from './settings.ts';
import { openOutput } from './storage.ts';

/** How many jobs of each state are listed. */
const mostListed = 100;
/** Files in the output folder, and what else there may be. */
const types: Record<string, string> = {
  '.html': 'text/html; charset=utf-8',
  '.json': 'application/json',
  '.jsonl': 'application/jsonl',
  '.glb': 'model/gltf-binary',
};

type Latest = { counts: Record<string, number>; active: string[]; failed: Result[]; done: Result[] };

/** How many jobs there are in each state, and the latest of them. */
async function latest({ queue }: Catalogue): Promise<Latest> {
  const jobsIn = async (state: 'active' | 'failed' | 'completed') => {
    const ids = await queue.getRanges([state], 0, mostListed - 1);
    return (await Promise.all(ids.map((id) => queue.getJob(id)))).filter((job) => job !== undefined);
  };
  return {
    counts: await queue.getJobCounts(),
    active: (await jobsIn('active')).map(({ id }) => publicOf(String(id))),
    failed: (await jobsIn('failed')).map((job) => resultOf(job, 'failed')),
    done: (await jobsIn('completed')).map((job) => resultOf(job, 'done')),
  };
}

function queuePage({ counts, active, failed, done }: Latest): string {
  const about = ({ key, inputs }: Result) => [key, Object.values(inputs).join(' ')];
  const row = (result: Result) => [...about(result), result.error ?? result.verdict ?? ''];
  return page([
    '<p><a href="queue.json">As JSON</a> · <a href="metrics">metrics</a> · <a href="files/report.html">report</a></p>',
    table(
      ['state', 'jobs'],
      Object.entries(counts).map(([state, count]) => [state, String(count)]),
    ),
    section(
      'In progress',
      table(
        ['job'],
        active.map((id) => [id]),
      ),
    ),
    section(`Dead letters, the latest ${mostListed}`, table(['job', 'inputs', 'why'], failed.map(row))),
    section(`Done, the latest ${mostListed}`, table(['job', 'inputs', 'verdict'], done.map(row))),
  ]);
}

const send = (response: ServerResponse, type: string, body: string) =>
  void response.setHeader('Content-Type', type).end(body);
const say = (response: ServerResponse, status: number, text: string) => {
  response.statusCode = status;
  send(response, 'text/plain; charset=utf-8', `${withoutSecrets(text).slice(0, 500)}\n`);
};

/** Sends a file of the output folder. What it has in it must not act in the name of this page. */
async function sendFile(response: ServerResponse, name: string): Promise<void> {
  const file = /(^|\/)\./.test(name) ? undefined : await openOutput(name).catch(() => undefined);
  if (!file) return say(response, 404, 'there is no such file');
  response.writeHead(200, {
    'Content-Security-Policy': "sandbox; default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'",
    'Content-Length': (await file.stat()).size,
    'Content-Type': types[extname(name)] ?? 'application/octet-stream',
  });
  await pipeline(file.createReadStream(), response).catch(() => {}); // whoever asked has gone
}

/** Serves the status pages. @returns their address, and what ends it. @throws {Failure} if it cannot listen. */
export async function serveStatus(catalogue: Catalogue): Promise<{ address: string; close: () => Promise<void> }> {
  const metrics = await watch(catalogue.queue);
  const pages: Record<string, (response: ServerResponse) => Promise<void>> = {
    '/queue': async (response) => {
      response.setHeader('Content-Security-Policy', "default-src 'none'; style-src 'unsafe-inline'");
      send(response, types['.html']!, queuePage(await latest(catalogue)));
    },
    '/queue.json': async (response) => send(response, types['.json']!, JSON.stringify(await latest(catalogue))),
    '/metrics': async (response) => send(response, 'text/plain; version=0.0.4', await metrics.text()),
  };
  const answer = async (path: string, response: ServerResponse) => {
    if (path === '/') return void response.writeHead(302, { Location: '/queue' }).end();
    if (path.startsWith('/files/')) return sendFile(response, path.slice('/files/'.length));
    if (!Object.hasOwn(pages, path)) return say(response, 404, 'there is no such page');
    if (catalogue.redis.status !== 'ready')
      return say(response, 503, 'Redis does not answer: start it, or set REDIS_URL to where it is');
    return pages[path]!(response);
  };
  const server = createServer(async (request, response) => {
    response.setHeaders(
      new Map([
        ['X-Frame-Options', 'DENY'],
        ['X-Content-Type-Options', 'nosniff'],
        ['Referrer-Policy', 'no-referrer'],
        ['Cache-Control', 'no-store'],
      ]),
    );
    try {
      const refused = refusal(request);
      if (refused) say(response, ...refused);
      else await answer(decodeURIComponent(request.url!.replace(/\?.*$/s, '')), response);
    } catch (error) {
      if (response.headersSent) response.destroy();
      else say(response, error instanceof URIError ? 400 : 500, asFailure(error).message);
    }
  });
  await new Promise<void>((done, failed) => {
    server.once('error', (error) =>
      failed(
        new Failure(
          'refused',
          `${settings.address}:${settings.port}: ${meaningOf(error)}; set CATALOGUE_ADDRESS or CATALOGUE_PORT`,
        ),
      ),
    );
    server.listen(settings.port, settings.address, done);
  });
  const { port } = server.address() as AddressInfo;
  return {
    address: `http://${settings.address}:${port}`,
    close: async () => {
      server.close();
      server.closeAllConnections();
      await metrics.close();
    },
  };
}

if (import.meta.filename === process.argv[1]) {
  const catalogue = openCatalogue();
  const { address, close } = await serveStatus(catalogue);
  console.log(`queue    ${address}/queue\nmetrics  ${address}/metrics\nreport   ${address}/files/report.html`);
  for (const signal of ['SIGINT', 'SIGTERM'] as const)
    process.on(signal, async () => {
      await close();
      await catalogue.close();
    });
}
