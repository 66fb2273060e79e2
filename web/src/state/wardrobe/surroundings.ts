import type { Loader, Model } from '../model';
import type { Paint } from '../paint';
import type { Session } from '../session';
import type { SplitProjection, Transferer } from '../transfers';
import type { Figure } from './avatar';

/** How a fit goes on. */
export interface FitProgress {
  signal: AbortSignal;
  onProgress(share: number): void;
}

/** What the wardrobe needs of the page. */
export interface Surroundings {
  session: Session;
  loader: Loader;
  /** One of its own, for the avatars beside the stage. */
  transferer: Transferer;
  /** Fits the cage of one model to another, with the same triangles and UVs. @returns The cage as a file. */
  fit(cage: Model, model: Model, progress: FitProgress): Promise<File>;
  /** Chooses a cage for a model, as for one that is opened alone. */
  choose(model: Model, progress: FitProgress): Promise<Model>;
  /** The base paint, if it is shown, and one of those that are drawn for any cage. */
  drawing(): { name: string; draw(cage: Model): Promise<Paint> } | undefined;
  /** Draws what the wardrobe has. */
  view: WardrobeView;
  errors: {
    /** Shows an error in place of others. */
    show(message: string): void;
    /** Shows an error below those that are shown. */
    add(message: string): void;
  };
}

/** How the wardrobe is seen. */
export interface WardrobeView {
  /** Makes a model ready to stand beside the stage. */
  stand(model: Model, projection: SplitProjection | undefined): Figure;
  /** Shows figures side by side, in their order; undefined stands for the model on the stage. Without figures only that is shown. */
  arrange(figures: readonly (Figure | undefined)[] | undefined): void;
  redraw(): void;
}
