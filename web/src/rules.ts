import type { Preset } from 'cagecast'
import { element } from './page'
import type { Session } from './session'

/** Lets the preset and the threshold be chosen. */
export function setUpRules(session: Session): void {
  const preset = element('preset', HTMLSelectElement)
  const threshold = element('threshold', HTMLInputElement)
  preset.addEventListener('change', () => session.setRules({ preset: preset.value as Preset }))
  threshold.addEventListener('input', () => session.setRules({ threshold: Number(threshold.value) }))
  session.on('rules', (rules) => {
    preset.value = rules.preset
    threshold.value = String(rules.threshold)
    element('threshold-value', HTMLOutputElement).value = rules.threshold.toFixed(2)
  })
  // A reloaded page keeps its fields as they were.
  session.setRules({ preset: preset.value as Preset, threshold: Number(threshold.value) })
}
