// The page of the tests with WebGPURenderer. Runs in the browser.
import { init } from 'cagecast';
import { offer } from './scenes';
import { figures, webgpuScenes } from './webgpu-scenes';

await init();
offer(webgpuScenes);
Object.assign(globalThis, { figures });
