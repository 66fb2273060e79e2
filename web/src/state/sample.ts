/** A model that comes with the page. Files are URLs. */
export interface Sample {
  name: string;
  title: string;
  /** Whether it is there for tests, and nothing to play with. */
  test?: boolean;
  target: string;
  cage: string;
  /** What must not be painted, if that is known. */
  truth?: string;
  /** None if it is painted with those that are drawn for any cage. */
  paints: { title: string; file: string }[];
}

/** The name of the checker in links. */
export const kChecker = 'checker';

/** The samples, as they are found by names from links and projects. */
export interface Samples {
  readonly samples: readonly Sample[];
  /** A sample's paint by its name in links. */
  find(paint: string): { sample: Sample; paint: Sample['paints'][number] } | undefined;
}
