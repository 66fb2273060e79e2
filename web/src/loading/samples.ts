import type { Sample } from '../state/sample';

const kFolder = new URL('samples/', document.baseURI);

/** The name of a sample's paint in links. @param file Its URL. */
export function paintName(file: string): string {
  return file.startsWith(kFolder.href) ? file.slice(kFolder.href.length) : file;
}

/**
 * Reads the list of samples.
 * @throws Error if it is missing.
 */
export async function loadSamples(): Promise<Sample[]> {
  const response = await fetch(new URL('index.json', kFolder)).catch(() => undefined);
  const list: Sample[] | undefined = response?.ok ? await response.json().catch(() => undefined) : undefined;
  if (!Array.isArray(list) || list.length === 0) {
    throw new Error('The samples could not be loaded. You can still drop a model of your own.');
  }
  const address = (path: string): string => new URL(path, kFolder).href;
  return list.map(({ target, cage, truth, paints, ...rest }) => ({
    ...rest,
    target: address(target),
    cage: address(cage),
    ...(truth && { truth: address(truth) }),
    paints: paints.map((paint) => ({ title: paint.title, file: address(paint.file) })),
  }));
}

const begun = new Map<string, Promise<Response | undefined>>();

/** Starts fetching the files of a sample before the page is ready for them. */
export function fetchAhead({ target, cage, paints }: Sample): void {
  for (const address of [target, cage, ...paints.slice(0, 1).map(({ file }) => file)]) begun.set(address, ask(address));
}

const ask = (address: string, options: RequestInit = {}): Promise<Response | undefined> =>
  fetch(address, options).catch(() => undefined);

/** The text of a sample's labels, if it has any and they come. */
export const fetchLabels = async ({ truth }: Sample): Promise<string | undefined> =>
  truth ? await (await fetchFile(truth).catch(() => undefined))?.text() : undefined;

const pictures = new Map<string, string>();

/** Where an image shows a file of a sample: that need not be fetched again if it has come. */
export const pictureOf = (address: string): string => pictures.get(address) ?? address;

/** What was asked for and has not come. */
const awaited = new Set<string>();

/** Fetches one file of a sample. @throws Error that names it. */
export async function fetchFile(address: string): Promise<File> {
  const name = new URL(address).pathname.split('/').slice(-2).join('/');
  const ahead = begun.get(address);
  begun.delete(address); // a response body can be read only once
  // Browsers let a second request wait for the first one's answer, unless it goes past their cache.
  const asked = ahead ?? ask(address, awaited.has(address) ? { cache: 'reload' } : {});
  awaited.add(address);
  const response = await asked;
  const body = response?.ok ? await response.blob().catch(() => undefined) : undefined;
  if (!body) throw new Error(`${name}: the file could not be loaded`);
  awaited.delete(address);
  if (body.type.startsWith('image/') && !pictures.has(address)) pictures.set(address, URL.createObjectURL(body));
  return new File([body], name.split('/').at(-1)!);
}
