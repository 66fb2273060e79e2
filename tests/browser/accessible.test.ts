import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { after, before, test } from 'node:test'
import type { AxeResults } from 'axe-core'
import type { Page } from 'playwright-core'
import { glb } from './glb'
import { inRepository, settled, Site } from './site'

const kAxe = readFileSync(inRepository('node_modules/axe-core/axe.min.js'), 'utf8')

let site: Site
before(async () => void (site = await Site.open()))
after(() => site?.close())

/** What axe-core finds wrong with the page as it is, in any of its rules; the place and the reason of each. */
async function faults(page: Page): Promise<string[]> {
  // The policy of the page forbids foreign scripts, but not the test's own evaluation.
  await page.evaluate(kAxe)
  const { violations, passes } = await page.evaluate('axe.run()') as AxeResults
  assert.ok(passes.length > 20, 'it has looked')
  return violations.flatMap(({ id, impact, nodes }) => nodes.map(({ html, failureSummary }) => `${impact} ${id}: ${html.slice(0, 120)}: ${failureSummary}`))
}

const kVisits = [
  { name: 'desk, light', viewport: { width: 1440, height: 900 } },
  { name: 'desk, dark', viewport: { width: 1440, height: 900 }, colorScheme: 'dark' },
  { name: 'phone', viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
] as const

for (const { name, ...options } of kVisits) {
  test(`${name}: axe finds nothing wrong with the page in any of its states`, async () => {
    const { page } = await site.visit(options)
    assert.deepEqual(await faults(page), [], 'as it opens')

    await page.locator('details').evaluateAll((all) => all.forEach((details) => details.setAttribute('open', '')))
    await page.locator('#view-mode input[value=distance]').check({ force: true })
    await page.getByRole('button', { name: 'Ask the middle' }).click()
    await page.waitForFunction(() => document.querySelector('#fit-verdict')!.textContent !== '')
    assert.deepEqual(await faults(page), [], 'with all cards open, a legend, a story, and a verdict on the cage')

    await page.locator('#view-mode input[value=zones]').check({ force: true })
    await page.getByTestId('target-input').setInputFiles(glb('poem.glb', Buffer.from('no model')))
    assert.equal(await settled(page), 'error')
    assert.deepEqual(await faults(page), [], 'with an error')
  })
}

test('nor with any of the tools chosen', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 480 } })
  for (const tool of await page.locator('#tools input').all()) {
    await tool.check({ force: true })
    assert.deepEqual(await faults(page), [], `with the tool ${await tool.getAttribute('data-key')}`)
  }
})
