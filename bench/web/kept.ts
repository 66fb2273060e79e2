type TypedArray = Float32Array | Float64Array | Int32Array | Uint32Array | Uint8Array;

/**
 * The peer's typed arrays, made by its first transfer and used again by all later ones, as the package keeps its working memory
 * and, with `into`, its answer.
 */
export class Kept {
  readonly #arrays = new Map<string, TypedArray>();

  /** @returns an array of that length, the one of that name if it fits; with whatever is in it. */
  take<A extends TypedArray>(name: string, Type: new (length: number) => A, length: number): A {
    const kept = this.#arrays.get(name);
    if (kept?.length === length) return kept as A;
    const made = new Type(length);
    this.#arrays.set(name, made);
    return made;
  }
}
