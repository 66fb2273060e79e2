import assert from 'node:assert/strict'
import { after, before, test } from 'node:test'
import type { CDPSession, Page } from 'playwright-core'
import { look, modelArea } from './picture'
import { compute, kComputation, Site } from './site'

let site: Site
before(async () => void (site = await Site.open()))
after(() => site?.close())

const kMoves = 30
const kMostMs = 16

/** Milliseconds of processor time that something takes: of the page's thread, and of the process that draws. */
async function processorTime(page: Page, session: CDPSession, run: () => Promise<unknown>): Promise<{ page: number; graphics: number }> {
  const system = await site.browser.newBrowserCDPSession()
  const now = async (): Promise<{ page: number; graphics: number }> => {
    // Reading a pixel waits until everything before it is drawn.
    await page.evaluate(() => {
      const gl = document.querySelector('canvas')!.getContext('webgl2')!
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4))
    })
    const { processInfo } = await system.send('SystemInfo.getProcessInfo')
    const { metrics } = await session.send('Performance.getMetrics')
    const seconds = { page: metrics.find(({ name }) => name === 'ThreadTime')!.value, graphics: processInfo.find(({ type }) => type === 'GPU')!.cpuTime }
    return { page: 1000 * seconds.page, graphics: 1000 * seconds.graphics }
  }
  const before = await now()
  await run()
  const after = await now()
  return { page: after.page - before.page, graphics: after.graphics - before.graphics }
}

// The largest, of 40 % of the cage, takes 9 to 22 ms: what else the machine does decides on which side of the limit.
const kBrushes = { 'as it comes': '50', 'of 20 % of the cage': '85' }

test('from a pointer’s move to painted texels takes less than 16 ms of processor time, with every brush up to 20 % of the cage, drawing by the processor included', async () => {
  const { page } = await site.visit({ viewport: { width: 400, height: 400 } })
  const session = await page.context().newCDPSession(page)
  await session.send('Performance.enable', { timeDomain: 'threadTicks' })
  await page.locator('#view-mode input[value=result]').check({ force: true })
  await page.getByRole('radio', { name: 'Brush' }).check({ force: true })
  // A tiny picture: it is drawn anew for each move, and is not what this is about.
  await page.addStyleTag({ content: '.stage { width: 180px; height: 200px !important } .stage > :not(canvas) { display: none !important }' })
  await look(page, await modelArea(page))
  const box = (await page.locator('#view').boundingBox())!
  const [x, y] = [box.x + 0.5 * box.width, box.y + 0.24 * box.height]
  /** Moves the mouse, or turns the model, once a frame. */
  const frames = (paints: boolean): Promise<void> =>
    page.evaluate(
      async ({ moves, x, y, paints }) => {
        const canvas = document.querySelector('canvas')!
        for (let i = 0; i < moves; i++) {
          const [clientX, clientY] = [x + 12 * Math.sin(i / 5), y + 5 * Math.sin(i / 3)]
          canvas.dispatchEvent(
            paints
              ? new PointerEvent('pointermove', { pointerId: 1, pointerType: 'mouse', buttons: 1, clientX, clientY, bubbles: true })
              : new KeyboardEvent('keydown', { key: i % 2 === 0 ? 'ArrowRight' : 'ArrowLeft', bubbles: true }),
          )
          await new Promise(requestAnimationFrame)
        }
      },
      { moves: kMoves, x, y, paints },
    )
  const stroke = async (): Promise<{ page: number; graphics: number }> => {
    await page.mouse.move(x, y)
    await page.mouse.down()
    const cost = await processorTime(page, session, () => frames(true))
    await page.mouse.up()
    assert.equal(await page.getByTestId('undo').getAttribute('title'), 'Undo: stroke', 'it was painted')
    await page.keyboard.press('Control+z')
    await page.waitForTimeout(400) // the layer's small picture is made once the hand rests
    return cost
  }
  await stroke() // what is done but once
  for (const [brush, slider] of Object.entries(kBrushes)) {
    await page.getByTestId('brush-size').fill(slider)
    await page.evaluate(() => scrollTo(0, 0)) // to where the picture was
    // The least of each, as others on the same processor only add to it.
    const least = { painting: Infinity, turning: Infinity, computation: Infinity }
    const note = (what: keyof typeof least, { page, graphics }: { page: number; graphics: number }): void => void (least[what] = Math.min(least[what], page + graphics))
    let cost = Infinity
    for (let run = 0; run < 6 && (run < 3 || cost >= kMostMs); run++) {
      // A stroke of its own each time: what it has painted in full it does not paint again.
      note('painting', await stroke())
      note('turning', await processorTime(page, session, () => frames(false)))
      note('computation', await processorTime(page, session, () => compute(page)))
      cost = (least.painting - least.turning) / kMoves / Math.max(1, least.computation / kComputation)
    }
    assert.ok(cost > 0.2, 'painting was measured')
    assert.ok(cost < kMostMs, `the brush ${brush}: ${cost.toFixed(1)} ms, of ${JSON.stringify(least)}`)
  }
})
