/** A model that comes with the page. Files are URLs. */
export interface Sample {
  name: string;
  title: string;
  target: string;
  cage: string;
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
