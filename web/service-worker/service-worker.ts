// Keeps the page for visits without a network. Built into service-worker.js, which lists the files it was built with.

/** Addresses of all files of the page, relative to it; the page itself is the first. */
declare const FILES: string[];
/** Differs wherever a file differs. */
declare const VERSION: string;

// Of this page alone: another copy of it may lie in another folder of the same host.
const kPrefix = `cagecast-${new URL('./', self.location.href).pathname}-`;
const kCache = kPrefix + VERSION;

const worker = self as unknown as ServiceWorkerGlobalScope; // what the library of types takes any worker for

worker.addEventListener('install', (event) => {
  // All or nothing: half a page would fail where nobody can help it.
  event.waitUntil(caches.open(kCache).then((cache) => Promise.all(FILES.map((file) => keep(cache, file)))));
});

async function keep(cache: Cache, file: string): Promise<void> {
  const response = await fetch(file, { cache: 'no-cache' });
  if (!response.ok) throw new TypeError(`${file}: ${response.status}`);
  // A server may send from index.html to its folder, but no visit may be answered by what was sent elsewhere.
  await cache.put(file, response.redirected ? new Response(response.body, response) : response);
}

worker.addEventListener('activate', (event) => event.waitUntil(takeOver()));

/** A new version waits until no page of the old one is open; only then the old one's files may go. */
async function takeOver(): Promise<void> {
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
  // Any query is the same page. And servers that vary by origin would hide a script from the tag that asks for it.
  return (await cache.match(wanted, { ignoreSearch: true, ignoreVary: true })) ?? fetch(request);
}

function isPage(url: string): boolean {
  const { pathname } = new URL(url);
  return (
    pathname === new URL('./', worker.location.href).pathname ||
    pathname === new URL(FILES[0]!, worker.location.href).pathname
  );
}
