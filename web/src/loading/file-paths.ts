/** Where files of dropped folders are. */
export const paths = new WeakMap<File, string>();

/** The file that a model names, by slashes or backslashes. */
export function companionOf(named: string, companions: readonly File[], model: File): File | undefined {
  const uri = named.replaceAll('\\', '/');
  const name = uri.split('/').at(-1);
  const folder = paths.get(model);
  const path = folder && decodeURI(new URL(encodeURI(uri), `file:${encodeURI(folder)}`).pathname);
  return companions.find((file) => path && paths.get(file) === path) ?? companions.find((file) => file.name === name);
}
