import assert from 'node:assert/strict'
import { readdirSync, readFileSync } from 'node:fs'
import path from 'node:path'
import { after, before, test } from 'node:test'
import { gzipSync } from 'node:zlib'
import { processorTime, Site } from './site'

let site: Site
before(async () => void (site = await Site.open()))
after(() => site?.close())

test('all scripts of the page, those that few visits need included, are no more than 400 KB gzipped', () => {
  const scripts = readdirSync(site.folder, { recursive: true, withFileTypes: true }).filter(({ name }) => name.endsWith('.js'))
  const sizes = scripts.map(({ parentPath, name }) => [name, gzipSync(readFileSync(path.join(parentPath, name)), { level: 9 }).length] as const)
  const total = sizes.reduce((sum, [, size]) => sum + size, 0)
  assert.ok(total > 100_000, 'they were found')
  assert.ok(total <= 400_000, `${total} bytes: ${sizes.map((size) => size.join(' ')).join(', ')}`)
})

test('the first picture takes little of the processor, and most of that is not the page’s own', async () => {
  // By processor time, as a busy machine stretches any other. A processor slowed to a quarter takes four times as long.
  const runs: { page: number; graphics: number }[] = []
  for (let run = 0; run < 3; run++) runs.push(await processorTime(site))
  const least = (of: 'page' | 'graphics'): number => Math.min(...runs.map((run) => run[of]))
  assert.ok(4 * least('page') < 1.6, `scripts, layout and style: ${least('page')} s`)
  // Everything is drawn by the processor here; filtering an environment map alone once took 4 s.
  assert.ok(least('graphics') < 3.5, `drawing: ${least('graphics')} s`)
})
