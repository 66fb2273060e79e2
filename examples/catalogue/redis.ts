import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { mkdirSync } from 'node:fs';
import { type AddressInfo, createServer } from 'node:net';
import { Redis } from 'ioredis';
import { Failure } from './failure.ts';

/** A Redis server of this machine, which keeps everything in a file. */
export interface OwnRedis {
  url: string;
  pid: number;
  stop(signal?: NodeJS.Signals): Promise<void>;
}

/** Starts Debian's redis-server. @param folder  Where it keeps its append-only file. */
export async function startRedis(folder: string, port?: number): Promise<OwnRedis> {
  const own = port ?? (await freePort());
  mkdirSync(folder, { recursive: true });
  const options = { port: own, bind: '127.0.0.1', dir: folder, appendonly: 'yes', appendfsync: 'everysec', save: '' };
  const args = Object.entries(options).flatMap(([name, value]) => [`--${name}`, String(value)]);
  const server = spawn('redis-server', args, { stdio: 'ignore' });
  const ended = once(server, 'exit');
  process.once('exit', () => server.kill()); // it would go on alone
  const redis = new Redis(own, '127.0.0.1', { maxRetriesPerRequest: null, retryStrategy: () => 50 });
  redis.on('error', () => {}); // until it listens
  const failed = () => {
    throw new Failure(
      'missing',
      `redis-server does not start in ${folder}: apt-get install redis-server, or set REDIS_URL`,
    );
  };
  await Promise.race([redis.ping(), ended.then(failed, failed)]);
  redis.disconnect();
  return {
    url: `redis://127.0.0.1:${own}`,
    pid: server.pid!,
    stop: async (signal = 'SIGTERM') => {
      server.kill(signal);
      await ended;
    },
  };
}

export async function freePort(): Promise<number> {
  const server = createServer().listen(0, '127.0.0.1');
  await once(server, 'listening');
  const { port } = server.address() as AddressInfo;
  server.close();
  return port;
}
