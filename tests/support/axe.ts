import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import type { AxeResults } from 'axe-core';
import type { Page } from 'playwright-core';
import { inRepository } from './site';

const kAxe = readFileSync(inRepository('node_modules/axe-core/axe.min.js'), 'utf8');

/** What axe-core finds wrong with the page as it is, in any of its rules; the place and the reason of each. @param least  Rules that it meets. */
export async function faults(page: Page, least = 20): Promise<string[]> {
  // The policy of the page forbids foreign scripts, but not the test's own evaluation.
  await page.evaluate(kAxe);
  const { violations, passed } = (await page.evaluate(`axe
    .run({ resultTypes: ['violations'] })
    .then(({ violations, passes }) => ({ violations, passed: passes.length }))`)) as Pick<AxeResults, 'violations'> & {
    passed: number;
  };
  assert.ok(passed > least, 'it has looked');
  return violations.flatMap(({ id, impact, nodes }) =>
    nodes.map(({ html, failureSummary }) => `${impact} ${id}: ${html.slice(0, 120)}: ${failureSummary}`),
  );
}
