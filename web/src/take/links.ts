import type { Opener } from '../open'
import type { Session } from '../session'
import type { Angle } from '../view'
import type { Viewer } from '../viewer'
import { readLink, writeLink, type LinkedLayer, type LinkState } from './link'

/** The layers, as a link can carry them. */
export interface LinkedLayers {
  /** From the lowest to the uppermost; without the visitor's own. */
  readonly layers: LinkedLayer[]
  /** How many are left out. */
  readonly left: number
  /** Lays them once the sample is there, the first of them in place of its paint. What the page does not have is left out. */
  restore(layers: LinkedLayer[]): void
}

/** What a link to what is shown restores. @returns Nothing if it is not a sample. */
function stateOf({ shown, rules, locks, view }: Session, { layers }: LinkedLayers, angle: Angle | undefined): LinkState | undefined {
  const sample = shown?.target.sample
  if (!sample || sample !== shown.cage.sample) return undefined
  return { sample: sample.name, layers, rules, locks, view, angle }
}

/** The fragment that leads to what is shown, with its `#`. @returns Nothing if it is not a sample. */
export function linkOf(session: Session, linked: LinkedLayers, angle: Angle | undefined): string | undefined {
  const state = stateOf(session, linked, angle)
  return state && `#${writeLink(state)}`
}

/**
 * Restores what the page's address says, now and whenever it changes; now only if nothing was asked for yet.
 * @returns Whether there is anything to come.
 */
export function followLinks(session: Session, opener: Opener, linked: LinkedLayers, viewer: Viewer | undefined): boolean {
  const restore = (): boolean => {
    const state = readLink(location.hash)
    if (!state || !opener.samples.some(({ name }) => name === state.sample)) return false
    const { angle } = state
    const shown = stateOf(session, linked, undefined)
    if (shown && writeLink(shown) === writeLink({ ...state, angle: undefined })) {
      // As after a link was made of what is shown.
      if (angle) viewer?.lookFrom(angle)
      return true
    }
    session.setRules(state.rules)
    session.setView(state.view)
    opener.openSample(state.sample, state.layers[0]?.paint, state.locks)
    linked.restore(state.layers)
    const end = session.on('transfer', ({ target }) => {
      end()
      if (angle && target.sample?.name === state.sample) viewer?.lookFrom(angle)
    })
    return true
  }
  addEventListener('hashchange', restore)
  return session.begun || restore()
}
