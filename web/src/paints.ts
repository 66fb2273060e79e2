import { element } from './page'

/** A paint one can choose: its picture, if it has one of its own, and what to call it. */
export interface Choice {
  title: string
  picture?: string
}

/**
 * Offers paints as a row of pictures.
 * @param onChoose Called with the place of the chosen one.
 */
export function offerPaints(choices: readonly Choice[], chosen: number, onChoose: (index: number) => void): void {
  element('paints', HTMLElement).replaceChildren(
    ...choices.map(({ title, picture }, index) => {
      const label = document.createElement('label')
      const input = document.createElement('input')
      input.type = 'radio'
      input.name = 'paint'
      input.checked = index === chosen
      input.addEventListener('change', () => onChoose(index))
      const swatch = document.createElement('span')
      swatch.className = picture ? 'picture' : 'picture checker'
      if (picture) {
        const image = document.createElement('img')
        image.src = picture
        image.alt = ''
        swatch.append(image)
      }
      const name = document.createElement('span')
      name.className = 'title'
      name.textContent = title
      label.append(input, swatch, name)
      return label
    }),
  )
}
