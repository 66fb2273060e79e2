import {
  BufferAttribute,
  BufferGeometry,
  LessEqualDepth,
  type Material,
  Mesh,
  MeshStandardMaterial,
  SkinnedMesh,
  type Texture,
} from 'three';
import { isSkinned, overlayMark, type Part } from './extract.js';

/**
 * Makes a mesh of the triangles of a part that may be painted. It shares the vertices, skin and morphs of the part's mesh
 * and is a child of it, so that it moves, bends and morphs with it.
 */
export function makeOverlay(part: Part, base: Mesh, uvName: string, material: Material): Mesh {
  const { geometry: source } = part;
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(source.attributes)) {
    // Its colours would tint the texture.
    if (name !== 'color') geometry.setAttribute(name, attribute);
  }
  geometry.setAttribute(uvName, source.getAttribute(uvName));
  geometry.morphAttributes = source.morphAttributes;
  geometry.morphTargetsRelative = source.morphTargetsRelative;
  geometry.boundingBox = source.boundingBox;
  geometry.boundingSphere = source.boundingSphere;

  let overlay: Mesh;
  if (isSkinned(base)) {
    const skinned = new SkinnedMesh(geometry, material);
    skinned.bindMode = base.bindMode;
    skinned.bind(base.skeleton, base.bindMatrix);
    overlay = skinned;
  } else {
    overlay = new Mesh(geometry, material);
  }
  if (base.morphTargetInfluences) {
    // The same array, not a copy: it follows every change.
    overlay.morphTargetInfluences = base.morphTargetInfluences;
    overlay.morphTargetDictionary = base.morphTargetDictionary;
  }
  overlay.name = `${part.name} (cosmetic)`;
  overlay.userData[overlayMark] = true;
  overlay.frustumCulled = base.frustumCulled;
  overlay.renderOrder = base.renderOrder + 1;
  overlay.receiveShadow = base.receiveShadow;
  overlay.layers.mask = base.layers.mask;
  // Rays already hit the mesh below.
  overlay.raycast = () => {};
  return overlay;
}

/** Makes an overlay draw the triangles of its part for which `cosmetic` is 1. */
export function showTriangles({ geometry }: Mesh, { geometry: { index } }: Part, cosmetic: Uint8Array): void {
  const corners = new Uint32Array(3 * cosmetic.reduce((sum, one) => sum + one, 0));
  let filled = 0;
  for (let i = 0; i < 3 * cosmetic.length; ++i)
    if (cosmetic[Math.floor(i / 3)] === 1) corners[filled++] = index ? index.getX(i) : i;
  geometry.setIndex(new BufferAttribute(corners, 1));
}

/** A material that shows a texture, with the gloss and relief of the material below it. */
export function paintMaterial(base: Material | undefined, texture: Texture): MeshStandardMaterial {
  const material = new MeshStandardMaterial({ roughness: 0.8 });
  if ((base as MeshStandardMaterial | undefined)?.isMeshStandardMaterial) {
    const { roughness, roughnessMap, normalMap, normalMapType, normalScale, bumpMap, bumpScale } =
      base as MeshStandardMaterial;
    material.setValues({ roughness, roughnessMap, normalMap, normalMapType, bumpMap, bumpScale });
    material.normalScale.copy(normalScale);
  }
  if (base) material.side = base.side;
  material.map = texture;
  return material;
}

/** Makes a material draw on top of a surface with the same vertices. */
export function layOnSurface(material: Material): void {
  material.transparent = true;
  material.depthWrite = false;
  material.depthFunc = LessEqualDepth;
  material.polygonOffset = true;
  material.polygonOffsetFactor = -1;
  material.polygonOffsetUnits = -1;
}
