import assert from 'node:assert/strict';
import { test } from 'node:test';
import { History } from '#three';
import { ControlSteps } from '../../../web/src/state/control-steps';

test('what differs after a click is a step; equal changes in quick succession are one; those of another model are dropped', (t) => {
  let now = 0;
  t.mock.method(performance, 'now', () => now);
  const history = new History();
  const [rules, locks] = [{ threshold: 0.5 }, { chosen: 'auto' }];
  const state = <State extends object>(of: State, name: string) => ({
    get: () => ({ ...of }),
    set: (to: unknown) => void Object.assign(of, to),
    nameOf: () => name,
  });
  const steps = new ControlSteps(history, [state(rules, 'the threshold'), state(locks, 'a part')]);
  steps.record();
  assert.equal(history.last, undefined);
  for (const threshold of [0.6, 0.7, 0.8]) {
    now += 500;
    rules.threshold = threshold;
    steps.record();
  }
  now += 700; // two things that a hand does
  rules.threshold = 0.9;
  steps.record();
  locks.chosen = 'keep';
  steps.record();
  assert.equal(history.last!.name, 'a part');
  const undone = [];
  while (history.undo()) undone.push([rules.threshold, locks.chosen]);
  assert.deepEqual(undone, [
    [0.9, 'auto'],
    [0.8, 'auto'],
    [0.5, 'auto'],
  ]);
  steps.record();
  assert.ok(history.next, 'what undo did is no step');
  while (history.redo());
  assert.deepEqual([rules.threshold, locks.chosen], [0.9, 'keep']);
  history.add({ name: 'stroke', bytes: 0, undo() {}, redo() {} });
  rules.threshold = 0.1;
  steps.reset();
  assert.equal(history.last!.name, 'stroke');
  history.undo();
  assert.equal(history.last, undefined);
});
