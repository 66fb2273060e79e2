// npm run status: the queue as a page (bull-board), its metrics, and the report.
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname } from 'node:path';
import { pipeline } from 'node:stream/promises';
import { createBullBoard } from '@bull-board/api';
import { BullMQAdapter } from '@bull-board/api/bullMQAdapter';
import { ExpressAdapter } from '@bull-board/express';
import express, { type ErrorRequestHandler, type RequestHandler } from 'express';
import { asFailure, Failure, meaningOf, publicOf } from './failure.ts';
import { type Catalogue, openCatalogue } from './jobs.ts';
import { guard } from './pages/guard.ts';
import { watch } from './pages/metrics.ts';
import { settings } from './settings.ts';
import { openOutput } from './storage.ts';

/** The queue as a page. Without a token, it only shows. */
function boardOf({ queue }: Catalogue): RequestHandler {
  const board = new ExpressAdapter();
  board.setBasePath('/queue');
  const description = 'Failed jobs are the dead-letter list';
  const adapter = new BullMQAdapter(queue, { description, readOnlyMode: settings.token === '' });
  // A job's data as it may be seen, whatever it is: a signed URL lets whoever has it read or write.
  for (const field of ['data', 'returnValue', 'progress'] as const) adapter.setFormatter(field, publicOf);
  adapter.setFormatter('name', ({ name }) => publicOf(String(name)));
  createBullBoard({ queues: [adapter], serverAdapter: board });
  board.setErrorHandler((error) => ({ status: 500, body: { error: asFailure(error).message } }));
  return board.getRouter();
}

/** Sends a file of the output folder. What it has in it must not act in the name of this page. */
const sendFile: RequestHandler = async (request, response) => {
  const name = [request.params['name']].flat().join('/');
  const file = /(^|\/)\./.test(name) ? undefined : await openOutput(name).catch(() => undefined);
  if (!file) return void response.status(404).type('text/plain').send('there is no such file\n');
  response.set({
    'Content-Security-Policy': "sandbox; default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'",
    'Content-Length': String((await file.stat()).size),
  });
  response.type(extname(name) || 'application/octet-stream');
  await pipeline(file.createReadStream(), response).catch(() => {}); // whoever asked has gone
};

const plainError: ErrorRequestHandler = (error, _request, response, _next) => {
  const { status = 500 } = error as { status?: number };
  response
    .status(status)
    .type('text/plain')
    .send(`${asFailure(error).message}\n`);
};

/** Serves the status pages. @returns their address, and what ends it. @throws {Failure} if it cannot listen. */
export async function serveStatus(catalogue: Catalogue): Promise<{ address: string; close: () => Promise<void> }> {
  const metrics = await watch(catalogue.queue);
  const app = express();
  app.disable('x-powered-by');
  app.use(guard());
  app.get('/', (_, response) => response.redirect('/queue'));
  app.get('/files/*name', sendFile);
  app.use((_, response, next) => {
    if (catalogue.redis.status === 'ready') return next();
    response.status(503).type('text/plain').send('Redis does not answer: start it, or set REDIS_URL to where it is\n');
  });
  app.use('/queue', boardOf(catalogue));
  app.get('/metrics', async (_, response) => {
    response.type('text/plain; version=0.0.4').send(await metrics.text());
  });
  app.use(plainError);
  const server: Server = createServer(app);
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
