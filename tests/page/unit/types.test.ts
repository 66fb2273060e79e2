import { execFile } from 'node:child_process';
import { test } from 'node:test';
import { promisify } from 'node:util';
import { inRepository } from '../../support/site';

for (const project of ['web', 'web/service-worker', 'tests/page', 'tests/package/three']) {
  test(`${project}: type check`, async () => {
    await promisify(execFile)(inRepository('node_modules/.bin/tsc'), ['-p', inRepository(project)]).catch(
      ({ stdout }) => {
        throw new Error(stdout);
      },
    );
  });
}
