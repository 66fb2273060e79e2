import type { Classification, CutTarget } from 'cagecast';
import type { Texture } from 'three';
import type { ExtractedMesh } from '../../state/model';
import { Pace } from '../../state/pace';
import type { Decision } from '../../state/study/baselines';
import type { SplitProjection } from '../../state/transfers';
import { Highlight } from './highlight';
import type { Highlighted, Look } from './looks';
import { PrimitiveOverlay } from './primitive-overlay';

/** The layer of what casts contact shadows. */
export const kCasts = 1;
/** A layer that no camera draws and no ray meets. */
const kNoLayer = 31;

/**
 * The paint over a target: overlay meshes for each of its meshes, which share its skin and morphs. The naive one shares its
 * vertices. The filtered one splits them at UV seams. The colored one, made on demand, has separate vertices for each
 * triangle, so that colours do not bleed.
 */
export class Overlay {
  readonly #primitives: PrimitiveOverlay[];
  readonly #highlights: Record<Highlighted, Highlight>;
  #version = 0;

  /**
   * Shows nothing until `classify` is called.
   * @param paint In the cage's UVs, with premultiplied alpha; it may be a render target's texture.
   */
  constructor(target: ExtractedMesh, projection: SplitProjection, paint: Texture | undefined) {
    this.#highlights = {
      parts: new Highlight(target, '#22d3ff', 0.5, 0.35),
      bare: new Highlight(target, '#d81b60', 0.55),
    };
    const { leftOut } = projection;
    // Its visibility would hide what hangs on it, too.
    target.primitives.forEach(({ mesh: { layers } }, group) => {
      layers.set(0);
      layers.enable(kCasts);
      if (leftOut.includes(group)) layers.set(kNoLayer);
    });
    const filled = target.primitives.filter(
      ({ triangleCount }, group) => triangleCount > 0 && !leftOut.includes(group),
    );
    this.#primitives = filled.map((primitive) => new PrimitiveOverlay(primitive, target.indices, paint));
    this.setProjection(projection);
  }

  /** Updates the projection of a target that moved; removes a cut and the highlighted parts. Call `classify` next. */
  setProjection({ uvs, split }: SplitProjection): void {
    this.#version++;
    this.highlight('parts', undefined);
    for (const primitive of this.#primitives) primitive.setProjection(uvs, split);
  }

  /** Sets the zones. */
  classify(classification: Classification): void {
    for (const primitive of this.#primitives) primitive.classify(classification);
  }

  /** Shows the filtered paint on the cut target; undefined shows it on its own triangles. The last call wins. */
  async setCut(cut: CutTarget | undefined): Promise<void> {
    const call = ++this.#version;
    for (const primitive of this.#primitives) primitive.clearCut();
    if (!cut) return;
    const pace = new Pace();
    for (const primitive of this.#primitives) {
      if (call !== this.#version) return;
      primitive.setCut(cut);
      await pace.rest();
    }
  }

  /** Sets what the look of a half paints; undefined: nothing. */
  setHalf(half: 'left' | 'right', decision: Decision | undefined): void {
    for (const primitive of this.#primitives) primitive.setHalf(half, decision);
  }

  setPaint(paint: Texture): void {
    for (const primitive of this.#primitives) primitive.setPaint(paint);
  }

  /** Sets the texture of the look `checker`. */
  setChecker(checker: Texture): void {
    for (const primitive of this.#primitives) primitive.setChecker(checker);
  }

  /** Sets the colours of the look `colors`. @param colors 3 bytes per triangle corner of the target, sRGB. */
  setColors(colors: Uint8Array): void {
    for (const primitive of this.#primitives) primitive.setColors(colors);
  }

  /** Highlights triangles in any look. @param marks 1 for each of them; undefined highlights none. */
  highlight(what: Highlighted, marks: Uint8Array | undefined): void {
    this.#highlights[what].show(marks);
  }

  /** Sets what the next frame draws. */
  show(look: Look): void {
    for (const primitive of this.#primitives) primitive.show(look);
  }

  dispose(): void {
    this.#version++;
    for (const highlight of Object.values(this.#highlights)) highlight.dispose();
    for (const primitive of this.#primitives) primitive.dispose();
  }
}
