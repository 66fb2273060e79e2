// Who may ask the status page. A browser asks in the name of whoever sits before it, for any page that is open there.
import type { IncomingMessage } from 'node:http';
import { isIP } from 'node:net';
import { settings } from '../settings.ts';

/** Whether a Host header is ours. Any name can be made to lead here; an IP address cannot, nor can localhost. */
function isOwn(host: string): boolean {
  const name = /^[^\s/?#@]+$/.test(host) && URL.canParse(`http://${host}`) ? new URL(`http://${host}`).hostname : '';
  return isIP(name.replace(/^\[|\]$/g, '')) > 0 || name === 'localhost' || settings.names.includes(name);
}

/** Whether a page of another site asks: such may follow a link to here, and nothing else. */
function isForeign({ headers, method }: IncomingMessage): boolean {
  const { origin, host } = headers;
  if (origin !== undefined) return !URL.canParse(origin) || new URL(origin).host !== host;
  const [site, mode] = [headers['sec-fetch-site'], headers['sec-fetch-mode']];
  if (site === undefined || site === 'same-origin' || site === 'none') return false;
  return method !== 'GET' || mode !== 'navigate';
}

/** The refusal of a request, as a status and a sentence; undefined if it is answered: pages show, and only to themselves. */
export function refusal(request: IncomingMessage): [status: number, text: string] | undefined {
  const { method, headers } = request;
  if (!isOwn(headers.host ?? ''))
    return [421, `"${headers.host}" is no name of this page; if it is yours: CATALOGUE_NAMES`];
  if (isForeign(request)) return [403, 'a page of another site must not ask this one'];
  if (method !== 'GET' && method !== 'HEAD') return [405, 'this page only shows'];
  return undefined;
}
