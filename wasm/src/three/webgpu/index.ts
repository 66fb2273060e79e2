/**
 * Paint of `cagecast/three` with the `WebGPURenderer` of three.js r178 or newer: import it once, and nothing else changes.
 *
 * @example
 * import 'cagecast/three/webgpu';
 * import { applyTransfer } from 'cagecast/three';
 *
 * applyTransfer(head, { cage, texture });
 * @module cagecast/three/webgpu
 */
import { Color, type Material, Matrix3, Texture, Vector3 } from 'three';
import {
  attribute,
  diffuseColor,
  float,
  max,
  mix,
  select,
  smoothstep,
  step,
  texture as textureNode,
  uniform,
  vec3,
  vec4,
} from 'three/tsl';
import type { Node } from 'three/webgpu';
import { setNodePainter } from '../index.js';
import type { NodeBuilder, NodePainter, ShownPaint } from '../materials/node-paint.js';
import { paintAttribute } from '../materials/paint-shader.js';

/** What three.js tells of a material that it is about to draw. */
interface Frame {
  material: Material | null;
}

/** MToon of three-vrm for nodes: it has a second colour, for what is in the shade. */
interface Shaded {
  _setupShadeColorNode?(): Node<'vec3'>;
}

/** The paint at a point of the surface: what `cagecastTexel` is in GLSL. */
function texelOf(builder: NodeBuilder, shown: (material: Material) => ShownPaint): Node<'vec4'> {
  const now = ({ material }: Frame): ShownPaint => shown(material!);
  const first = shown(builder.material).texture;
  const none = new Texture();
  // Of type and kind of the first texture, as the shader depends on them.
  const transform = uniform(new Matrix3()).onObjectUpdate((frame) => now(frame).matrix);
  const amounts = new Vector3();
  // Opacity, feather and how to decode, of the last row of the matrix.
  const amount = uniform(amounts).onObjectUpdate((frame) => {
    const { elements } = now(frame).matrix;
    return amounts.set(elements[2]!, elements[5]!, elements[8]!);
  });
  const at = attribute<'vec4'>(paintAttribute, 'vec4');
  const map = textureNode(first ?? none, transform.mul(vec3(at.xy, 1)).xy);
  map.onObjectUpdate((frame: Frame) => now(frame).texture ?? none);
  // Else it would be one with the material's own map where both are one texture, and stay that.
  map.getUniformHash = (one) => map.getHash(one);
  const texel = map.toVar();
  const inside = at.w.sub(2);
  // `smoothstep` of no width is undefined.
  const soft = smoothstep(0, max(amount.y, 1e-9), inside);
  const border = select(amount.y.greaterThan(0), soft, step(-0.5, inside));
  const alpha = texel.a.mul(amount.x).mul(border).mul(step(at.z.abs(), 1e-6));
  const straight = texel.rgb.div(select(amount.z.greaterThan(1.5), max(texel.a, 1e-4), float(1)));
  return vec4(straight, alpha).toVar();
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
    const texel = texelOf(builder, shown);
    if (alone) {
      diffuseColor.assign(vec4(texel.rgb, texel.a.mul(diffuseColor.a)));
      return;
    }
    diffuseColor.rgb.assign(mix(diffuseColor.rgb, texel.rgb, texel.a));
    const shaded = built as Shaded;
    if (!shaded._setupShadeColorNode) return;
    // It is asked for the colour right after this, in the same build.
    shaded._setupShadeColorNode = () => {
      delete shaded._setupShadeColorNode;
      const ratios = new Color();
      const ratio = uniform(ratios).onObjectUpdate(({ material }) => shadeRatio(material!, ratios));
      return mix(shaded._setupShadeColorNode!(), texel.rgb.mul(ratio), texel.a);
    };
  },
};

setNodePainter(painter);
