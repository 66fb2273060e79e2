// The page of the tests. Runs in the browser.
import { init } from 'cagecast';
import { channelScenes } from './channel-scenes';
import { layerScenes } from './layer-scenes';
import { materialScenes } from './material-scenes';
import { painterScenes } from './painter-scenes';
import type { Scenes } from './scenes';
import { sharingScenes } from './sharing-scenes';

await init();
const scenes: Scenes = { ...materialScenes, ...sharingScenes, ...layerScenes, ...channelScenes, ...painterScenes };
Object.assign(globalThis, {
  names: Object.keys(scenes),
  /** Runs a scene. @returns its error, if it fails. */
  run: async (name: string): Promise<string | undefined> => {
    try {
      await scenes[name]!();
      return undefined;
    } catch (error) {
      return String((error as Error).stack ?? error);
    }
  },
});
