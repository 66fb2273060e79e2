// What the page of the race offers to the benchmark that drives it.
import { readScene } from '../scene-file.js';
import { race, type Race, type RaceOptions } from './race.js';

async function raceOn(url: string, options: RaceOptions): Promise<Race> {
  return race(readScene(await (await fetch(url)).arrayBuffer()), options);
}

Object.assign(window, { raceOn });
