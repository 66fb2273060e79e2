import type { Fit, Landmarks, TemplateName } from 'cagecast/cages';
import type { Model } from './model';
import type { Sample } from './sample';

/** A template that was fitted. */
export interface Fitting extends Omit<Fit, 'cage'> {
  template: TemplateName;
  /** Those of `used` that the user placed. */
  given: Landmarks;
}

/** How many landmarks the user is asked for at most, where too little was found. */
export const kMaxAsked = 4;

/** How a cage was made here. */
interface Made {
  /** What it was made for. */
  target: File;
  /** The fit that it came from. */
  fitting: Fitting | undefined;
  /** The sample whose cage it was changed from. Its UVs are the same. */
  sample?: Sample | undefined;
  /** What was done, for people. */
  note?: string;
  /** Whether it is as it was made, or fitted: it is where it belongs. */
  isNew?: boolean | undefined;
}

/** By the files of the cages. */
const made = new WeakMap<File, Made>();

/** How a cage was made; undefined if it was not made here. */
export const madeOf = (cage: File): Made | undefined => made.get(cage);

/** The sample whose paints fit a cage. */
export const sampleOf = ({ sample, files }: Model): Sample | undefined => sample ?? madeOf(files[0]!)?.sample;

/** Notes how a cage was made. */
export const noteMade = (cage: File, how: Made): unknown => made.set(cage, how);

/** Landmarks that were found on models, by their files. */
const found = new WeakMap<File, Landmarks>();

/** Notes which landmarks were found on a model. */
export const noteFound = (target: Model, landmarks: Landmarks): unknown => found.set(target.files[0]!, landmarks);

/** The landmarks of a model: used by the fit of its cage, without guesses, or else found on it. */
export function knownLandmarks(target: Model, cage: Model): Landmarks | undefined {
  const { fitting } = madeOf(cage.files[0]!) ?? {};
  if (!fitting) return found.get(target.files[0]!);
  return Object.fromEntries(Object.entries(fitting.used).filter(([name]) => !fitting.guessed.includes(name)));
}

/** A landmark's name for people: "ear_lobe_left" is the left ear lobe. */
export const readable = (landmark: string): string =>
  landmark
    .replace(/^(.*)_(left|right)$/, '$2 $1')
    .replace(/^lip_(upper|lower)$/, '$1 lip')
    .replace(/^(.*?)joint_(.*)$/, '$1$2 joint')
    .replaceAll('_', ' ');
