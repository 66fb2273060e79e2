// Runs a command in this process and prints as JSON where its processor time went, in milliseconds from the start of the process on,
// and the most memory that it had, in bytes.
//
//   node bench/waits/run.mjs COMMAND ARGUMENTS …     by the steps that the command shows as its progress
//   node bench/waits/run.mjs rewrite FILE OUTPUT     for comparison: glTF-Transform reads a file and writes it

import { readFileSync } from 'node:fs';

const [door, ...args] = process.argv.slice(2);
const steps = {};
let [step, before] = ['start', 0];

/** Books what was spent since the last step began. */
function begin(next) {
  if (next === step) return;
  const { user, system } = process.cpuUsage();
  const now = (user + system) / 1000;
  steps[step] = (steps[step] ?? 0) + now - before;
  [step, before] = [next, now];
}

/** "reading FILE …" is `reading`, "making a cage: hull [##--] 50 % …" is `hull`. */
const nameOf = (text) => /^[\w ]+: ([a-z ]+?) \[/.exec(text)?.[1] ?? /^\w+/.exec(text)?.[0];

if (door === 'rewrite') {
  const { NodeIO } = await import('@gltf-transform/core');
  const { ALL_EXTENSIONS } = await import('@gltf-transform/extensions');
  const { MeshoptDecoder, MeshoptEncoder } = await import('meshoptimizer');
  await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready]);
  const io = new NodeIO()
    .registerExtensions(ALL_EXTENSIONS)
    .registerDependencies({ 'meshopt.decoder': MeshoptDecoder, 'meshopt.encoder': MeshoptEncoder });
  begin('reading');
  const document = await io.read(args[0]);
  begin('writing');
  await io.write(args[1], document);
} else {
  const { runCommand } = await import('../../dist/command.js');
  let said = '';
  const exit = await runCommand([door, ...args], {
    columns: 200,
    stdout: () => {},
    stderr: (text) => {
      const name = nameOf(text);
      if (name !== undefined && name !== 'cagecast') begin(name);
      said = text;
    },
  });
  if (exit !== 0 && exit !== 3) throw new Error(said.trim());
}
begin('end');
// On Linux not by resourceUsage(): the memory of the program that started this one counts there, too.
const status = process.platform === 'linux' ? readFileSync('/proc/self/status', 'utf8') : '';
const [, kilobytes = process.resourceUsage().maxRSS] = /VmHWM:\s+(\d+)/.exec(status) ?? [];
console.log(JSON.stringify({ steps, memory: 1024 * kilobytes }));
