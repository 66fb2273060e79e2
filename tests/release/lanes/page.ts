// What a browser runs: computes the hashes and sends them to the server that the page came from.
import * as cagecast from 'cagecast';
import { hashesOf } from '../../support/golden.js';

const load = async (name: string) => (await fetch(name)).arrayBuffer();

async function answer(): Promise<string> {
  await cagecast.init();
  return hashesOf(cagecast, load);
}

answer()
  .catch(String)
  .then((body) => fetch('answer', { method: 'POST', body }));
