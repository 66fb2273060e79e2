import { MaterialPluginBase } from '@babylonjs/core';
import { applySplit, applySplitToSkin, joinParts, paintedVertices, prepareParts } from 'cagecast/engines';

/** The meshes that have vertices of their own, as `joinParts` takes them, where they are in the scene. */
const withVertices = (meshes) => meshes.filter((mesh) => mesh.geometry && !mesh.isAnInstance);
const arraysOf = (mesh) => ({
  positions: mesh.getVerticesData('position'),
  indices: mesh.getIndices(),
  matrix: mesh.computeWorldMatrix(true).asArray(),
});

/**
 * Paints meshes of a scene.
 * @param target   The meshes of a model.
 * @param cage     Those of its cage, in the same space.
 * @param texture  The paint; its `invertY` is false.
 * @param options  As for `prepareParts`.
 * @returns the meshes that show some of it.
 */
export function paintMeshes(target, cage, texture, options) {
  const meshes = withVertices(target);
  const { mesh, parts } = joinParts(meshes.map(arraysOf));
  const outer = joinParts(withVertices(cage).map((one) => ({ ...arraysOf(one), uvs: one.getVerticesData('uv') })));
  const prepared = prepareParts(outer.mesh, mesh, { ...options, ranges: parts });
  prepared.parts.forEach((part, p) => replaceVertices(meshes[p], part));
  const painted = meshes.filter((_, p) => prepared.parts[p].cosmeticTriangles.includes(1));
  for (const { material } of painted)
    (material.pluginManager?.getPlugin('Cagecast') ?? new Paint(material)).texture = texture;
  return painted;
}

const kRules = { normal: 'direction', tangent: 'direction' };

/** Gives a mesh the vertices and triangles of a prepared part. */
function replaceVertices(mesh, part) {
  mesh.makeGeometryUnique();
  const sizes = Object.fromEntries(
    mesh.getVerticesDataKinds().map((kind) => [kind, mesh.getVertexBuffer(kind).getSize()]),
  );
  const before = (kind) => Float32Array.from(mesh.getVerticesData(kind));
  const skin = (kinds) => kinds.filter((kind) => sizes[kind]).map(before);
  const [joints, weights] = ['matricesIndices', 'matricesWeights'].map((kind) => skin([kind, `${kind}Extra`]));
  const bones = applySplitToSkin({ joints, weights }, part);
  const after = Object.entries(sizes).map(([kind, size]) => {
    const set = kind.endsWith('Extra') ? 1 : 0;
    if (kind.startsWith('matricesIndices')) return [kind, bones.joints[set]];
    if (kind.startsWith('matricesWeights')) return [kind, bones.weights[set]];
    return [kind, applySplit(before(kind), size, part, kRules[kind])];
  });
  for (const [kind, values] of after) mesh.setVerticesData(kind, values, false, sizes[kind]);
  // The UV of the paint, and 1 where a painted triangle is: a triangle is painted if all its vertices are.
  const isPainted = paintedVertices(part);
  const uvs = Float32Array.from({ length: 3 * isPainted.length }, (_, i) =>
    i % 3 === 2 ? isPainted[(i - 2) / 3] : part.uvs[2 * Math.floor(i / 3) + (i % 3)],
  );
  mesh.setVerticesData('cagecast', uvs, false, 3);
  mesh.setIndices(part.indices);
  const { morphTargetManager: morphs } = mesh;
  for (let t = 0; t < (morphs?.numTargets ?? 0); ++t) {
    const target = morphs.getTarget(t);
    target.setPositions(applySplit(Float32Array.from(target.getPositions()), 3, part));
    if (target.hasNormals) target.setNormals(applySplit(Float32Array.from(target.getNormals()), 3, part, 'direction'));
    if (target.hasTangents)
      target.setTangents(applySplit(Float32Array.from(target.getTangents()), 3, part, 'direction'));
    if (target.hasUVs) target.setUVs(applySplit(Float32Array.from(target.getUVs()), 2, part));
  }
  morphs?.synchronize();
}

/** Mixes paint into the colour of a `PBRMaterial`, before it is lit. */
class Paint extends MaterialPluginBase {
  constructor(material) {
    super(material, 'Cagecast', 200, { CAGECAST: true }, true, true);
  }
  getClassName() {
    return 'CagecastPaint';
  }
  isReadyForSubMesh() {
    return this.texture.isReady();
  }
  hasTexture(texture) {
    return texture === this.texture;
  }
  getActiveTextures(textures) {
    textures.push(this.texture);
  }
  getSamplers(samplers) {
    samplers.push('cagecastMap');
  }
  getAttributes(attributes) {
    attributes.push('cagecast');
  }
  bindForSubMesh(buffer) {
    buffer.setTexture('cagecastMap', this.texture);
  }
  getCustomCode(type) {
    if (type === 'vertex')
      return {
        CUSTOM_VERTEX_DEFINITIONS: 'attribute vec3 cagecast; varying vec3 vCagecast;',
        CUSTOM_VERTEX_MAIN_END: 'vCagecast = cagecast;',
      };
    return {
      CUSTOM_FRAGMENT_DEFINITIONS: 'uniform sampler2D cagecastMap; varying vec3 vCagecast;',
      CUSTOM_FRAGMENT_UPDATE_ALBEDO: `vec4 paint = texture2D(cagecastMap, vCagecast.xy);
        surfaceAlbedo = mix(surfaceAlbedo, paint.rgb, paint.a * step(0.999, vCagecast.z));`,
    };
  }
}
