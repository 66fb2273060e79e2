// The page of the tests with WebGPURenderer. Runs in the browser.
import { init } from 'cagecast';
import { figures, webgpuScenes } from './webgpu-scenes';

await init();
Object.assign(globalThis, {
  names: Object.keys(webgpuScenes),
  figures,
  /** Runs a scene. @returns its error, if it fails. */
  run: async (name: string): Promise<string | undefined> => {
    try {
      await webgpuScenes[name]!();
      return undefined;
    } catch (error) {
      return String((error as Error).stack ?? error);
    }
  },
});
