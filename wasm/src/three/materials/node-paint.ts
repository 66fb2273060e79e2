import type { Material, Matrix3, Texture } from 'three';
import { type Channels, noChannels } from './channels.js';
import { kNoPaint } from './paint-shader.js';

/** Where a material is being made for `WebGPURenderer`, as far as it is used here. */
export interface NodeBuilder {
  /** As the mesh has it; what is built may be a copy of another class. */
  material: Material;
  geometry: { hasAttribute(name: string): boolean };
}

/** The methods by which a material is built for `WebGPURenderer`, which copies them from other materials, too. */
export interface NodeHooks {
  setupDiffuseColor(this: NodeHooks, builder: NodeBuilder): void;
  setupVariants(this: NodeHooks, builder: NodeBuilder): void;
  setupNormal(this: NodeHooks, builder: NodeBuilder): unknown;
  setupLighting(this: NodeHooks, builder: NodeBuilder): unknown;
  setupObserver(this: NodeHooks, builder: NodeBuilder): { hasNode: boolean };
}

/** What a material shows of a paint: the matrix is that of `PaintUniforms`. */
export interface ShownPaint {
  texture: Texture | null;
  matrix: Matrix3;
  channels: Channels;
}

/** What a material shows in the frame that is drawn. */
export type ShownOn = (material: Material) => ShownPaint;

/** What adds paint to the colour of a surface while a material is built. `cagecast/three/webgpu` has it, which needs `three/tsl`. */
export interface NodePainter {
  /**
   * @param built  What is built, whose colour is known and not lit yet.
   * @param shown  What a material shows in the frame that is drawn.
   * @param alone  Whether the paint is all that the material shows.
   */
  addPaint(built: object, builder: NodeBuilder, shown: ShownOn, alone: boolean): void;
  /** The fields of `built` with which the paint's roughness and metalness are seen. */
  surface(built: object, builder: NodeBuilder, shown: ShownOn): object;
  /** Those with which its glow is seen. */
  glow(built: object, builder: NodeBuilder, shown: ShownOn): object;
  /** The normals with its relief. @param normal  Those without. */
  relief(normal: unknown, builder: NodeBuilder, shown: ShownOn): unknown;
}

let painter: NodePainter | undefined;
let isTold = false;

/** For `cagecast/three/webgpu`. @internal */
export function setNodePainter(one: NodePainter): void {
  painter = one;
}

type NodeMaterialLike = Material & Partial<NodeHooks> & Record<string, unknown>;

/** Whether a material is one of `three/webgpu` that lets its colour be changed where it is lit. */
export function canBeNodePainted(material: Material): boolean {
  const node = material as NodeMaterialLike;
  const draws = node['fragmentNode'] === null && node['isNodeMaterialInstance'] !== true;
  return painter !== undefined && draws && typeof node.setupDiffuseColor === 'function';
}

/** Node materials that cannot be painted without `cagecast/three/webgpu`. */
export const needsNodePainter = (material: object | undefined): boolean =>
  painter === undefined && (material as { isNodeMaterial?: true } | undefined)?.isNodeMaterial === true;

/**
 * The methods that show paint with `WebGPURenderer`. It calls them where it builds a material, so without its entry they say what is
 * missing; other renderers know no such methods.
 * @param own    What the material had of its own of them.
 * @param shown  What a material shows; undefined once it is not painted any more.
 */
export function nodeHooks(
  own: Partial<NodeHooks>,
  shown: (material: Material) => ShownPaint | undefined,
  alone: boolean,
): NodeHooks {
  const before = <Name extends keyof NodeHooks>(built: NodeHooks, name: Name): NodeHooks[Name] =>
    own[name] ?? (Object.getPrototypeOf(built) as NodeHooks)[name];
  const none: ShownPaint = { texture: null, matrix: kNoPaint, channels: noChannels };
  const now: ShownOn = (material) => shown(material) ?? none;
  /** Runs a step of building with other fields. */
  const withFields = <Result>(built: NodeHooks, fields: object | undefined, run: () => Result): Result => {
    const before = Object.fromEntries(Object.keys(fields ?? {}).map((key) => [key, built[key as keyof NodeHooks]]));
    try {
      Object.assign(built, fields);
      return run();
    } finally {
      Object.assign(built, before);
    }
  };
  return {
    setupDiffuseColor(builder) {
      before(this, 'setupDiffuseColor').call(this, builder);
      if (!shown(builder.material)) return;
      if (painter) painter.addPaint(this, builder, now, alone);
      else tellOnce();
    },
    setupVariants(builder) {
      const fields = painter?.surface(this, builder, now);
      withFields(this, fields, () => before(this, 'setupVariants').call(this, builder));
    },
    setupNormal(builder) {
      const normal = before(this, 'setupNormal').call(this, builder);
      return painter ? painter.relief(normal, builder, now) : normal;
    },
    setupLighting(builder) {
      const fields = painter?.glow(this, builder, now);
      return withFields(this, fields, () => before(this, 'setupLighting').call(this, builder));
    },
    setupObserver(builder) {
      const observer = before(this, 'setupObserver').call(this, builder);
      // Else uniforms that it does not know are not brought up to date.
      observer.hasNode = true;
      return observer;
    },
  };
}

function tellOnce(): void {
  if (isTold) return;
  isTold = true;
  console.warn('cagecast/three: WebGPURenderer shows paint once the page imports cagecast/three/webgpu');
}
