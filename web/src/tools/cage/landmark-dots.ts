import {
  BufferAttribute,
  BufferGeometry,
  CanvasTexture,
  Color,
  Group,
  Points,
  PointsMaterial,
  type Vector3,
} from 'three';

/** A dot and its colour. */
interface Dot {
  at: Vector3;
  color: string;
}

const kSize = 13; // pixels
const kRim = 2;
const kFaint = 0.3; // opacity behind the model

/** Dots of constant size on the screen; faint where the model is in front of them, unless they are on top. */
export class LandmarkDots {
  readonly object = new Group();
  readonly #geometry = new BufferGeometry();
  readonly #round = roundTexture();

  constructor(ratio: number, onTop = false) {
    const add = (depthTest: boolean, rim: boolean): void => {
      const material = new PointsMaterial({
        size: (kSize + (rim ? 2 * kRim : 0)) * ratio,
        sizeAttenuation: false,
        map: this.#round,
        alphaTest: 0.5,
        transparent: true,
        opacity: depthTest || onTop ? 1 : kFaint,
        depthTest,
        depthWrite: false,
        toneMapped: false,
        ...(rim ? { color: '#ffffff' } : { vertexColors: true }),
      });
      if (!depthTest && !onTop) material.alphaTest *= kFaint;
      const points = new Points(this.#geometry, material);
      points.frustumCulled = false;
      points.renderOrder = depthTest ? 8 : 7;
      this.object.add(points);
    };
    for (const depthTest of onTop ? [false] : [false, true]) for (const rim of [true, false]) add(depthTest, rim);
  }

  /** @param nearer Added to each position: surfaces must not cut the dots. */
  show(dots: readonly Dot[], nearer: Vector3): void {
    const positions = new Float32Array(3 * dots.length);
    const colors = new Float32Array(3 * dots.length);
    const color = new Color();
    dots.forEach((dot, i) => {
      dot.at
        .clone()
        .add(nearer)
        .toArray(positions, 3 * i);
      color.set(dot.color).toArray(colors, 3 * i);
    });
    this.#geometry.setAttribute('position', new BufferAttribute(positions, 3));
    this.#geometry.setAttribute('color', new BufferAttribute(colors, 3));
    this.#geometry.setDrawRange(0, dots.length);
  }

  dispose(): void {
    this.object.removeFromParent();
    this.#geometry.dispose();
    this.#round.dispose();
    for (const points of this.object.children) (points as Points<BufferGeometry, PointsMaterial>).material.dispose();
  }
}

function roundTexture(): CanvasTexture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 32;
  const pen = canvas.getContext('2d')!;
  pen.fillStyle = '#fff';
  pen.arc(16, 16, 15, 0, 2 * Math.PI);
  pen.fill();
  return new CanvasTexture(canvas);
}
