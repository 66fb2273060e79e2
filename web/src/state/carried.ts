/** What a model that was saved here has with it, unseen by other programs: to go on with it when it is opened again. */
export interface Carried {
  /** Its cage, a GLB. */
  cage?: File | undefined;
  /** All paint on it, an image in the UVs of the cage. */
  paint?: File | undefined;
}

const carried = new WeakMap<File, Carried>();

/** What a file has with it. @param file Of a model, or the cage that a model had with it. */
export const carriedBy = (file: File): Carried => carried.get(file) ?? {};

/** Notes what a file has with it. */
export function noteCarried(file: File, { cage, paint }: Carried): void {
  carried.set(file, { cage, paint });
  if (cage) carried.set(cage, { paint });
}
