import type { Opener } from '../open'
import type { Session } from '../session'
import { readLink, writeLink, type LinkedLayer } from './link'

/** The layers, as a link can carry them. */
export interface LinkedLayers {
  /** From the lowest to the uppermost; without the visitor's own. */
  readonly layers: LinkedLayer[]
  /** How many are left out. */
  readonly left: number
  /** Lays them once the sample is there, the first of them in place of its paint. What the page does not have is left out. */
  restore(layers: LinkedLayer[]): void
}

/** The fragment that leads to what is shown, with its `#`. @returns Nothing if it is not a sample. */
export function linkOf({ shown, rules, locks, view }: Session, { layers }: LinkedLayers): string | undefined {
  const sample = shown?.target.sample
  if (!sample || sample !== shown.cage.sample) return undefined
  return `#${writeLink({ sample: sample.name, layers, rules, locks, view })}`
}

/**
 * Restores what the page's address says, now and whenever it changes; now only if nothing was asked for yet.
 * @returns Whether there is anything to come.
 */
export function followLinks(session: Session, opener: Opener, linked: LinkedLayers): boolean {
  const restore = (): boolean => {
    const state = readLink(location.hash)
    if (!state || !opener.samples.some(({ name }) => name === state.sample)) return false
    session.setRules(state.rules)
    session.setView(state.view)
    opener.openSample(state.sample, state.layers[0]?.paint, state.locks)
    linked.restore(state.layers)
    return true
  }
  addEventListener('hashchange', () => {
    // Not for a link to what is shown, as one that was just made.
    if (location.hash !== linkOf(session, linked)) restore()
  })
  return session.begun || restore()
}
