import { type Mesh, point, vertexCount } from './mesh.ts';
import { spaceOf } from './space.ts';
import { add, dot, length, mirrorX, scale, sub, type Vec3 } from './vec.ts';

/** Named spots of a model, such as `nose_tip`; docs/cages.md lists the names. */
export type Landmarks = Record<string, Vec3>;

/** Ways to find a spot on the skin of a model. */
export interface Finder {
  /** The point of the skin nearest to `p`. */
  near(p: Vec3): Vec3;
  /** Where the skin is hit from outside, seen from far away against `direction`, on the line through `p`. */
  from(direction: Vec3, p: Vec3): Vec3;
  /** The point of the skin furthest along `direction`, among those within `radius` of `p`. */
  furthest(direction: Vec3, p: Vec3, radius: number): Vec3;
}

const kFar = 10; // model units: outside every model

export const finderOn = (skin: Mesh): Finder => {
  const space = spaceOf(skin);
  return {
    near: (p) => space.nearest(p).point,
    from: (direction, p) => {
      const hit = space.hit(add(p, scale(direction, kFar)), scale(direction, -1));
      if (!hit || dot(sub(hit, p), direction) < 0)
        throw new Error(`finderOn: from ${direction.join(', ')} nothing is seen at ${p.join(', ')}`);
      return hit;
    },
    furthest: (direction, p, radius) => {
      let best: Vec3 | undefined;
      for (let v = 0; v < vertexCount(skin); v++) {
        const q = point(skin, v);
        if (length(sub(q, p)) <= radius && (!best || dot(q, direction) > dot(best, direction))) best = q;
      }
      if (!best) throw new Error(`finderOn: no skin within ${radius} of ${p.join(', ')}`);
      return best;
    },
  };
};

/** The spots of the left side, and their mirror images, told apart by their endings. */
export const bothSides = (left: Landmarks): Landmarks =>
  Object.fromEntries(
    Object.entries(left).flatMap(([name, p]) => [
      [`${name}_left`, p],
      [`${name}_right`, mirrorX(p)],
    ]),
  );

/** Spots of the middle, put exactly into the plane of symmetry. */
export const inMiddle = (spots: Landmarks): Landmarks =>
  Object.fromEntries(Object.entries(spots).map(([name, p]) => [name, [0, p[1], p[2]]]));
