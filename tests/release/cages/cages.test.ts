// Templates that come with the package, and cages for the models of the samples: what takes long.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { classify, init, project } from 'cagecast';
import { type CageModel, findLandmarks, fitCage, loadTemplate, templateNames } from 'cagecast/cages';
import { cageModel } from 'cagecast/gltf';
import { readPlain } from '../../package/scenes.js';

before(init);

/** The visibility of what lies beyond an outer border of the cage. */
const kBeyond = 3;

describe('a template', () => {
  for (const name of templateNames) {
    test(`${name}: UVs, landmarks and names are their own mirror image`, async () => {
      const { positions, uvs, landmarks } = await loadTemplate(name);
      for (const [spot, [x, y, z]] of Object.entries(landmarks)) {
        const [other, sign] = spot.endsWith('_left') ? [spot.replace(/left$/, 'right'), -1] : [spot, 1];
        assert.deepEqual(landmarks[other], [x === 0 ? 0 : sign * x, y, z], spot);
        assert.ok(/_(left|right)$/.test(spot) || x === 0, `${spot} is off the plane of symmetry`);
      }
      const keyOf = (v: number, sign: number) =>
        [0, 1, 2].map((k) => Math.round(1e5 * (k === 0 ? sign : 1) * positions[3 * v + k]!) + 0).join(' ');
      const places = new Map<string, number[]>();
      for (let v = 0; 3 * v < positions.length; v++) places.set(keyOf(v, 1), [...(places.get(keyOf(v, 1)) ?? []), v]);
      for (let v = 0; 3 * v < positions.length; v++) {
        const [u, w] = [uvs[2 * v]!, uvs[2 * v + 1]!];
        const isTwin = (o: number) => Math.abs(uvs[2 * o]! + u - 1) < 1e-5 && Math.abs(uvs[2 * o + 1]! - w) < 1e-5;
        assert.ok(places.get(keyOf(v, -1))?.some(isTwin), `vertex ${v}`);
      }
    });

    test(`${name}: it fits the model that it was made for`, async () => {
      const folder = `examples/samples/${/human-head|face-mask/.test(name) ? 'human' : name}`;
      const projection = project(await loadTemplate(name), await readPlain(`${folder}/target.glb`));
      const [{ zones }, { visibility }] = [classify(projection), projection];
      const truth = JSON.parse(readFileSync(`${folder}/truth.json`, 'utf8'));
      const isLabelled = (label: string, v: number): boolean => truth[label][v] === '1';
      const scored = Array.from(zones, (_, v) => v).filter((v) => !isLabelled('ignore', v));
      const forbidden = scored.filter((v) => isLabelled('ncz', v));
      const skin = scored.filter(
        (v) => !isLabelled('ncz', v) && !isLabelled('offTemplate', v) && visibility[v] !== kBeyond,
      );
      assert.ok(forbidden.every((v) => zones[v] !== 0));
      const kept = skin.filter((v) => zones[v] === 0).length / skin.length;
      // The outline of a mask crosses triangles.
      assert.ok(kept >= (name === 'face-mask' ? 0.995 : 0.997), `kept ${kept}`);
    });
  }
});

describe('a head', () => {
  let model: CageModel;
  before(async () => {
    model = await cageModel(await new NodeIO().read('examples/samples/human/target.glb'));
  });

  test('has no landmarks that are not finite, however it is turned', async () => {
    const turns = [-1, 1].flatMap((y) => [-1, 1].flatMap((z) => [true, false].map((swaps) => ({ y, z, swaps }))));
    for (const { y, z, swaps } of turns) {
      const positions = model.positions.map((x, i, all) => {
        if (i % 3 === 0) return x;
        return (i % 3 === 1 ? y : z) * (swaps ? all[i % 3 === 1 ? i + 1 : i - 1]! : x);
      });
      const { landmarks } = await findLandmarks({ ...model, positions });
      for (const [name, at] of Object.entries(landmarks)) assert.ok(at.every(Number.isFinite), name);
    }
  });

  test('that is taller than others has a crown that is less certain, and is asked for', async () => {
    const { landmarks, confidence } = await findLandmarks(model);
    const low = landmarks['glabella']![1];
    const stretched = (by: number) =>
      findLandmarks({
        ...model,
        positions: model.positions.map((x, i) => (i % 3 === 1 && x > low ? x + by * (x - low) : x)),
      });
    assert.ok(landmarks['crown']![1] > low && confidence['crown']! < confidence['nose_tip']!);
    assert.ok(((await stretched(0.3)).confidence['crown'] ?? 0) < confidence['crown']!);
    const hat = await stretched(0.8);
    for (const name of ['crown', 'forehead'])
      assert.deepEqual([name in hat.landmarks, hat.missing.includes(name)], [false, true], name);
  });

  test('beside another one is refused: no cage fits both', async () => {
    const count = model.positions.length / 3;
    const twice = {
      ...model,
      positions: Float32Array.from([...model.positions, ...model.positions.map((x, i) => (i % 3 === 0 ? x + 0.5 : x))]),
      indices: Uint32Array.from([...model.indices, ...model.indices.map((vertex) => vertex + count)]),
      groups: Uint32Array.from([...model.groups!, ...model.groups!]),
      vertexJoints: Uint16Array.from([...model.vertexJoints!, ...model.vertexJoints!]),
    };
    await assert.rejects(fitCage(await loadTemplate('human-head'), twice), {
      code: 'badModel',
      message:
        /^fitCage: model: the template does not fit it; if there are several figures in it, leave out all but one/,
    });
  });
});
