/** The names of the templates that come with the package. */
export const templateNames = ['human-head', 'human-body', 'animal-head', 'car', 'face-mask'] as const;

/** The name of a template that comes with the package. */
export type TemplateName = (typeof templateNames)[number];

/** Whether a value is the name of a template that comes with the package. */
export const isTemplateName = (value: unknown): value is TemplateName =>
  (templateNames as readonly unknown[]).includes(value);
