import { element } from './page';

/** The faces of the page: what one plays with, and everything that there is to be seen of the method. */
export type Face = 'play' | 'inspect';

const kKey = 'cagecast-face';

const root = document.documentElement;
const button = element('face', HTMLButtonElement);
const followers: ((face: Face) => void)[] = [];

/** The face that is shown. What is of one only is marked by `data-in` in the document, and hidden by the stylesheet. */
export const face = (): Face => root.dataset.face as Face;

/** Calls back now, and with each other face. */
export function onFace(follow: (face: Face) => void): void {
  followers.push(follow);
  follow(face());
}

/** Shows a face. */
export function showFace(to: Face): void {
  if (to === face()) return;
  root.dataset.face = to;
  button.ariaPressed = String(to === 'inspect');
  for (const details of document.querySelectorAll<HTMLDetailsElement>('details[data-open]'))
    details.open = details.dataset.open === to;
  for (const follow of followers) follow(to);
}

/** Connects the switch, and shows the face that was chosen last. */
export function setUpFaces(): void {
  button.addEventListener('click', () => {
    showFace(face() === 'play' ? 'inspect' : 'play');
    try {
      localStorage.setItem(kKey, face());
    } catch {
      // The next visit begins with Play.
    }
  });
  try {
    if (localStorage.getItem(kKey) === 'inspect') showFace('inspect');
  } catch {
    // Browsers may forbid to store anything.
  }
}
