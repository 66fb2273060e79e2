// npm run status: the queue as a page (bull-board), its metrics, and the report.
import { createServer, type Server } from 'node:http';
import type { AddressInfo } from 'node:net';
import { createBullBoard } from '@bull-board/api';
import { BullMQAdapter } from '@bull-board/api/bullMQAdapter';
import { ExpressAdapter } from '@bull-board/express';
import express from 'express';
import { type Catalogue, type JobData, openCatalogue } from './jobs.ts';
import { watch } from './metrics.ts';
import { settings } from './settings.ts';
import { shown } from './storage.ts';

/** Serves the status pages. @returns their address, and what ends it. */
export async function serveStatus({ queue }: Catalogue): Promise<{ address: string; close: () => Promise<void> }> {
  const board = new ExpressAdapter();
  board.setBasePath('/queue');
  const adapter = new BullMQAdapter(queue, { description: 'Failed jobs are the dead-letter list' });
  adapter.setFormatter('data', withoutSignatures);
  createBullBoard({ queues: [adapter], serverAdapter: board });
  const metrics = await watch(queue);
  const app = express();
  app.disable('x-powered-by');
  app.get('/', (_, response) => response.redirect('/queue'));
  app.use('/queue', board.getRouter());
  app.get('/metrics', async (_, response) => {
    response.type('text/plain; version=0.0.4').send(await metrics.text());
  });
  app.use('/files', express.static(settings.outputs, { index: false }));
  const server: Server = createServer(app);
  await new Promise<void>((done, failed) => server.once('error', failed).listen(settings.port, settings.address, done));
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

/** A job's data as it may be seen: a signed URL lets whoever has it read or write. */
function withoutSignatures({ inputs, output, ...rest }: JobData): object {
  const places = Object.entries(inputs).map(([name, one]) => [name, { ...one, place: shown(one.place) }]);
  return { ...rest, inputs: Object.fromEntries(places), ...(output && { output: shown(output) }) };
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
