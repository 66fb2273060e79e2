// Caches the page for offline visits. Built into service-worker.js, which lists the files of the build.

/** URLs of all files of the page, relative to it; the page itself comes first. */
declare const FILES: string[];
/** A hash of all files. */
declare const VERSION: string;

// Includes the path: the same host may serve other copies of the page.
const kPrefix = `cagecast-${new URL('./', self.location.href).pathname}-`;
const kCache = kPrefix + VERSION;

const worker = self as unknown as ServiceWorkerGlobalScope; // the library declares `self` for any kind of worker

worker.addEventListener('install', (event) => {
  // All or nothing: half of the files would be useless offline.
  event.waitUntil(caches.open(kCache).then((cache) => Promise.all(FILES.map((file) => keep(cache, file)))));
});

async function keep(cache: Cache, file: string): Promise<void> {
  const response = await fetch(file, { cache: 'no-cache' });
  if (!response.ok) throw new TypeError(`${file}: ${response.status}`);
  // Servers may redirect index.html to its folder, but redirected responses must not answer navigations.
  await cache.put(file, response.redirected ? new Response(response.body, response) : response);
}

worker.addEventListener('activate', (event) => event.waitUntil(activate()));

/** A new version activates once no page of the old one is open: delete the old files then. */
async function activate(): Promise<void> {
  const names = await caches.keys();
  await Promise.all(
    names.filter((name) => name.startsWith(kPrefix) && name !== kCache).map((name) => caches.delete(name)),
  );
  await worker.clients.claim();
}

worker.addEventListener('fetch', (event) => {
  const { request } = event;
  if (request.method === 'GET' && new URL(request.url).origin === worker.location.origin)
    event.respondWith(answer(request));
});

async function answer(request: Request): Promise<Response> {
  const cache = await caches.open(kCache);
  const wanted = request.mode === 'navigate' && isPage(request.url) ? FILES[0]! : request;
  // Queries do not change the page. Ignore Vary: scripts and their tags send different Origin headers.
  return (await cache.match(wanted, { ignoreSearch: true, ignoreVary: true })) ?? fetch(request);
}

function isPage(url: string): boolean {
  const { pathname } = new URL(url);
  return (
    pathname === new URL('./', worker.location.href).pathname ||
    pathname === new URL(FILES[0]!, worker.location.href).pathname
  );
}
