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

/** A landmark's name for people: "ear_lobe_left" is the left ear lobe. */
export const readable = (landmark: string): string =>
  landmark
    .replace(/^(.*)_(left|right)$/, '$2 $1')
    .replace(/^lip_(upper|lower)$/, '$1 lip')
    .replace(/^(.*?)joint_(.*)$/, '$1$2 joint')
    .replaceAll('_', ' ');

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
