import { DataArrayTexture, LinearFilter, RedFormat } from 'three';
import { regionMask } from '../../bake/region-mask.js';
import { maskSize, type Regions } from '../../gltf/look/saved-layers.js';
import { isRegion, type Outline } from '../../parts/template.js';
import { type LoadedCage, objectOf } from '../apply/models.js';

/** The regions of a cage, which loaded ones have in their `userData`. @throws {CagecastError} `badArgument` */
export function regionsOf(cage: LoadedCage): Regions {
  const object = objectOf(cage, 'cage');
  const found: Record<string, readonly Outline[]> = {};
  const read = ({ userData }: { userData: Record<string, unknown> }) => {
    for (const [name, outlines] of Object.entries(Object(userData['regions'])))
      if (isRegion(outlines)) found[name] = outlines;
  };
  read(object);
  if ('isObject3D' in object)
    object.traverse((one) => {
      read(one);
      if ('geometry' in one) read(one.geometry as typeof one);
    });
  return found;
}

/** The masks of regions in one texture, so that any number of layers needs one unit of the GPU. */
export class RegionMasks {
  #names: readonly string[] = [];
  #texture: DataArrayTexture | undefined;
  readonly #known = new Map<string, Uint8Array>();

  constructor(readonly regions: Regions) {}

  /**
   * The texture with the masks of some regions, one after the other.
   * Cost: nothing if they are those of the last call; a tenth of a second for a region that is new.
   */
  of(names: readonly string[]): DataArrayTexture | null {
    if (names.join('\n') === this.#names.join('\n')) return this.#texture ?? null;
    this.dispose();
    if (names.length === 0) return null;
    this.#names = names;
    const data = new Uint8Array(maskSize * maskSize * names.length);
    names.forEach((name, n) => data.set(this.#mask(name), maskSize * maskSize * n));
    const texture = new DataArrayTexture(data, maskSize, maskSize, names.length);
    Object.assign(texture, { format: RedFormat, minFilter: LinearFilter, magFilter: LinearFilter, needsUpdate: true });
    this.#texture = texture;
    return texture;
  }

  /** Frees its GPU memory. */
  dispose(): void {
    this.#texture?.dispose();
    this.#texture = undefined;
    this.#names = [];
  }

  #mask(name: string): Uint8Array {
    const known = this.#known.get(name);
    if (known) return known;
    const { data } = regionMask(this, name, { width: maskSize });
    const mask = Uint8Array.from({ length: maskSize ** 2 }, (_, at) => data[4 * at + 3]!);
    this.#known.set(name, mask);
    return mask;
  }
}
