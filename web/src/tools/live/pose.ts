import { Box3, BufferAttribute, type BufferGeometry, Matrix3, type Matrix4, Vector3 } from 'three';
import { type Deform, deform, type Extent } from '../../state/deform';
import type { ExtractedMesh, Primitive } from '../../state/model';
import { morphNames, type Weights } from './morph-names';

const kStep = 1e-3; // of half the height: distance of the finite differences that turn a normal

/** A shape of a model: it is morphed, then deformed. */
export interface Shape {
  how: Deform;
  /** From −1 to 1; 0 leaves it as it is. */
  amount: number;
  extent: Extent;
  /** Undefined leaves the morphs to the file or the animation. */
  morphs: Weights | undefined;
}

/** Whether it is the rest shape. */
export const isAtRest = ({ amount, morphs }: Shape): boolean => amount === 0 && !morphs;

/** Moves the vertices of a model, both in the arrays for the transfer and in the displayed meshes, and restores them. */
export class Pose {
  readonly #mesh: ExtractedMesh;
  readonly #rest: Float32Array;
  readonly #primitives: PrimitivePose[];

  constructor(mesh: ExtractedMesh) {
    this.#mesh = mesh;
    this.#rest = mesh.rest ??= mesh.positions.slice();
    this.#primitives = mesh.primitives.map((primitive) => new PrimitivePose(primitive));
  }

