/** Where files of dropped folders are. */
export const paths = new WeakMap<File, string>();
