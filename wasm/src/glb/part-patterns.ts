/** Patterns for the names of nodes, meshes and materials, in which `*` stands for any text. */
export interface PartPatterns {
  /** Parts that stay bare. Default: none but glasses, hats and what the cage was made without. */
  exclude?: readonly string[] | undefined;
  /** Parts that are painted wherever the cage covers them, even if their names would leave them bare. Default: none. */
  keep?: readonly string[] | undefined;
}
