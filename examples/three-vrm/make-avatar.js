// Makes models/avatar.vrm from the sample "human": the same model, and what VRM 1.0 asks for. An avatar of your own needs nothing of this.
import { cpSync, readFileSync, writeFileSync } from 'node:fs';

const models = new URL('models/', import.meta.url);
cpSync(new URL('../samples/human/', import.meta.url), models, { recursive: true });
const glb = readFileSync(new URL('target.glb', models));
const textLength = glb.readUInt32LE(12);
const json = JSON.parse(glb.subarray(20, 20 + textLength).toString());
const limbs = ['UpperLeg', 'LowerLeg', 'Foot', 'UpperArm', 'LowerArm', 'Hand'];
const bones = ['hips', 'spine', 'head', ...['left', 'right'].flatMap((side) => limbs.map((limb) => side + limb))];
const first = json.nodes.length;
// The model and all other bones are children of the hips, which turn it.
const others = bones.slice(1).map((name) => ({ name }));
json.nodes.push(
  { name: 'hips', children: [...others.map((_, i) => first + 1 + i), ...json.scenes[0].nodes] },
  ...others,
);
json.scenes[0].nodes = [first];
json.extensionsUsed = [...(json.extensionsUsed ?? []), 'VRMC_vrm'];
json.extensions = {
  ...json.extensions,
  VRMC_vrm: {
    specVersion: '1.0',
    meta: { name: 'Human', authors: ['Cagecast'], licenseUrl: 'https://vrm.dev/licenses/1.0/' },
    humanoid: { humanBones: Object.fromEntries(bones.map((name, i) => [name, { node: first + i }])) },
  },
};
const text = JSON.stringify(json);
const chunk = Buffer.from(text + ' '.repeat((4 - (Buffer.byteLength(text) % 4)) % 4));
const rest = glb.subarray(20 + textLength);
const head = Buffer.alloc(20);
head.write('glTF');
[2, 20 + chunk.length + rest.length, chunk.length].forEach((n, i) => head.writeUInt32LE(n, 4 + 4 * i));
head.write('JSON', 16);
writeFileSync(new URL('avatar.vrm', models), Buffer.concat([head, chunk, rest]));
