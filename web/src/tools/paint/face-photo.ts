import type { Landmarks } from 'cagecast/cages';
import { Vector3 } from 'three';
import { make } from '../../platform/make';
import type { ExtractedMesh } from '../../state/model';
import { arrowStep } from '../cage/arrow-keys';

/** A place on a photo, in shares of its width and height from the upper left. */
type Place = readonly [number, number];

// In distances of the eyes, from the middle between them.
const kSide = 3.6; // of what is cut out
const kOval = { below: 0.25, wide: 1.15, high: 1.55 };
const kDeep = 1.5; // before and behind the eyes
const kFade = 0.75; // of the oval, from where it becomes transparent
const kCut = 1024; // pixels per side of what is cut out
const kTexels = 2048; // per side of the texture
const kOverlap = 1.5; // texels by which triangles lie over each other
const kFacing = -0.5; // the least cosine between a triangle and the front: sides of a nose may face a little away
const kBegin: readonly Place[] = [
  [0.38, 0.42],
  [0.62, 0.42],
];
const kLeastApart = 0.02; // of the photo: the dots of two eyes
const kStep = 0.005; // of the photo: how far an arrow key moves a dot

/** The eyes of a face, and its directions. */
interface Face {
  middle: Vector3;
  /** From its right eye to its left one; the other two are unit vectors. */
  along: Vector3;
  up: Vector3;
  front: Vector3;
}

/** @returns Undefined where landmarks do not say where both eyes are. */
export function findFace(landmarks: Landmarks): Face | undefined {
  const [left, right] = (['left', 'right'] as const).map((side) => {
    const [inner, outer] = [landmarks[`eye_inner_${side}`], landmarks[`eye_outer_${side}`]];
    const found = inner && outer ? new Vector3(...inner).add(new Vector3(...outer)).divideScalar(2) : undefined;
    return found ?? (landmarks[`eye_centre_${side}`] && new Vector3(...landmarks[`eye_centre_${side}`]!));
  });
  if (!left || !right) return undefined;
  const along = left.clone().sub(right);
  const up = new Vector3(0, 1, 0).addScaledVector(along, -along.y / along.lengthSq()).normalize();
  const front = along.clone().cross(up).normalize();
  return { middle: left.clone().add(right).divideScalar(2), along, up, front };
}

/** Corners of a triangle: in texels of the texture, and in pixels of what is cut out of the photo. */
interface Patch {
  to: Place[];
  from: Place[];
}

/** The triangles of a cage that a photo is seen on from the front. */
export function patchesOf(
  { positions, indices, uvs }: Pick<ExtractedMesh, 'positions' | 'indices' | 'uvs'>,
  face: Face,
): Patch[] {
  const { middle, along, up, front } = face;
  const distance = along.length();
  const patches: Patch[] = [];
  for (let i = 0; i < indices.length; i += 3) {
    const corners = [0, 1, 2].map((k) => new Vector3().fromArray(positions, 3 * indices[i + k]!).sub(middle));
    const [a, b, c] = corners as [Vector3, Vector3, Vector3];
    const normal = b.clone().sub(a).cross(c.clone().sub(a)).normalize();
    if (normal.dot(front) < kFacing || corners.some((one) => Math.abs(one.dot(front)) > kDeep * distance)) continue;
    const seen = corners.map((one): Place => [one.dot(along) / distance ** 2, one.dot(up) / distance]);
    if (seen.every(([x, y]) => Math.max(Math.abs(x), Math.abs(y)) > kSide / 2)) continue;
    patches.push({
      to: [0, 1, 2].map((k): Place => {
        const at = 2 * indices[i + k]!;
        return [uvs![at]! * kTexels, uvs![at + 1]! * kTexels];
      }),
      from: seen.map(([x, y]): Place => [(0.5 + x / kSide) * kCut, (0.5 - y / kSide) * kCut]),
    });
  }
  return patches;
}

/** Cuts the oval of a face out of a photo, upright. @param dots The eyes on it, the left one in the picture first. */
function cutFace(photo: ImageBitmap, dots: readonly Place[]): OffscreenCanvas {
  const [from, to] = dots.map(([x, y]) => [x * photo.width, y * photo.height] as const);
  const [dx, dy] = [to![0] - from![0], to![1] - from![1]];
  const canvas = new OffscreenCanvas(kCut, kCut);
  const context = canvas.getContext('2d')!;
  // The middle between the eyes is the origin, their distance the unit.
  context.translate(kCut / 2, kCut / 2);
  context.scale(kCut / kSide, kCut / kSide);
  context.save();
  context.rotate(-Math.atan2(dy, dx));
  context.scale(1 / Math.hypot(dx, dy), 1 / Math.hypot(dx, dy));
  context.imageSmoothingQuality = 'high';
  context.drawImage(photo, -(from![0] + to![0]) / 2, -(from![1] + to![1]) / 2);
  context.restore();
  context.translate(0, kOval.below);
  context.scale(kOval.wide, kOval.high);
  const oval = context.createRadialGradient(0, 0, kFade, 0, 0, 1);
  oval.addColorStop(0, '#000');
  oval.addColorStop(1, 'transparent');
  context.globalCompositeOperation = 'destination-in';
  context.fillStyle = oval;
  context.fillRect(-kSide, -kSide, 2 * kSide, 2 * kSide);
  return canvas;
}

