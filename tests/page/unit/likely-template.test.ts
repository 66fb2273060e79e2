import assert from 'node:assert/strict';
import { test } from 'node:test';
import { likelyTemplate } from '../../../web/src/state/cage-maker';

test('the template is chosen by the shape: a figure is flat, a car is low, a head is neither', () => {
  for (const [size, template] of [
    [[1.7, 1.75, 0.35], 'human-body'], // arms stretched out
    [[55, 178, 40], 'human-body'], // arms at the sides, in centimetres
    [[0.18, 0.3, 0.24], 'human-head'],
    [[2.7, 2, 1.7], 'human-head'],
    [[1.8, 1.4, 4.4], 'car'],
    [[4.4, 1.4, 1.8], 'car'],
    [[1, 1, 1], 'human-head'],
  ] as const)
    assert.equal(likelyTemplate(Float32Array.from([3, 3, 3, ...size.map((extent) => 3 + extent)])), template);
});
