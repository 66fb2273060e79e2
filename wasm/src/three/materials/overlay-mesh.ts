import {
  BufferAttribute,
  BufferGeometry,
  InstancedMesh,
  LessEqualDepth,
  type Material,
  Mesh,
  MeshStandardMaterial,
  SkinnedMesh,
} from 'three';
import { isMarked } from '../apply/earlier-overlays.js';
import type { Part } from '../apply/extract-scene.js';
import { isInstanced, isSkinned } from '../apply/flags.js';
import { disown, disposeOwn, own } from '../apply/own-attributes.js';

/** What an overlay has of its base at any time, not only when it was made. */
const kFollowed = [
  'layers',
  'renderOrder',
  'frustumCulled',
  'receiveShadow',
  'morphTargetInfluences',
  'morphTargetDictionary',
  'skeleton',
  'bindMode',
  'bindMatrix',
  'bindMatrixInverse',
  'instanceMatrix',
  'instanceColor',
  'count',
  'morphTexture',
];

/**
 * Added to the render order of an opaque overlay. Three.js draws opaque meshes in the order in which their materials were made, so
 * that the base could come later, and hide it.
 */
const kLater = 1e-4;

/** Makes a class of meshes with the properties of their parent mesh. Copies are such meshes too. */
function following<C extends typeof Mesh | typeof SkinnedMesh | typeof InstancedMesh>(Base: C): C {
  type Fields = Record<string, unknown> & { parent: (Mesh & Record<string, unknown>) | null; ownFields?: Fields };
  // A field that three's constructors set before the mesh has a parent.
  const fieldsOf = (mesh: Fields): Record<string, unknown> => {
    if (!mesh.ownFields) Object.defineProperty(mesh, 'ownFields', { value: {} });
    return mesh.ownFields!;
  };
  const Follower = class extends (Base as typeof Mesh) {
    /** Rays hit the base. */
    override raycast(): void {}
  };
  for (const name of kFollowed) {
    Object.defineProperty(Follower.prototype, name, {
      get(this: Fields) {
        const value = (this.parent ?? fieldsOf(this))[name];
        return name === 'renderOrder' && !(this['material'] as Material).transparent
          ? (value as number) + kLater
          : value;
      },
      set(this: Fields, value: unknown) {
        if (!this.parent) fieldsOf(this)[name] = value;
      },
    });
  }
  Object.defineProperty(Follower.prototype, 'geometry', {
    get(this: Fields) {
      const own = fieldsOf(this);
      const geometry = own['geometry'] as BufferGeometry;
      const base = this.parent?.geometry;
      // Copies share the geometry, so it is not changed, but made anew.
      if (base && geometry.userData['source'] !== base.uuid) own['geometry'] = shareVertices(base, geometry.index!);
      return own['geometry'];
    },
    set(this: Fields, value: unknown) {
      fieldsOf(this)['geometry'] = value;
    },
  });
  return Follower as unknown as C;
}

const Overlay = /* @__PURE__ */ following(Mesh);
const SkinnedOverlay = /* @__PURE__ */ following(SkinnedMesh);
const InstancedOverlay = /* @__PURE__ */ following(InstancedMesh);

/** A geometry with other triangles that shares the vertices and morph targets of a base. */
function shareVertices(base: BufferGeometry, index: BufferAttribute): BufferGeometry {
  const geometry = new BufferGeometry();
  for (const [name, attribute] of Object.entries(base.attributes)) {
    // Its colours would tint the texture.
    if (name === 'color') continue;
    disown(attribute);
    geometry.setAttribute(name, attribute);
  }
  geometry.morphAttributes = base.morphAttributes;
  geometry.morphTargetsRelative = base.morphTargetsRelative;
  geometry.boundingBox = base.boundingBox;
  geometry.boundingSphere = base.boundingSphere;
  geometry.setIndex(own(index));
  geometry.userData['source'] = base.uuid;
  return geometry;
}

/**
 * Makes a mesh of the triangles of a part that may be painted, none at first. It shares the vertices, skin and morphs of the part's
 * mesh, whose child it becomes, and is placed, shown and hidden as that is.
 */
export function makeOverlay(part: Part, base: Mesh, material: Material): Mesh {
  const geometry = shareVertices(base.geometry, new BufferAttribute(new Uint32Array(0), 1));
  const overlay = isInstanced(base)
    ? new InstancedOverlay(geometry, material, 0)
    : isSkinned(base)
      ? new SkinnedOverlay(geometry, material)
      : new Overlay(geometry, material);
  overlay.name = `${part.name} (cosmetic)`;
  overlay.userData['cagecastOverlay'] = true;
  return overlay;
}

/**
 * Makes an overlay draw the triangles of its base for which `cosmetic` is 1; one without any leaves its base.
 * @param indices  The triangles in the order of `cosmetic`, which that of the base's own index may no longer be.
 */
export function showTriangles(overlay: Mesh, base: Mesh, indices: Uint32Array, cosmetic: Uint8Array): void {
  const corners = new Uint32Array(3 * cosmetic.reduce((sum, one) => sum + one, 0));
  let filled = 0;
  for (let i = 0; i < 3 * cosmetic.length; ++i) if (cosmetic[Math.floor(i / 3)] === 1) corners[filled++] = indices[i]!;
  disposeOwn(overlay.geometry);
  overlay.geometry = shareVertices(base.geometry, new BufferAttribute(corners, 1));
  if (filled === 0) overlay.removeFromParent();
  else if (overlay.parent !== base) base.add(overlay);
}

/** Frees what an overlay has of its own, and takes it away, also from copies of the model. */
export function removeOverlay(overlay: Mesh): void {
  const { geometry } = overlay;
  overlay.removeFromParent();
  disposeOwn(geometry);
  Object.assign(geometry, { attributes: {}, morphAttributes: {} });
}

/** Takes away the overlays that earlier transfers have given to a mesh. */
export function removeOverlays(base: Mesh): void {
  for (const child of base.children.filter(isMarked)) {
    child.removeFromParent();
    disposeOwn((child as Mesh).geometry);
  }
}

/** A material for paint on top of one that cannot be painted. */
export function overlayMaterial(base: Material): MeshStandardMaterial {
  const { side, opacity } = base;
  return new MeshStandardMaterial({
    roughness: 0.8,
    side,
    opacity,
    transparent: true,
    depthWrite: false,
    depthFunc: LessEqualDepth,
    polygonOffset: true,
    polygonOffsetFactor: -1,
    polygonOffsetUnits: -1,
  });
}
