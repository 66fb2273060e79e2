import { element } from './page'

/** A paint one can choose: what to call it, and the address of its picture. */
export interface Choice {
  title: string
  picture: string
}

/**
 * Offers paints as a row of pictures.
 * @param chosen   The place of the one in use.
 * @param onChoose Called with the place of another one, once it is chosen.
 */
export function offerPaints(choices: readonly Choice[], chosen: number, onChoose: (index: number) => void): void {
  const row = element('paints', HTMLElement)
  const offered = JSON.stringify(choices)
  // The same row stays where it is: the keyboard's focus may be in it.
  if (row.dataset.offered !== offered) row.replaceChildren(...choices.map(label))
  row.dataset.offered = offered
  row.querySelectorAll('input').forEach((input, index) => {
    input.checked = index === chosen
    input.onchange = () => onChoose(index)
  })
}

function label({ title, picture }: Choice): HTMLElement {
  const input = document.createElement('input')
  input.type = 'radio'
  input.name = 'paint'
  const frame = document.createElement('span')
  frame.className = 'picture'
  const image = document.createElement('img')
  image.src = picture
  image.alt = ''
  frame.append(image)
  const name = document.createElement('span')
  name.className = 'title'
  name.textContent = title
  const label = document.createElement('label')
  label.append(input, frame, name)
  return label
}
