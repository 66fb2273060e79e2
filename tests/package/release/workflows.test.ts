// GitHub's orders for a release: who may write where, the order of jobs, and the same tests as here.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { parse } from 'yaml';

interface Step {
  uses?: string;
  run?: string;
  with?: Record<string, unknown>;
}
interface Job {
  needs?: string | string[];
  if?: string;
  uses?: string;
  environment?: unknown;
  permissions?: Record<string, string>;
  strategy?: { matrix: Record<string, string[]> };
  env?: Record<string, string>;
  steps?: Step[];
}
interface Workflow {
  permissions?: Record<string, string>;
  concurrency: string | { group: string };
  jobs: Record<string, Job>;
}

const folder = '.github/workflows/';
const texts = Object.fromEntries(readdirSync(folder).map((name) => [name, readFileSync(folder + name, 'utf8')]));
const workflows = Object.fromEntries(Object.entries(texts).map(([name, text]) => [name, parse(text) as Workflow]));
const ci = workflows['ci.yml'] as Workflow;
const release = workflows['release.yml'] as Workflow;
const jobs = Object.entries(workflows).flatMap(([name, workflow]) =>
  Object.entries(workflow.jobs).map(([job, value]) => ({
    name: `${name}: ${job}`,
    job: value,
    permissions: value.permissions ?? workflow.permissions,
  })),
);
/** Jobs with a right to change something, by a token of GitHub's or one they can ask for. */
const trusted = jobs.filter(({ job, permissions }) => {
  const writes = permissions === undefined || Object.values(permissions).some((right) => right !== 'read');
  return writes || /secrets\.|github\.token/.test(JSON.stringify(job));
});
const needsOf = (job: Job | undefined): string[] => [job?.needs ?? []].flat();

test('no job has a secret, and only those that tag and publish may write', () => {
  for (const [name, text] of Object.entries(texts))
    assert.doesNotMatch(text, /secrets|NPM_TOKEN|NODE_AUTH_TOKEN/, `${name} uses a secret`);
  for (const { name, permissions } of jobs) assert.ok(permissions, `${name} has the rights that the repository gives`);
  assert.deepEqual(Object.fromEntries(trusted.map(({ name, permissions }) => [name, permissions])), {
    'release.yml: tag': { contents: 'write' },
    'release.yml: publish': { 'id-token': 'write' },
    'release.yml: site': { pages: 'write', 'id-token': 'write' },
  });
});

test('a job that may write runs on main, behind an environment, and nothing that packages bring along', () => {
  const programs = /^(echo|sha256sum|gh|git (tag|push)|npm publish .* --ignore-scripts$)/;
  const actions = /^actions\/(checkout|download-artifact|setup-node|deploy-pages)@/;
  for (const { name, job } of trusted) {
    assert.match(job.if ?? '', /(^|&& )github\.ref == 'refs\/heads\/main'$/, name);
    assert.ok(job.environment, `${name} has no environment`);
    for (const { uses, run } of job.steps ?? []) {
      if (uses !== undefined) assert.match(uses, actions, name);
      for (const command of run?.split(/&&|\|\||\||;|\n/) ?? [])
        assert.match(command.trim(), programs, `${name} runs "${command}"`);
    }
  }
});

test('jobs that may not write leave no token in their checkout', () => {
  for (const { name, job } of jobs.filter((one) => !trusted.includes(one)))
    for (const step of job.steps ?? [])
      if (step.uses?.startsWith('actions/checkout@')) assert.equal(step.with?.['persist-credentials'], false, name);
});

test('a release is tested, built, tagged, then published, all from one commit', () => {
  const { tests, build, tag, publish, site } = release.jobs;
  assert.equal(tests?.uses, './.github/workflows/ci.yml');
  assert.deepEqual([build, tag, publish, site].map(needsOf), [['tests'], ['build'], ['build', 'tag'], ['publish']]);
  const made = build?.steps?.find(({ run }) => run?.startsWith('npm run release'));
  assert.match(made?.run ?? '', /--tested \$\{\{ github\.sha \}\}/);
  for (const { uses, with: inputs } of build?.steps ?? [])
    if (uses?.startsWith('actions/checkout@')) assert.equal(inputs?.['ref'], undefined, 'another commit is built');
});

test('what is tagged and published is the file that was built, by its hash', () => {
  const { tag, publish } = release.jobs;
  for (const job of [tag, publish]) {
    const steps = job?.steps ?? [];
    assert.match(job?.env?.['SUMS'] ?? '', /^\$\{\{ needs\.build\.outputs\.sums \}\}$/);
    const checked = steps.findIndex(
      ({ run }) => run === 'echo "$SUMS  SHA256SUMS" | sha256sum --check && sha256sum --check SHA256SUMS',
    );
    const taken = steps.findIndex(({ uses }) => uses?.startsWith('actions/download-artifact@'));
    const used = steps.findIndex(({ run }) => /^(git tag|npm publish)/.test(run ?? ''));
    assert.ok(0 <= taken && taken < checked && checked < used, JSON.stringify(steps));
  }
});

test('a push to main ends the tests of an earlier push, never those of a release', () => {
  const groupOf = ({ concurrency }: Workflow, workflow: string): string =>
    (typeof concurrency === 'string' ? concurrency : concurrency.group)
      .replace(/\$\{\{ github\.workflow \}\}/, workflow)
      .replace(/\$\{\{ github\.ref \}\}/, 'refs/heads/main');
  // A workflow that another calls sees the name of that one.
  const groups = [groupOf(ci, 'CI'), groupOf(ci, 'Release'), groupOf(release, 'Release')];
  assert.equal(new Set(groups).size, 3, groups.join(', '));
  for (const group of groups) assert.doesNotMatch(group, /\$\{\{/);
});

test('CI runs each suite once', () => {
  // The list of suites, as the program tells it to who asks for one that is not there.
  const { stderr } = spawnSync(process.execPath, ['tests/run.mjs', '?'], { encoding: 'utf8' });
  const suites = /there are: (.*)/.exec(stderr)?.[1]?.split(', ');
  const { linux } = ci.jobs;
  const inMatrix = linux?.strategy?.matrix['suites']?.flatMap((row) => row.split(' '));
  assert.deepEqual(inMatrix?.sort(), suites?.sort());
  assert.ok(suites && suites.length > 10, stderr);
  assert.match(linux?.steps?.at(-1)?.run ?? '', /node tests\/run\.mjs \$\{\{ matrix\.suites \}\}$/);
});
