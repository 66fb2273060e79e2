import type { Preset } from 'cagecast';
import type { Borders } from '#three';
import { element } from '../platform/page';
import type { Session } from '../state/session';

/** Connects the fields for preset, threshold, weld tolerance and exact borders. */
export function setUpRules(session: Session): void {
  const preset = element('preset', HTMLSelectElement);
  const threshold = element('threshold', HTMLInputElement);
  preset.addEventListener('change', () => session.setRules({ preset: preset.value as Preset }));
  const weld = element('weld', HTMLSelectElement);
  weld.addEventListener('change', () => session.setRules({ weldTolerance: Number(weld.value) }));
  const exact = element('exact-borders', HTMLInputElement);
  const chosenBorders = (): Borders => (exact.checked ? 'cut' : 'triangle');
  exact.addEventListener('change', () => session.setRules({ borders: chosenBorders() }));
  threshold.addEventListener('input', () => session.setRules({ threshold: Number(threshold.value) }));
  session.on('rules', (rules) => {
    preset.value = rules.preset;
    exact.checked = rules.borders === 'cut';
    const tolerance = String(rules.weldTolerance);
    // A link or a project may have another one.
    if (![...weld.options].some(({ value }) => value === tolerance))
      weld.add(new Option(`${100 * rules.weldTolerance} %`, tolerance));
    weld.value = tolerance;
    threshold.value = String(rules.threshold);
    element('threshold-value', HTMLOutputElement).value = rules.threshold.toFixed(2);
  });
  // Browsers keep the state of fields on reload.
  session.setRules({
    preset: preset.value as Preset,
    threshold: Number(threshold.value),
    weldTolerance: Number(weld.value),
    borders: chosenBorders(),
  });
}
