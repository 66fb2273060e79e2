import type { Part } from './glb.ts';
import type { Rgba, Shade } from './image.ts';
import type { Mesh } from './mesh.ts';
import type { Template } from './template.ts';
import type { Vec3 } from './vec.ts';

/** A texture to draw for a cage; `far` is the colour of texels that the cage does not use. */
export interface Paint {
  name: string;
  title: string;
  shade: Shade;
  far: Rgba;
}

/** A sample: a target in parts, the cage around it, and textures drawn for the cage. */
export interface Model {
  name: string; // its folder
  title: string; // for people
  parts: Part[];
  cage: Mesh; // with UVs
  misfit?: boolean; // the cage is wrong on purpose
  inside: (p: Vec3) => boolean; // points of paintable parts that count as the inside of the model: not scored
  template?: Template | undefined; // made along with it, for the package
  paints: Paint[] | { of: string }; // of its own, or those of another model whose cage has the same UVs
}
