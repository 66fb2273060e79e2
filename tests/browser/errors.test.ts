import assert from 'node:assert/strict'
import { readFileSync } from 'node:fs'
import { after, before, test } from 'node:test'
import { glb, tetrahedron, writeGlb } from './glb'
import { drop, inRepository, settled, shownCounts, shownError, Site, type Upload, type Visit } from './site'

let site: Site
// One page for all of it: it must come through everything.
let visit: Visit
before(async () => {
  site = await Site.open()
  visit = await site.visit({ viewport: { width: 700, height: 500 } })
})
after(() => site?.close())

const sound = tetrahedron()
const lizard = readFileSync(inRepository('build/assets/lizard/target.glb'))
const positions = (at: number, value: number): Float32Array => Float32Array.from(sound.positions, (old, i) => (i === at ? value : old))
const { uvs: _, ...withoutUvs } = tetrahedron(2)

/** Everything that can be wrong with a file, where it is given, and what the page must say. */
const kBad: { what: string; input: 'target' | 'cage' | 'texture'; file: Upload; says: RegExp }[] = [
  { what: 'a position that is NaN', input: 'target', file: glb('nan.glb', writeGlb({ ...sound, positions: positions(7, NaN) })), says: /nan\.glb: .*positions\[7\] = NaN is not a finite number/ },
  { what: 'a position that is infinite', input: 'cage', file: glb('far.glb', writeGlb({ ...sound, positions: positions(4, Infinity) })), says: /far\.glb: .*positions\[4\] = Infinity is not a finite number/ },
  { what: 'an index out of range', input: 'target', file: glb('index.glb', writeGlb({ ...sound, indices: Uint16Array.of(0, 2, 1, 0, 1, 9) })), says: /index\.glb: .*indices\[5\] = 9 .*out of range \(4 vertices\)/ },
  { what: 'a cage without UVs', input: 'cage', file: glb('bare.glb', writeGlb(withoutUvs)), says: /bare\.glb: .*cage\.uvs is missing/ },
  { what: 'a mesh without triangles', input: 'target', file: glb('empty.glb', writeGlb({ ...sound, indices: new Uint16Array() })), says: /empty\.glb: .*no triangles/ },
  { what: 'a mesh without vertices', input: 'cage', file: glb('void.glb', writeGlb({ positions: new Float32Array(), indices: new Uint16Array(), uvs: new Float32Array() })), says: /void\.glb: .*no vertices/ },
  { what: 'a GLB cut short', input: 'target', file: glb('short.glb', lizard.subarray(0, lizard.length - 1000)), says: new RegExp(`short\\.glb: .*cut short.*${lizard.length - 1000} of its ${lizard.length} bytes`) },
  { what: 'a GLB cut within its header', input: 'cage', file: glb('stub.glb', lizard.subarray(0, 15)), says: /stub\.glb: .*ends after 15 bytes/ },
  { what: 'a file that is no GLB', input: 'target', file: glb('poem.glb', Buffer.from('Shall I compare thee to a summer’s day?')), says: /poem\.glb: .*not a GLB or glTF file/ },
  { what: 'JSON that is no glTF', input: 'cage', file: glb('package.gltf', Buffer.from('{"name":"thing"}')), says: /package\.gltf: .*not a glTF model/ },
  { what: 'an empty file', input: 'target', file: glb('nothing.glb', Buffer.alloc(0)), says: /nothing\.glb: .*empty/ },
  { what: 'a texture that is no image', input: 'texture', file: { name: 'text.png', mimeType: 'image/png', buffer: Buffer.from('no image') }, says: /text\.png: .*no image/ },
]

for (const { what, input, file, says } of kBad) {
  test(`${what} is told in plain words, and the page goes on with the next file`, async () => {
    const { page, complaints } = visit
    const before = await shownCounts(page)
    await page.getByTestId(`${input}-input`).setInputFiles(file)
    assert.equal(await settled(page), 'error')
    assert.match(await shownError(page), says)
    assert.deepEqual(await shownCounts(page), before, 'what was shown stays')

    await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', writeGlb(tetrahedron(2))))
    await page.getByTestId('target-input').setInputFiles(glb('thing.glb', writeGlb(sound)))
    assert.equal(await settled(page), 'ready', await shownError(page))
    assert.equal(await shownError(page), '')
    assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 })

    await page.getByTestId('sample-select').selectOption({ index: 0 })
    assert.equal(await settled(page), 'ready', await shownError(page))
    assert.deepEqual(await shownCounts(page), before)
    assert.deepEqual(complaints, [])
  })
}

test('a dropped file that is nothing the page knows is told apart by name', async () => {
  const { page } = visit
  await drop(page, [{ name: 'notes.txt', mimeType: 'text/plain', buffer: Buffer.from('hello') }])
  assert.equal(await settled(page), 'error')
  assert.match(await shownError(page), /notes\.txt: .*not a GLB or glTF file/)
  await page.locator('#alert-close').click()
  assert.equal(await shownError(page), '')
})

test('a page without its samples says so and takes files all the same', async () => {
  const { page } = await site.visit({ viewport: { width: 700, height: 500 } }, `const fetched = fetch
    globalThis.fetch = (input, options) => String(input).endsWith('index.json') ? Promise.resolve(new Response('', { status: 404 })) : fetched(input, options)`)
  assert.equal(await page.getByTestId('status').textContent(), 'error')
  assert.match(await shownError(page), /samples are missing/)
  await page.getByTestId('target-input').setInputFiles(glb('thing.glb', writeGlb(sound)))
  await page.getByTestId('cage-input').setInputFiles(glb('cage.glb', writeGlb(tetrahedron(2))))
  assert.equal(await settled(page), 'ready', await shownError(page))
  assert.deepEqual(await shownCounts(page), { cosmetic: 4, occluded: 0, uncovered: 0, culled: 0 })
})
