/**
 * A module of Node; `undefined` in other hosts. Nothing is imported for it, so that the same files serve Node, browsers, bundlers and
 * import maps.
 */
export const nodeModule = <Name extends keyof Modules>(name: Name): Modules[Name] | undefined =>
  globalThis.process?.getBuiltinModule?.(name);

interface Modules {
  'node:fs': typeof import('node:fs');
  'node:fs/promises': typeof import('node:fs/promises');
  'node:worker_threads': typeof import('node:worker_threads');
}