  /** The extent of the model at rest. */
  get extent(): Extent {
    const box = new Box3().setFromArray(this.#rest);
    return { center: box.getCenter(new Vector3()), half: Math.max(0.5 * (box.max.y - box.min.y), Number.MIN_VALUE) };
  }

  /** Computes the positions of a shape. @returns 3 per vertex, in the scene's space. */
  positions(shape: Shape): Float32Array {
    const moved = this.#rest.slice();
    if (isAtRest(shape)) return moved; // exactly
    if (shape.morphs) for (const primitive of this.#primitives) primitive.morph(moved, shape.morphs);
    if (shape.amount === 0) return moved;
    const point = new Vector3();
    for (let at = 0; at < moved.length; at += 3) {
      point.fromArray(moved, at);
      deform(point, shape.how, shape.amount, shape.extent);
      point.toArray(moved, at);
    }
    return moved;
  }

  /** Moves the vertices. */
  set(positions: Float32Array, shape: Shape): void {
    this.#mesh.positions.set(positions);
    for (const primitive of this.#primitives) primitive.set(positions, shape);
  }
}

type Name = 'position' | 'normal';

/** One mesh of a model, with its vertices at rest. */
class PrimitivePose {
  readonly #primitive: Primitive;
  readonly #inverse: Matrix4;
  readonly #linear: Matrix3;
  readonly #toWorld: Matrix3;
  readonly #toLocal: Matrix3;
  readonly #atRest: { name: Name; attribute: BufferAttribute }[];
  readonly #morphs: BufferGeometry['morphAttributes'];
  #moved = false;

  constructor(primitive: Primitive) {
    this.#primitive = primitive;
    const { matrix } = primitive;
    this.#inverse = matrix.clone().invert();
    this.#linear = new Matrix3().setFromMatrix4(matrix);
    this.#toWorld = new Matrix3().getNormalMatrix(matrix);
    this.#toLocal = this.#linear.clone().transpose();
    const { attributes, morphAttributes } = primitive.mesh.geometry;
    this.#atRest = (['position', 'normal'] as const).flatMap((name) => {
      const attribute = attributes[name] as BufferAttribute | undefined;
      return attribute ? [{ name, attribute }] : [];
    });
    this.#morphs = morphAttributes;
  }

  /** Moves the mesh's vertices from the file's morphs to others. @param positions Of the whole model, in the scene's space. */
  morph(positions: Float32Array, morphs: Weights): void {
    const { firstVertex, vertexCount, weights } = this.#primitive;
    const [change, delta] = [new Vector3(), new Vector3()];
    const active = this.#active('position', (name, place) => (morphs.get(name) ?? 0) - (weights[place] ?? 0));
    if (active.length === 0) return;
    for (let vertex = 0; vertex < vertexCount; vertex++) {
      change.set(0, 0, 0);
      for (const { weight, attribute } of active)
        change.addScaledVector(delta.fromBufferAttribute(attribute, vertex), weight);
      change.applyMatrix3(this.#linear);
      const at = 3 * (firstVertex + vertex);
      for (let k = 0; k < 3; k++) positions[at + k]! += change.getComponent(k);
    }
  }

  /** The morphs of non-zero weight; their attributes are offsets, as in glTF. */
  #active(
    name: Name,
    weightOf: (morph: string, place: number) => number,
  ): { weight: number; attribute: BufferAttribute }[] {
    return morphNames(this.#primitive.mesh).flatMap((morph, place) => {
      const [weight, attribute] = [weightOf(morph, place), this.#morphs[name]?.[place]];
      return weight !== 0 && attribute ? [{ weight, attribute: attribute as BufferAttribute }] : [];
    });
  }

  set(positions: Float32Array, shape: Shape): void {
    const { geometry } = this.#primitive.mesh;
    // The vertices include chosen morphs already: do not let the renderer add them again.
    geometry.morphAttributes = shape.morphs ? {} : this.#morphs;
    if (isAtRest(shape)) {
      if (this.#moved) for (const { name, attribute } of this.#atRest) geometry.setAttribute(name, attribute);
      this.#moved = false;
    } else {
      for (const { name, attribute } of this.#atRest) this.#write(name, attribute, positions, shape);
      this.#moved = true;
    }
    geometry.boundingBox = geometry.boundingSphere = null;
  }

  #write(name: Name, rest: BufferAttribute, positions: Float32Array, shape: Shape): void {
    const { mesh, firstVertex, vertexCount, weights } = this.#primitive;
    // Quantised or interleaved attributes cannot hold moved vertices: use a float copy.
    if (!this.#moved) mesh.geometry.setAttribute(name, new BufferAttribute(new Float32Array(3 * vertexCount), 3));
    const attribute = mesh.geometry.getAttribute(name) as BufferAttribute;
    const active = this.#active(name, (morph, place) => {
      if (name === 'normal') return shape.morphs?.get(morph) ?? 0;
      // The renderer adds those of the file, which the positions include.
      return shape.morphs ? 0 : -(weights[place] ?? 0);
    });
    const [vector, delta] = [new Vector3(), new Vector3()];
    for (let vertex = 0; vertex < vertexCount; vertex++) {
      if (name === 'position') vector.fromArray(positions, 3 * (firstVertex + vertex)).applyMatrix4(this.#inverse);
      else vector.fromBufferAttribute(rest, vertex);
      for (const { weight, attribute } of active)
        vector.addScaledVector(delta.fromBufferAttribute(attribute, vertex), weight);
      if (name === 'normal') {
        if (shape.amount === 0) vector.normalize();
        else this.#turnNormal(vector, vertex, shape);
      }
      attribute.setXYZ(vertex, vector.x, vector.y, vector.z);
    }
    attribute.needsUpdate = true;
  }

  /** Rotates a normal with the surface, by finite differences: two nearby points are deformed as well. */
  #turnNormal(normal: Vector3, vertex: number, { how, amount, extent }: Shape): void {
    const { attribute } = this.#atRest[0]!;
    const point = new Vector3().fromBufferAttribute(attribute, vertex).applyMatrix4(this.#primitive.matrix);
    const n = normal.applyMatrix3(this.#toWorld).normalize();
    const across = Math.abs(n.x) < 0.9 ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
    const right = across.cross(n).normalize();
    const up = new Vector3().crossVectors(n, right);
    const step = kStep * extent.half;
    const [a, b] = [right, up].map((direction) => point.clone().addScaledVector(direction, step)) as [Vector3, Vector3];
    for (const one of [point, a, b]) deform(one, how, amount, extent);
    normal.crossVectors(a.sub(point), b.sub(point)).applyMatrix3(this.#toLocal).normalize();
  }
}
