import { CagecastError, classify, init, splitVertices, type Lock, type Mesh, type Preset, type Projection, type SplitVertices } from 'cagecast'
import { setUpDivider } from './compare'
import { setUpFiles, type Intake } from './files'
import { loadModel, type Model } from './load'
import { clearError, element, showError, showNotice, showStatus } from './page'
import { loadPaint, makeChecker, type Paint } from './paint'
import { offerPaints, type Choice } from './paints'
import { PartsTable, type Locks } from './parts'
import { showCounts, showTimings } from './results'
import { fetchFile, loadSamples, type Sample } from './samples'
import { Superseded, TransferClient } from './transfer-client'
import { Viewer, type View } from './viewer'

/** What is wanted, or shown: a target, its cage, and what to paint it with. */
interface Scene {
  target: Model
  cage: Model
  paint: Paint
}

/** The same while it is still being read. */
type Wanted = { [Slot in keyof Scene]?: Promise<Scene[Slot]> }

const kOwn = 'own'
const kBlind =
  'This browser draws no 3D here: WebGL 2 is missing or switched off. The transfer works all the same, its numbers are in the panel.'

/** Wires the page: inputs on one side, one worker and one viewer on the other. */
class App {
  readonly #client = new TransferClient()
  readonly #viewer: Viewer | undefined
  readonly #checker = makeChecker()
  readonly #select = element('sample-select', HTMLSelectElement)
  readonly #preset = element('preset', HTMLSelectElement)
  readonly #threshold = element('threshold', HTMLInputElement)
  readonly #parts: PartsTable
  readonly #divider: { show(visible: boolean): void }
  #samples: Sample[] = []
  #view: View = { mode: 'compare', split: 0.5, paint: true, zones: false, cage: false }
  #wanted: Wanted = {}
  #shown: (Scene & { projection: Projection }) | undefined
  /** What was said about parts of the target that is shown. */
  #locks: Locks = {}
  /** Which sample something belongs to; the visitor's own things to none. */
  readonly #origin = new WeakMap<Model | Paint, Sample>()
  /** The last paint of the visitor's own, to choose from beside the sample's. */
  #ownPaint: Paint | undefined
  #runs = 0

