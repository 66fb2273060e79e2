/**
 * Paint of `cagecast/three` with the `WebGPURenderer` of three.js r178 or newer: import it once, and nothing else changes; for layers and
 * painting, call `enableLayers` once.
 *
 * @example
 * import 'cagecast/three/webgpu';
 * import { applyTransfer } from 'cagecast/three';
 *
 * applyTransfer(head, { cage, texture });
 * @module cagecast/three/webgpu
 */
import { Color, DoubleSide, type Material, Matrix3, Texture, Vector3, WebGLRenderer } from 'three';
import {
  attribute,
  diffuseColor,
  faceDirection,
  float,
  materialEmissive,
  materialMetalness,
  materialRoughness,
  max,
  mix,
  positionView,
  select,
  smoothstep,
  step,
  texture as textureNode,
  uniform,
  vec3,
  vec4,
} from 'three/tsl';
import type { Node } from 'three/webgpu';
import { setNodePainter, setOwnRenderer } from '../internals.js';
import type { NodeBuilder, NodePainter, ShownOn, ShownPaint } from '../materials/node-paint.js';
import { paintAttribute } from '../materials/paint-shader.js';

/** What three.js tells of a material that it is about to draw. */
interface Frame {
  material: Material | null;
}

/** What node materials are given by their owners, if they know it. */
interface Fields {
  roughnessNode?: Node<'float'> | null;
  metalnessNode?: Node<'float'> | null;
  emissiveNode?: Node<'vec3'> | null;
}

/** MToon of three-vrm for nodes: it has a second colour, for what is in the shade. */
interface Shaded {
  _setupShadeColorNode?(): Node<'vec3'>;
}

/** A texture that may be another in each frame. @param first  Of its type and kind, as the shader depends on them. */
function changing(
  first: Texture | null | undefined,
  at: Node<'vec2'>,
  now: (frame: Frame) => Texture | null | undefined,
) {
  const none = new Texture();
  const map = textureNode(first ?? none, at);
  map.onObjectUpdate((frame: Frame) => now(frame) ?? none);
  // Else it would be one with the material's own map where both are one texture, and stay that.
  map.getUniformHash = (one) => map.getHash(one);
  return map;
}

/** Where paint is looked up at a point of the surface, how much of it shows there, and how its texels are stored. */
function placeOf(shown: ShownOn): { uv: Node<'vec2'>; share: Node<'float'>; stored: Node<'float'> } {
  const now = ({ material }: Frame): ShownPaint => shown(material!);
  const transform = uniform(new Matrix3()).onObjectUpdate((frame) => now(frame).matrix);
  const amounts = new Vector3();
  // Opacity, feather and how to decode, of the last row of the matrix.
  const amount = uniform(amounts).onObjectUpdate((frame) => {
    const { elements } = now(frame).matrix;
    return amounts.set(elements[2]!, elements[5]!, elements[8]!);
  });
  const at = attribute<'vec4'>(paintAttribute, 'vec4');
  const inside = at.w.sub(2);
  // `smoothstep` of no width is undefined.
  const soft = smoothstep(0, max(amount.y, 1e-9), inside);
  const border = select(amount.y.greaterThan(0), soft, step(-0.5, inside));
  const share = amount.x.mul(border).mul(step(at.z.abs(), 1e-6));
  return { uv: transform.mul(vec3(at.xy, 1)).xy, share, stored: amount.z };
}

/** The paint at a point of the surface: what `cagecastTexel` is in GLSL. */
function texelOf(
  { uv, share, stored }: ReturnType<typeof placeOf>,
  builder: NodeBuilder,
  shown: ShownOn,
): Node<'vec4'> {
  const texel = changing(shown(builder.material).texture, uv, ({ material }) => shown(material!).texture).toVar();
  const straight = texel.rgb.div(select(stored.greaterThan(1.5), max(texel.a, 1e-4), float(1)));
  return vec4(straight, texel.a.mul(share)).toVar();
}

/** A channel of the paint, as far as it shows; undefined if the paint, or the mesh, has none. */
function channelOf(kind: 'surface' | 'glow' | 'normals', builder: NodeBuilder, shown: ShownOn) {
  const first = shown(builder.material).channels[kind];
  if (!first || !builder.geometry.hasAttribute(paintAttribute)) return undefined;
  const { uv, share } = placeOf(shown);
  return { texel: changing(first, uv, ({ material }) => shown(material!).channels[kind]), uv, share };
}

/** What the model's own colour is multiplied by: what `cagecastBase` is in GLSL. */
function tintOf(share: Node<'float'>, shown: ShownOn): Node<'vec3'> {
  const white = new Color();
  const tint = uniform(new Color()).onObjectUpdate(({ material }) => shown(material!).channels.tint ?? white);
  return mix(vec3(1), tint, share).toVar();
}

