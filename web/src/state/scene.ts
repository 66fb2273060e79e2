import type { Model } from './model';
import type { Paint } from './paint';
import type { SplitProjection } from './transfers';

/** A target, its cage and a paint. */
export interface Scene {
  target: Model;
  cage: Model;
  paint: Paint;
}

/** A part of a scene. */
export type Slot = keyof Scene;

export const kSlots = ['target', 'cage', 'paint'] as const;

/** A scene and its transfer. */
export interface Shown extends Scene {
  projection: SplitProjection;
}

/** A scene that is being loaded. */
export type Requested = { [One in Slot]?: Promise<Scene[One]> };