  constructor() {
    this.#viewer = startViewer()
    this.#divider = setUpDivider((split) => this.#show({ split }))
    this.#setUpView()
    this.#parts = new PartsTable({
      onLock: (segments, lock) => this.#onLock(segments, lock),
      onPoint: (segments) => this.#highlight(segments),
    })
    setUpFiles((intake) => this.#take(intake))
    this.#select.addEventListener('change', () => this.#openSample(this.#select.value))
    this.#preset.addEventListener('change', () => this.#onPreset())
    this.#threshold.addEventListener('input', () => this.#onThreshold())
    element('swap', HTMLButtonElement).addEventListener('click', () => this.#swap())
  }

  /** Opens the first of the samples. */
  async start(samples: Promise<Sample[]>): Promise<void> {
    try {
      this.#samples = await samples
      this.#select.replaceChildren(...this.#samples.map(({ name, title }) => new Option(title, name)))
      // Files of one's own may have come in while the list was on its way.
      if (this.#runs === 0) this.#openSample(this.#samples[0]!.name)
    } catch (error) {
      this.#fail(error)
    }
  }

  #setUpView(): void {
    for (const input of document.querySelectorAll<HTMLInputElement>('#view-mode input')) {
      input.addEventListener('change', () => this.#show({ mode: input.value as View['mode'] }))
    }
    for (const layer of ['paint', 'zones', 'cage'] as const) {
      const input = element(`show-${layer}`, HTMLInputElement)
      input.addEventListener('change', () => this.#show({ [layer]: input.checked }))
      this.#view[layer] = input.checked // a reloaded page keeps its boxes as they were
    }
    const mode = document.querySelector<HTMLInputElement>('#view-mode input:checked')?.value as View['mode']
    const still = matchMedia('(prefers-reduced-motion: reduce)')
    this.#viewer?.turn(!still.matches)
    still.addEventListener('change', () => still.matches && this.#viewer?.turn(false))
    this.#show({ mode })
  }

  #show(change: Partial<View>): void {
    this.#view = { ...this.#view, ...change }
    this.#viewer?.setView(this.#view)
    this.#divider?.show(this.#viewer !== undefined && this.#view.mode === 'compare')
  }

  #openSample(name: string): void {
    const sample = this.#samples.find((candidate) => candidate.name === name)
    if (!sample) return
    this.#select.value = name
    const { target, cage, paints } = sample
    const model = (address: string): Promise<Model> => this.#fetch(sample, address, loadModel)
    this.#want({ target: model(target), cage: model(cage), paint: this.#fetchPaint(sample, paints[0]) })
  }

  /** Fetches and reads a file of a sample, and notes whose it is. */
  async #fetch<T extends Model | Paint>(sample: Sample, address: string, read: (file: File) => Promise<T>): Promise<T> {
    const thing = await read(await fetchFile(address))
    this.#origin.set(thing, sample)
    return thing
  }

  async #fetchPaint(sample: Sample, paint: Sample['paints'][number] | undefined): Promise<Paint> {
    return paint ? this.#fetch(sample, paint.file, (file) => loadPaint(file, paint.file)) : this.#checker
  }

  /** Takes in files of the visitor's own. */
  #take({ target, cage, texture, unclear, all }: Intake): void {
    const wanted: Wanted = {}
    if (target) wanted.target = loadModel(target, all)
    if (cage) wanted.cage = loadModel(cage, all)
    const [one, other] = unclear
    if (!target && one && other) {
      // Nothing in their names tells: the cage is the one with fewer triangles.
      const pair = Promise.all([loadModel(one, all), loadModel(other, all)]).then((models) =>
        models.sort((a, b) => b.mesh.indices.length - a.mesh.indices.length),
      )
      wanted.target = pair.then(([larger]) => larger!)
      wanted.cage = pair.then(([, smaller]) => smaller!)
    }

    if (texture) wanted.paint = loadPaint(texture)
    else if (!this.#wanted.paint) wanted.paint = Promise.resolve(this.#checker)
    this.#want(wanted)
  }

  #swap(): void {
    const { target, cage } = this.#wanted
    if (target && cage) this.#want({ target: cage, cage: target })
  }

  /** Asks for other input; whatever was under way and is replaced by it no longer counts. */
  #want(change: Wanted): void {
    for (const slot of Object.values(change)) slot.catch(() => {}) // told when it is waited for
    this.#wanted = { ...this.#wanted, ...change }
    void this.#run()
  }

  async #run(): Promise<void> {
    const run = ++this.#runs
    const superseded = (): boolean => run !== this.#runs
    clearError()
    showStatus('working')
    this.#client.cancel()
    try {
      const scene = await this.#read(superseded)
      if (superseded()) return
      if (!scene) return this.#askForRest()
      // A sample's paint means nothing on another cage: there the checker takes its place.
      const ofPaint = this.#origin.get(scene.paint)
      if (ofPaint && ofPaint !== this.#origin.get(scene.cage)) scene.paint = this.#checker
      const preset = this.#preset.value as Preset
      const same = scene.target === this.#shown?.target && scene.cage === this.#shown.cage && preset === this.#shown.projection.preset
      const projection = same ? this.#shown!.projection : await this.#project(scene, preset, superseded)
      if (superseded()) return
      // Segments are the target's alone: what was said about them holds for another cage and preset too.
      if (scene.target !== this.#shown?.target) this.#locks = {}
      this.#shown = { ...scene, projection }
      if (same) this.#viewer?.setPaint(scene.paint.texture)
      else this.#showProjection()
      this.#describe(scene)
      showStatus('ready')
    } catch (error) {
      if (superseded() || error instanceof Superseded) return
      this.#fail(error)
    }
  }

  /** Waits for the wanted files. One that cannot be read gives way to the one shown before it. */
  async #read(superseded: () => boolean): Promise<Scene | undefined> {
    const { target, cage, paint } = this.#wanted
    const results = await Promise.allSettled([target, cage, paint])
    const failed = results.find((result) => result.status === 'rejected')
    if (failed && !superseded()) {
      ;(['target', 'cage', 'paint'] as const).forEach((slot, index) => {
        if (results[index]!.status === 'rejected') this.#giveUp(slot)
      })
      throw failed.reason
    }
    const [t, c, p] = results.map((result) => (result.status === 'fulfilled' ? result.value : undefined)) as [Model?, Model?, Paint?]
    return t && c && p ? { target: t, cage: c, paint: p } : undefined
  }

  async #project({ target, cage }: Scene, preset: Preset, superseded: () => boolean): Promise<Projection> {
    try {
      // The threshold is decided here on the page, the rest in the worker: both start at once.
      const [projection] = await Promise.all([this.#client.project(cageArrays(cage), targetArrays(target), { preset }), init()])
      return projection
    } catch (error) {
      if (!(error instanceof CagecastError) || superseded()) throw error
      const blamed = /\b(cage|target)\b/.exec(error.message)?.[0] as 'cage' | 'target' | undefined
      // One that was accepted before stays: then it is the other that does not go with it, and a third file may come.
      const files = { target, cage }
      if (blamed && files[blamed] !== this.#shown?.[blamed]) this.#giveUp(blamed)
      const name = blamed ? files[blamed].name : `${target.name} with ${cage.name}`
      throw new Error(`${name}: ${error.message.replace(/^\w+: /, '')}`, { cause: error })
    }
  }

  #showProjection(): void {
    const { target, cage, paint, projection } = this.#shown!
    this.#viewer?.setTarget(target, projection.uvs, splitOf(target, projection), paint.texture)
    this.#viewer?.setCage(cage)
    this.#parts.list(projection.segmentStats, target.mesh.parts, this.#locks)
    const spent = this.#classify()
    const { timings, preset } = projection
    showTimings({ ...timings, classify: spent, total: timings.total + spent }, preset)
  }

  /** Decides by the threshold and the locks as they stand, and returns the milliseconds it took. */
  #classify(): number {
    const { projection } = this.#shown!
    const started = performance.now()
    const classification = classify(projection, { threshold: Number(this.#threshold.value), locks: { segments: this.#locks } })
    const spent = performance.now() - started
    this.#viewer?.classify(classification)
    this.#parts.showVerdicts(classification)
    showCounts(classification)
    return spent
  }

  /** Goes back to what is shown, where what was wanted proved unusable. */
  #giveUp(slot: keyof Scene): void {
    const { [slot]: _, ...rest } = this.#wanted
    this.#wanted = rest
    if (this.#shown) this.#wanted = { ...rest, [slot]: Promise.resolve(this.#shown[slot]) }
  }

  #onThreshold(): void {
    const threshold = Number(this.#threshold.value)
    element('threshold-value', HTMLOutputElement).value = threshold.toFixed(2)
    if (this.#shown) this.#classify()
  }

  #onPreset(): void {
    // Before the first sample is chosen there is nothing to do again; it will be read with the preset as it is.
    if (this.#runs > 0) void this.#run()
  }

  #onLock(segments: readonly number[], lock: Lock): void {
    for (const segment of segments) this.#locks[segment] = lock
    if (this.#shown) this.#classify()
  }

  /** Lights up segments of one part of the target, or none. */
  #highlight(segments: readonly number[]): void {
    const [first] = segments
    if (!this.#shown || first === undefined) return this.#viewer?.highlight(undefined)
    const { target, projection } = this.#shown
    const part = target.mesh.parts[projection.segmentStats[first]!.group]!
    const corners = target.mesh.indices.subarray(3 * part.firstTriangle, 3 * (part.firstTriangle + part.triangleCount))
    const chosen = new Set(segments)
    const lit = corners.filter((vertex) => chosen.has(projection.segments[vertex]!)) // the corners of a triangle are of one segment
    this.#viewer?.highlight(part, lit.map((vertex) => vertex - part.firstVertex))
  }

  #askForRest(): void {
    const missing = (['target', 'cage'] as const).filter((slot) => !this.#wanted[slot])
    showNotice('stage-notice', `Now add a ${missing.join(' and a ')}.`)
    showStatus('loading')
  }

  #describe({ target, cage, paint }: Scene): void {
    for (const [slot, { name }] of Object.entries({ target, cage, texture: paint })) {
      const label = element(`${slot}-name`, HTMLElement)
      label.textContent = label.title = name
    }
    const size = ({ mesh }: Model): string => `${(mesh.indices.length / 3).toLocaleString('en')} triangles`
    element('sizes', HTMLElement).textContent = `Target ${size(target)}, cage ${size(cage)}.`
    this.#describeOrigin(this.#origin.has(target), this.#origin.has(cage))
    this.#offerPaints(this.#origin.get(cage), paint)
    showNotice('stage-notice', this.#viewer ? '' : kBlind)
  }

  /** Tells what is still a sample's among files of one's own. */
  #describeOrigin(target: boolean, cage: boolean): void {
    const own = this.#select.querySelector<HTMLOptionElement>(`option[value=${kOwn}]`)
    if (target && cage) own?.remove()
    else {
      if (!own) this.#select.append(new Option('Your own files', kOwn))
      this.#select.value = kOwn
    }
    element('swap', HTMLButtonElement).hidden = target || cage
    element('hint', HTMLElement).textContent =
      target === cage
        ? 'Choose your own, or drop files anywhere on the page. They stay on this device.'
        : target
          ? 'The cage is yours, the target is still the sample’s: add the target this cage was made for.'
          : 'The target is yours, the cage is still the sample’s: add the cage made for it.'
  }

  /** Offers what there is to paint with: one's own, the sample's, and the checker. */
  #offerPaints(sample: Sample | undefined, shown: Paint): void {
    if (shown !== this.#checker && !this.#origin.has(shown)) this.#ownPaint = shown
    const own = this.#ownPaint
    const choices: (Choice & { load(): Promise<Paint> })[] = [
      ...(own ? [{ title: own.name, picture: own.picture, load: async () => own }] : []),
      ...(sample?.paints ?? []).map((paint) => ({ title: paint.title, picture: paint.file, load: () => this.#fetchPaint(sample!, paint) })),
      { title: this.#checker.name, picture: this.#checker.picture, load: async () => this.#checker },
    ]
    const chosen = choices.findIndex(({ picture }) => picture === shown.picture)
    offerPaints(choices, chosen, (index) => this.#want({ paint: choices[index]!.load() }))
  }

  #fail(error: unknown): void {
    showError(error instanceof Error ? error.message : String(error))
    showStatus('error')
    if (!this.#shown) showNotice('stage-notice', 'Nothing to show yet: drop a target and its cage here.')
  }
}

function cageArrays({ mesh: { positions, indices, uvs } }: Model): Mesh {
  return { positions, indices, uvs }
}

function targetArrays({ mesh: { positions, indices, groups } }: Model): Mesh {
  return { positions, indices, groups }
}

/** Splits a target's vertices at the seams of the paint; where the projection has no UVs per corner, nowhere. */
function splitOf({ mesh }: Model, { cornerUvs, uvs }: Projection): SplitVertices {
  if (cornerUvs.length > 0) return splitVertices(mesh, cornerUvs)
  const ofVertices = new Float32Array(2 * mesh.indices.length)
  mesh.indices.forEach((vertex, corner) => ofVertices.set(uvs.subarray(2 * vertex, 2 * vertex + 2), 2 * corner))
  return splitVertices(mesh, ofVertices)
}

/** Without WebGL the page still transfers; it then says why there is no picture. */
function startViewer(): Viewer | undefined {
  try {
    return new Viewer(element('view', HTMLCanvasElement))
  } catch {
    element('view', HTMLCanvasElement).hidden = true
    element('stage', HTMLElement).classList.add('blind')
    showNotice('stage-notice', kBlind)
    return undefined
  }
}

/** Waits until the page is on the screen: making a picture in 3D can take a moment, and words come first. */
function painted(): Promise<unknown> {
  const frames = new Promise((done) => requestAnimationFrame(() => setTimeout(done)))
  // A page in the background has no frames.
  return Promise.race([frames, new Promise((done) => setTimeout(done, 200))])
}

const samples = loadSamples()
// Begun while the files are on their way; told when they are waited for.
for (const early of [samples, init()]) early.catch(() => {})
await painted()
await new App().start(samples)
