import {
  Color,
  DoubleSide,
  GreaterDepth,
  LessEqualDepth,
  type Material,
  MeshBasicMaterial,
  MeshStandardMaterial,
} from 'three';

/** Colour of cosmetic triangles in the view “Zones”: the paint itself could be mistaken for a zone. */
const kClayColor = '#9aa7b3';

const kMapShader = /* glsl */ `
  vec4 texel = texture2D( map, vMapUv );
  diffuseColor *= vec4( texel.rgb / max( texel.a, 1e-4 ), texel.a );
`;

/** The material of cosmetic triangles in the view “Zones”. */
export function clayMaterial(): Material {
  return onSurface(new MeshStandardMaterial({ color: kClayColor, roughness: 0.85 }));
}

/** The material of paint: it keeps the surface's roughness and relief, but not its colour and emission. */
export function paintMaterial(base: Material): MeshStandardMaterial {
  const paint =
    base instanceof MeshStandardMaterial
      ? new MeshStandardMaterial().copy(base)
      : new MeshStandardMaterial({ roughness: 0.7 });
  paint.color = new Color('white');
  paint.emissive = new Color('black');
  paint.emissiveMap = paint.alphaMap = paint.lightMap = null;
  paint.vertexColors = false;
  paint.metalness = 0;
  paint.metalnessMap = null;
  paint.alphaTest = 0;
  paint.opacity = 1;
  // The texture is premultiplied, so that transparent texels add no colour when filtered: divide by alpha here.
  paint.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace('#include <map_fragment>', kMapShader);
  };
  return onSurface(paint);
}

// Partly emissive, so that colours match the legend both in light and in shade.
const kLit = 0.6;
const kGlow = 0.3;

/** The material of an excluded zone. */
export function zoneMaterial(color: string): Material {
  const lit = { color: new Color(color).multiplyScalar(kLit), emissive: color, emissiveIntensity: kGlow, roughness: 1 };
  return onSurface(new MeshStandardMaterial({ ...lit, side: DoubleSide }));
}

/** The same with vertex colours. */
export function colorMaterial(): Material {
  const material = onSurface(
    new MeshStandardMaterial({
      vertexColors: true,
      color: new Color().setScalar(kLit),
      roughness: 1,
      side: DoubleSide,
    }),
  );
  material.onBeforeCompile = (shader) => {
    const glow = '#include <emissivemap_fragment>';
    shader.fragmentShader = shader.fragmentShader.replace(
      glow,
      `${glow}\ntotalEmissiveRadiance += vColor.rgb * ${kGlow};`,
    );
  };
  return material;
}

/** The material of an excluded zone behind other surfaces. */
export function hiddenMaterial(color: string): Material {
  const material = onSurface(new MeshBasicMaterial({ color, opacity: 0.28, side: DoubleSide }));
  material.depthFunc = GreaterDepth;
  material.polygonOffset = false;
  return material;
}

/** Makes a material draw on top of the surface that shares its vertices. */
export function onSurface<M extends Material>(material: M): M {
  material.transparent = true;
  material.depthWrite = false;
  // Nothing to sort on a surface: draw both sides in one pass; transparent materials get two by default.
  material.forceSinglePass = true;
  material.depthFunc = LessEqualDepth;
  material.polygonOffset = true;
  material.polygonOffsetFactor = -1;
  material.polygonOffsetUnits = -1;
  return material;
}
