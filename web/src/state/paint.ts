import type { Texture } from 'three';
import type { Sample } from './sample';

/** A texture in the cage's UV space. */
export interface Paint {
  /** The file's name, for people. */
  name: string;
  texture: Texture;
  /** URL of the image. */
  picture: string;
  /** The image; absent for the checker. */
  file?: File;
  /** The sample it belongs to; undefined for the user's own and the checker. */
  sample?: Sample;
  /** Its name among the paints that are drawn for any cage; undefined for all others. */
  drawn?: string;
  /** What links have of strokes that came with a link. */
  linked?: string;
}

/** Whether a paint is one of those that the page offers, and not the user's own. */
export const isOffered = (paint: Partial<Paint> | undefined, checker: Paint): boolean =>
  paint !== undefined && (paint === checker || paint.sample !== undefined || paint.drawn !== undefined);

/** The title of a paint in lists. */
export function titleOf({ name, picture, sample }: Paint): string {
  return sample?.paints.find(({ file }) => file === picture)?.title ?? name;
}