/** How much darker a MToon material is in the shade than in the light. */
function shadeRatio(material: Material, ratio: Color): Color {
  const { shadeColorFactor, color } = material as unknown as { shadeColorFactor?: Color; color?: Color };
  if (!shadeColorFactor || !color) return ratio.setScalar(1);
  const of = (shade: number, lit: number) => Math.min(shade / Math.max(lit, 1e-3), 1);
  const { r, g, b } = shadeColorFactor;
  return ratio.setRGB(of(r, color.r), of(g, color.g), of(b, color.b));
}

const painter: NodePainter = {
  addPaint(built, builder, shown, alone) {
    // Another mesh with the material: no paint.
    if (!builder.geometry.hasAttribute(paintAttribute)) return;
    const place = placeOf(shown);
    const texel = texelOf(place, builder, shown);
    if (alone) {
      diffuseColor.assign(vec4(texel.rgb, texel.a.mul(diffuseColor.a)));
      return;
    }
    const base = shown(builder.material).channels.tint && tintOf(place.share, shown);
    const tinted = (color: Node<'vec3'>): Node<'vec3'> => (base ? color.mul(base) : color);
    diffuseColor.rgb.assign(mix(tinted(diffuseColor.rgb), texel.rgb, texel.a));
    const shaded = built as Shaded;
    if (!shaded._setupShadeColorNode) return;
    // It is asked for the colour right after this, in the same build.
    shaded._setupShadeColorNode = () => {
      delete shaded._setupShadeColorNode;
      const ratios = new Color();
      const ratio = uniform(ratios).onObjectUpdate(({ material }) => shadeRatio(material!, ratios));
      return mix(tinted(shaded._setupShadeColorNode!()), texel.rgb.mul(ratio), texel.a);
    };
  },

  surface(built, builder, shown) {
    const { roughnessNode, metalnessNode } = built as Fields;
    const found = roughnessNode === undefined ? undefined : channelOf('surface', builder, shown);
    if (!found) return {};
    const texel = found.texel.mul(found.share).toVar();
    const rough = roughnessNode ? float(roughnessNode) : materialRoughness;
    const metal = metalnessNode ? float(metalnessNode) : materialMetalness;
    return {
      roughnessNode: rough.mul(texel.g.oneMinus()).add(texel.r),
      metalnessNode: metal.mul(texel.a.oneMinus()).add(texel.b),
    };
  },

  glow(built, builder, shown) {
    const { emissiveNode } = built as Fields;
    const { emissive } = builder.material as { emissive?: Color };
    const found = emissiveNode || emissive?.isColor ? channelOf('glow', builder, shown) : undefined;
    if (!found) return {};
    const strength = uniform(1).onObjectUpdate(({ material }) => shown(material!).channels.strength);
    const own = emissiveNode ? vec3(emissiveNode) : materialEmissive;
    return { emissiveNode: own.add(found.texel.rgb.mul(strength).mul(found.share)) };
  },

  relief(before, builder, shown) {
    const isUnlit = 'isMeshBasicMaterial' in builder.material;
    const found = isUnlit ? undefined : channelOf('normals', builder, shown);
    if (!found) return before;
    // Not as a variable, which would be set outside of what is built as a normal.
    const normal = before as Node<'vec3'>;
    const { uv, share } = found;
    const tilt = found.texel.xy.mul(255).sub(128).div(127).mul(share);
    const acrossY = positionView.dFdy().cross(normal);
    const acrossX = normal.cross(positionView.dFdx());
    const [uvX, uvY] = [uv.dFdx(), uv.dFdy()];
    const tangent = acrossY.mul(uvX.x).add(acrossX.mul(uvY.x));
    const bitangent = acrossY.mul(uvX.y).add(acrossX.mul(uvY.y));
    const most = max(tangent.dot(tangent), bitangent.dot(bitangent));
    const length = select(most.equal(0), float(0), most.inverseSqrt());
    const scale = builder.material.side === DoubleSide ? length.mul(faceDirection) : length;
    const up = max(float(1).sub(tilt.dot(tilt)), 0).sqrt();
    return tangent.mul(tilt.x).add(bitangent.mul(tilt.y)).mul(scale).add(normal.mul(up)).normalize();
  },
};

setNodePainter(painter);

/**
 * Lets `createLayers` and `createPainter` take a `WebGPURenderer`: a `WebGLRenderer` of their own draws the layers. Pages that do not call it
 * carry none.
 *
 * @example
 * import { enableLayers } from 'cagecast/three/webgpu';
 * import { createPainter } from 'cagecast/three';
 *
 * enableLayers();
 * const painter = createPainter({ renderer: webgpuRenderer, texture, applied, cage });
 */
export function enableLayers(): void {
  setOwnRenderer((canvas) => new WebGLRenderer({ canvas, antialias: false, depth: false }));
}