/** Draws a face of a photo as a texture of a cage. @param dots As `askForEyes` gives them. @returns A PNG. */
export function drawFace(photo: ImageBitmap, dots: readonly Place[], cage: ExtractedMesh, face: Face): Promise<Blob> {
  const cut = cutFace(photo, dots);
  const canvas = new OffscreenCanvas(kTexels, kTexels);
  const context = canvas.getContext('2d')!;
  context.globalCompositeOperation = 'copy'; // where they overlap, nothing is drawn twice
  const positions = cage.rest ?? cage.positions;
  for (const { to, from } of patchesOf({ positions, indices: cage.indices, uvs: cage.uvs }, face)) {
    const [[ax, ay], [bx, by], [cx, cy]] = from as [Place, Place, Place];
    const [[au, av], [bu, bv], [cu, cv]] = to as [Place, Place, Place];
    const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (area === 0) continue;
    /** A coordinate of the texture by those of what is cut out: its two slopes and where it begins. */
    const slopes = (a: number, b: number, c: number): [number, number, number] => {
      const x = ((b - a) * (cy - ay) - (c - a) * (by - ay)) / area;
      const y = ((c - a) * (bx - ax) - (b - a) * (cx - ax)) / area;
      return [x, y, a - x * ax - y * ay];
    };
    const [[ux, uy, u], [vx, vy, v]] = [slopes(au, bu, cu), slopes(av, bv, cv)];
    const [mu, mv] = [(au + bu + cu) / 3, (av + bv + cv) / 3];
    context.save();
    context.beginPath();
    for (const [x, y] of to) {
      const grown = 1 + kOverlap / Math.max(1, Math.hypot(x - mu, y - mv));
      context.lineTo(mu + grown * (x - mu), mv + grown * (y - mv));
    }
    context.clip();
    context.setTransform(ux, vx, uy, vy, u, v);
    context.drawImage(cut, 0, 0);
    context.restore();
  }
  return canvas.convertToBlob();
}

/** Asks where the eyes are on a photo. @param found Called with the dots once they are on them, the left one in the picture first. */
export function askForEyes(photo: ImageBitmap, found: (dots: readonly Place[]) => void): void {
  const canvas = make('canvas', { width: photo.width, height: photo.height });
  canvas.getContext('2d')!.drawImage(photo, 0, 0);
  const area = make('div', { className: 'face-dots' }, canvas);
  area.style.width = `min(100%, 55dvh * ${photo.width / photo.height})`;
  const use = make('button', { type: 'button', className: 'strong' }, 'Put it on');
  const places = [...kBegin];
  const dots = ['Left eye in the picture', 'Right eye in the picture'].map((ariaLabel) =>
    make('button', { type: 'button', ariaLabel, ariaDescription: 'Arrow keys move it' }),
  );
  const move = (index: number, x: number, y: number): void => {
    places[index] = [Math.min(1, Math.max(0, x)), Math.min(1, Math.max(0, y))];
    const { style } = dots[index]!;
    [style.left, style.top] = places[index]!.map((share) => `${100 * share}%`) as [string, string];
    const [[left, top], [right, bottom]] = places as [Place, Place];
    use.disabled = Math.hypot(right - left, bottom - top) < kLeastApart;
  };
  const follow = (index: number, { clientX, clientY }: PointerEvent): void => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    move(index, (clientX - left) / width, (clientY - top) / height);
  };
  let held = -1;
  area.addEventListener('pointerdown', (event) => {
    const { left, width } = canvas.getBoundingClientRect();
    const at = (event.clientX - left) / width;
    held = Math.abs(at - places[0]![0]) < Math.abs(at - places[1]![0]) ? 0 : 1;
    area.setPointerCapture(event.pointerId);
    follow(held, event);
  });
  area.addEventListener('pointermove', (event) => held >= 0 && follow(held, event));
  for (const end of ['pointerup', 'pointercancel'] as const) area.addEventListener(end, () => (held = -1));
  dots.forEach((dot, index) => {
    area.append(dot);
    move(index, ...kBegin[index]!);
    dot.addEventListener('keydown', (event) => {
      const step = arrowStep(event);
      if (step) move(index, places[index]![0] + kStep * step[0], places[index]![1] + kStep * step[1]);
    });
  });
  const leave = make('button', { type: 'button', className: 'quiet' }, 'Cancel');
  const title = make('h2', { id: 'face-title' }, 'Put the dots on the eyes');
  const dialog = make(
    'dialog',
    { className: 'shortcuts face-photo' },
    title,
    area,
    make('div', { className: 'row' }, leave, use),
  );
  dialog.setAttribute('aria-labelledby', title.id);
  leave.addEventListener('click', () => dialog.close());
  use.addEventListener('click', () => {
    dialog.close();
    found(places.toSorted(([a], [b]) => a - b));
  });
  dialog.addEventListener('close', () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}
