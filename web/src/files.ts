import { element } from './page'

/** What a file is taken for. */
export type Role = 'target' | 'cage' | 'texture'

/** Files that came in together. */
export interface Intake {
  target?: File
  cage?: File
  texture?: File
  /** Models of which it is not clear yet which is the target. */
  unclear: File[]
  /** Everything that came along: a .gltf finds its .bin and images here. */
  all: File[]
}

const kModel = /\.(glb|gltf)$/i
const kImage = /\.(png|jpe?g|webp)$/i

/**
 * Sorts files by what they are: models by name, images as paint unless a .gltf came with them.
 * A file that is neither is taken for a target, so that the reader says what is wrong with it.
 */
export function sortFiles(files: readonly File[]): Intake {
  const intake: Intake = { unclear: [], all: [...files] }
  const withGltf = files.some((file) => /\.gltf$/i.test(file.name))
  for (const file of files) {
    if (kModel.test(file.name)) {
      if (/cage/i.test(file.name) && !intake.cage) intake.cage = file
      else intake.unclear.push(file)
    } else if (kImage.test(file.name) || file.type.startsWith('image/')) {
      if (!withGltf) intake.texture = file
    } else if (!withGltf) {
      intake.unclear.push(file)
    }
  }
  if (intake.unclear.length > 0 && (intake.cage || intake.unclear.length === 1)) intake.target = intake.unclear.shift()!
  return intake
}

/**
 * Listens for files that are chosen or dropped, anywhere on the page.
 * @param onFiles Called with what came in; the role is known where a file was given to one of the three fields.
 */
export function setUpFiles(onFiles: (intake: Intake) => void): void {
  for (const role of ['target', 'cage', 'texture'] as const) {
    const input = element(`${role}-input`, HTMLInputElement)
    const tile = element(`${role}-file`, HTMLElement)
    const give = (files: File[]): void => {
      const main = files.find((file) => (role === 'texture' ? kImage : kModel).test(file.name)) ?? files[0]
      if (main) onFiles({ [role]: main, unclear: [], all: files })
    }
    input.addEventListener('change', () => {
      const files = [...(input.files ?? [])]
      input.value = '' // so that the same file, edited, can be chosen again
      give(files)
    })
    tile.addEventListener('drop', (event) => {
      const files = [...(event.dataTransfer?.files ?? [])]
      if (files.length !== 1) return // several: sorted by what they are
      event.preventDefault()
      event.stopPropagation()
      hideVeil()
      give(files)
    })
  }

  const veil = element('veil', HTMLElement)
  const hideVeil = (): void => void (veil.hidden = true)
  addEventListener('dragover', (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return
    event.preventDefault()
    event.dataTransfer.dropEffect = 'copy'
    veil.hidden = false
  })
  addEventListener('dragleave', (event) => {
    if (!event.relatedTarget) hideVeil()
  })
  addEventListener('drop', (event) => {
    event.preventDefault()
    hideVeil()
    const files = [...(event.dataTransfer?.files ?? [])]
    if (files.length > 0) onFiles(sortFiles(files))
  })
}
