import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { disaster } from '../../../examples/catalogue/bench/disaster.ts';
import * as recipe from './recipe.ts';

before(() => recipe.open(0));
after(() => recipe.close());

// `npm run bench` in examples/catalogue does the same with 2,000 jobs.
test('after a night in which all goes wrong, what is told is what is there', async () => {
  const jobs = 200;
  const stage = { folder: recipe.folder, inputs: recipe.inputs, outputs: recipe.outputs, redis: recipe.redis };
  const figures = await disaster(stage, { jobs, fullMs: 3000, frozenMs: 4000 });
  await stage.redis.stop('SIGKILL');
  const { seconds, jobMs, ...told } = figures;
  assert.ok(Number(seconds) > 7 && Number(jobMs) > 0);
  assert.deepEqual(told, {
    firstDone: jobs,
    firstFailed: 40,
    secondDone: jobs,
    secondFailed: 40,
    doneAgain: jobs / 10,
    metricsDone: jobs,
    metricsFailed: 50,
    reportDone: jobs,
    reportFailed: 50,
    results: jobs + 50,
    keys: jobs + 50,
    files: jobs,
    filesAsTold: jobs,
    unfinished: told['unfinished'], // what a process that was killed left; it is removed after an hour
    reasons: told['reasons'],
    escaped: 0,
    foreignPost: 403,
    waitedForRedis: 3, // all workers
  });
  assert.deepEqual(JSON.parse(String(told['reasons'])), { broken: 30, missing: 10, refused: 10 });
});
