import { announce, element } from '../page'
import type { Session, Shown } from '../session'
import { Superseded, TransferClient } from '../transfer-client'
import type { Viewer } from '../viewer'
import { kDeforms, type Deform } from './deform'
import { Pose } from './pose'

const kSeconds = 4 // there and back, of what moves by itself

/**
 * Moves the model and transfers it again for every frame: the paint follows, whatever becomes of the shape. A new frame
 * is begun when the one before is on show, so that a slow device shows fewer of them, and none too late.
 */
export class Live {
  readonly #session: Session
  /** Busy while frames are under way. */
  readonly #section = element('live', HTMLElement)
  readonly #deform = element('deform', HTMLSelectElement)
  readonly #amount = element('amount', HTMLInputElement)
  readonly #moves = element('deform-moves', HTMLInputElement)
  readonly #along = element('deform-cage', HTMLInputElement)
  #client: TransferClient | undefined
  #shown: Shown | undefined
  #poses: { target: Pose; cage: Pose } | undefined
  #stale = false
  #started: number | undefined

  constructor(session: Session, viewer: Viewer | undefined) {
    this.#session = session
    this.#deform.replaceChildren(...kDeforms.map((name) => new Option(name[0]!.toUpperCase() + name.slice(1), name)))
    this.#amount.addEventListener('input', () => {
      this.#stop()
      this.#next()
    })
    for (const input of [this.#deform, this.#along]) input.addEventListener('change', () => this.#next())
    this.#moves.addEventListener('change', () => (this.#moves.checked ? this.#start() : this.#stop()))
    session.on('transfer', (shown) => this.#onTransfer(shown))
    if (viewer) setUpAnimations(session, viewer)
  }

  #onTransfer(shown: Shown): void {
    const same = shown.target === this.#shown?.target && shown.cage === this.#shown.cage
    this.#shown = shown
    if (same) return // another preset, of what is moved as it is
    this.#stop()
    this.#poses = undefined
    this.#amount.value = '0'
    this.#showFrame(0)
  }

  #start(): void {
    this.#started = performance.now()
    announce('The model moves, and is transferred anew for every frame.')
    this.#next()
  }

  #stop(): void {
    this.#started = undefined
    this.#moves.checked = false
  }

  /** Asks for another frame; while one is under way, for one more after it. */
  #next(): void {
    this.#stale = true
    if (this.#section.ariaBusy !== 'true') void this.#run()
  }

  async #run(): Promise<void> {
    this.#section.ariaBusy = 'true'
    try {
      while (this.#stale && this.#shown) {
        this.#stale = this.#started !== undefined
        await this.#frame(this.#shown)
        // A page in the background has no frames, and needs none.
        await new Promise(requestAnimationFrame)
      }
    } catch (error) {
      if (!(error instanceof Superseded)) this.#session.fail(error)
      this.#stop()
    } finally {
      this.#section.ariaBusy = 'false'
    }
  }

  async #frame(shown: Shown): Promise<void> {
    if (this.#started !== undefined) {
      const phase = Math.sin(((performance.now() - this.#started) / 1000) * ((2 * Math.PI) / kSeconds))
      this.#amount.value = phase.toFixed(2)
    }
    const amount = Number(this.#amount.value)
    const how = this.#deform.value as Deform
    this.#poses ??= { target: new Pose(shown.target.mesh), cage: new Pose(shown.cage.mesh) }
    const { target, cage } = this.#poses
    const { room } = target
    const along = this.#along.checked ? amount : 0
    const [targetPositions, cagePositions] = [target.positions(how, amount, room), cage.positions(how, along, room)]
    const moved = <T extends Shown['target']>(model: T, positions: Float32Array): T => ({ ...model, mesh: { ...model.mesh, positions } })
    this.#client ??= new TransferClient()
    const { preset } = this.#session.rules
    const projection = await this.#client.ask('project', moved(shown.cage, cagePositions), moved(shown.target, targetPositions), { preset })
    // Something else may be on show by now.
    if (this.#shown !== shown || preset !== this.#session.rules.preset) return
    target.set(targetPositions, how, amount, room)
    cage.set(cagePositions, how, along, room)
    this.#session.showFrame(projection)
    this.#showFrame(amount, projection.timings.total)
  }

  #showFrame(amount: number, milliseconds?: number): void {
    element('frame-time', HTMLElement).textContent = milliseconds === undefined ? '–' : milliseconds.toFixed(milliseconds < 10 ? 2 : 1)
    element('amount-value', HTMLOutputElement).value = amount.toFixed(2)
  }
}

/** Lets a model's animations be played; the first of them plays by itself, unless the visitor wants no motion. */
function setUpAnimations(session: Session, viewer: Viewer): void {
  const field = element('animation-field', HTMLElement)
  const select = element('animation', HTMLSelectElement)
  const still = matchMedia('(prefers-reduced-motion: reduce)')
  let target: Shown['target'] | undefined
  select.addEventListener('change', () => viewer.play(target?.animations[Number(select.value)]))
  session.on('transfer', (shown) => {
    if (shown.target === target) return
    target = shown.target
    const { animations } = target
    field.hidden = animations.length === 0
    const names = animations.map(({ name }, index) => new Option(name || `Animation ${index + 1}`, String(index)))
    select.replaceChildren(new Option('None', '-1'), ...names)
    select.value = animations.length > 0 && !still.matches ? '0' : '-1'
    viewer.play(animations[Number(select.value)])
  })
}
