// Takes the README's pictures of the page: npm run pictures

import { mkdir } from 'node:fs/promises'
import type { Page } from 'playwright-core'
import { inRepository, settled, Site } from './site.js'

const kFolder = inRepository('docs/pictures')

/** The model alone, naive beside filtered. */
async function compare(site: Site): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 1480, height: 720 } })
  await hideControls(page)
  await rest(page)
  const box = (await page.locator('#stage').boundingBox())!
  const clip = { x: box.x + box.width / 2 - 270, y: box.y + box.height * 0.16, width: 540, height: box.height * 0.62 }
  await page.screenshot({ path: `${kFolder}/compare.jpg`, type: 'jpeg', quality: 88, clip })
}

/** The whole page on two screens. */
async function desktopAndPhone(site: Site): Promise<void> {
  const shots: string[] = []
  for (const [width, height, colorScheme] of [[1440, 900, 'light'], [390, 900, 'dark']] as const) {
    const { page } = await site.visit({ viewport: { width, height }, colorScheme })
    if (width < 600) await choose(page, 'Human bust')
    await rest(page)
    shots.push(dataUri(await page.screenshot({ type: 'png' })))
  }
  await compose(site, 'page', `<div style="display:flex;gap:24px">${shots.map((shot) => `<img src="${shot}" style="height:640px;border-radius:10px">`).join('')}</div>`)
}

async function choose(page: Page, model: string): Promise<void> {
  await page.locator('#sample-select').selectOption({ label: model })
  await page.waitForTimeout(300)
  await settled(page)
}

async function hideControls(page: Page): Promise<void> {
  await page.addStyleTag({ content: '.panel, .toolbar, header { opacity: 0 }' })
}

/** Waits until the picture has been drawn with all its textures. */
const rest = (page: Page): Promise<void> => page.waitForTimeout(2500)

const dataUri = (png: Buffer): string => `data:image/png;base64,${png.toString('base64')}`

async function compose(site: Site, name: string, html: string): Promise<void> {
  const { page } = await site.visit({ viewport: { width: 1400, height: 700 } })
  await page.setContent(`<body style="margin:0;font:600 18px system-ui;color:#445"><div id="all" style="display:inline-block;padding:12px;background:#fff">${html}</div></body>`)
  await page.waitForTimeout(500)
  await page.locator('#all').screenshot({ path: `${kFolder}/${name}.jpg`, type: 'jpeg', quality: 85 })
}

const site = await Site.open()
try {
  await mkdir(kFolder, { recursive: true })
  await compare(site)
  await desktopAndPhone(site)
} finally {
  await site.close()
}
