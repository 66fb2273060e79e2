// Who may ask the status page what. A browser asks in the name of whoever sits before it, for any page that is open there.
import { createHash, timingSafeEqual } from 'node:crypto';
import { isIP } from 'node:net';
import express, { type Request, type RequestHandler, type Response, Router } from 'express';
import { withoutSecrets } from '../failure.ts';
import { settings } from '../settings.ts';

const hash = (text: string) => createHash('sha256').update(text).digest();
/** What the cookie has: not the token itself, which is never sent back. */
const cookieOf = (token: string) => hash(`catalogue ${token}`).toString('hex');
const isSame = (a: string, b: string) => timingSafeEqual(hash(a), hash(b));

const refuse = (response: Response, status: number, text: string) =>
  response
    .status(status)
    .type('text/plain')
    .send(`${withoutSecrets(text).slice(0, 500)}\n`);

/** Whether a Host header is ours. Any name can be made to lead here; an IP address cannot, nor can localhost. */
function isOwn(host: string): boolean {
  const name = /^[^\s/?#@]+$/.test(host) && URL.canParse(`http://${host}`) ? new URL(`http://${host}`).hostname : '';
  return isIP(name.replace(/^\[|\]$/g, '')) > 0 || name === 'localhost' || settings.names.includes(name);
}

/** Whether a page of another site asks: such may follow a link to here, and nothing else. */
function isForeign({ headers, method }: Request): boolean {
  const { origin, host } = headers;
  if (origin !== undefined) return !URL.canParse(origin) || new URL(origin).host !== host;
  const [site, mode] = [headers['sec-fetch-site'], headers['sec-fetch-mode']];
  if (site === undefined || site === 'same-origin' || site === 'none') return false;
  return method !== 'GET' || mode !== 'navigate';
}

function hasToken({ headers }: Request): boolean {
  const bearer = /^Bearer (.+)$/i.exec(headers.authorization ?? '')?.[1];
  if (bearer !== undefined) return isSame(bearer, settings.token);
  const cookie = /(?:^|; *)catalogue=([0-9a-f]+)/.exec(headers.cookie ?? '')?.[1];
  return cookie !== undefined && isSame(cookie, cookieOf(settings.token));
}

/** Comes before all pages: what is asked must come from this page itself, and what writes needs the token. */
const check: RequestHandler = (request, response, next) => {
  response.set({
    'X-Frame-Options': 'DENY',
    'X-Content-Type-Options': 'nosniff',
    'Referrer-Policy': 'no-referrer',
    'Cache-Control': 'no-store',
  });
  const { method, headers, path } = request;
  const isLogin = path === '/login';
  if (!isOwn(headers.host ?? ''))
    return void refuse(response, 421, `"${headers.host}" is no name of this page; if it is yours: CATALOGUE_NAMES`);
  if (isForeign(request)) return void refuse(response, 403, 'a page of another site must not ask this one');
  if (method === 'GET' || method === 'HEAD') return next();
  const hasBody = headers['transfer-encoding'] !== undefined || Number(headers['content-length'] ?? 0) > 0;
  const type = isLogin ? 'application/x-www-form-urlencoded' : 'application/json';
  if (hasBody && !request.is(type)) return void refuse(response, 415, `the content type must be ${type}`);
  if (settings.token === '')
    return void refuse(response, 403, 'this page only shows; with CATALOGUE_TOKEN, it can change the queue');
  if (isLogin || hasToken(request)) return next();
  refuse(response, 401, 'changing the queue needs the token: /login, or Authorization: Bearer');
};

const form = `<!doctype html>
<html lang="en">
<meta charset="utf-8">
<title>Catalogue</title>
<form method="post"><label>CATALOGUE_TOKEN <input name="token" type="password" autofocus required></label> <button>Log in</button></form>
</html>
`;

/** Checks who asks, and lets a browser log in with the token. */
export function guard(): Router {
  const router = Router();
  router.use(check);
  router.get('/login', (_, response) => void response.send(form));
  router.post('/login', express.urlencoded({ extended: false, limit: 10_000 }), (request, response) => {
    const { token } = (request.body ?? {}) as { token?: unknown };
    if (typeof token !== 'string' || !isSame(token, settings.token))
      return void refuse(response, 401, 'this is not CATALOGUE_TOKEN');
    response.cookie('catalogue', cookieOf(token), { httpOnly: true, sameSite: 'strict' });
    response.redirect(303, '/queue');
  });
  return router;
}
