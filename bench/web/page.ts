// What the page of the race offers to the benchmark that drives it.
import { readScene } from '../scene-file.js';
import { Runner } from './runner.js';

async function start(url: string): Promise<void> {
  Object.assign(window, { runner: await Runner.start(readScene(await (await fetch(url)).arrayBuffer())) });
}

Object.assign(window, { start });
