import { applySplit, applySplitToSkin, joinParts, paintedVertices, prepareParts } from 'cagecast/engines';
import {
  Mesh,
  Morph,
  MorphInstance,
  MorphTarget,
  PRIMITIVE_TRIANGLES,
  SEMANTIC_ATTR8,
  SHADERLANGUAGE_GLSL,
  ShaderChunks,
  typedArrayTypes,
} from 'playcanvas';

const meshesOf = (entity) => entity.findComponents('render').flatMap(({ meshInstances }) => meshInstances);

/** As `joinParts` takes it, where it is in the scene; with a skin, at rest. */
function arraysOf({ mesh, node, skinInstance }, root) {
  const [positions, indices] = [[], []];
  mesh.getPositions(positions);
  mesh.getIndices(indices);
  return { positions, indices, matrix: (skinInstance ? root : node).getWorldTransform().data };
}

/**
 * Paints the meshes of an entity.
 * @param device   The application's graphics device.
 * @param target   What `instantiateRenderEntity` returned for a model.
 * @param cage     The same for its cage, in the same space.
 * @param texture  The paint, as sRGB.
 * @param options  As for `prepareParts`.
 * @returns the mesh instances that show some of it.
 */
export function paintEntity(device, target, cage, texture, options) {
  const meshes = meshesOf(target);
  const { mesh, parts } = joinParts(meshes.map((one) => arraysOf(one, target)));
  const outer = joinParts(
    meshesOf(cage).map((one) => {
      const uvs = [];
      one.mesh.getUvs(0, uvs);
      return { ...arraysOf(one, cage), uvs };
    }),
  );
  const prepared = prepareParts(outer.mesh, mesh, { ...options, ranges: parts });
  prepared.parts.forEach((part, p) => replaceVertices(device, meshes[p], part));
  const painted = meshes.filter((_, p) => prepared.parts[p].cosmeticTriangles.includes(1));
  for (const material of new Set(painted.map((one) => one.material))) paintMaterial(device, material, texture);
  return painted;
}

const kRules = { NORMAL: 'direction', TANGENT: 'direction' };

/** Gives a mesh instance a mesh with the vertices and triangles of a prepared part. */
function replaceVertices(device, instance, part) {
  const before = instance.mesh;
  const mesh = new Mesh(device);
  const { elements } = before.vertexBuffer.format;
  const streams = elements.map(({ name, numComponents, dataType }) => {
    const values = new typedArrayTypes[dataType](numComponents * before.vertexBuffer.numVertices);
    before.getVertexStream(name, values);
    return [name, values];
  });
  const { BLENDINDICES, BLENDWEIGHT } = Object.fromEntries(streams);
  const skin = BLENDINDICES && applySplitToSkin({ joints: [BLENDINDICES], weights: [BLENDWEIGHT] }, part);
  const bones = { BLENDINDICES: skin?.joints[0], BLENDWEIGHT: skin?.weights[0] };
  streams.forEach(([name, values], e) => {
    const { numComponents, dataType, normalize, asInt } = elements[e];
    const all = bones[name] ?? applySplit(values, numComponents, part, kRules[name]);
    mesh.setVertexStream(name, all, numComponents, part.sources.length, dataType, normalize, asInt);
  });
  // The UV of the paint, and 1 where a painted triangle is: a triangle is painted if all its vertices are.
  const isPainted = paintedVertices(part);
  const uvs = Float32Array.from({ length: 3 * isPainted.length }, (_, i) =>
    i % 3 === 2 ? isPainted[(i - 2) / 3] : part.uvs[2 * Math.floor(i / 3) + (i % 3)],
  );
  mesh.setVertexStream(SEMANTIC_ATTR8, uvs, 3);
  mesh.setIndices(part.indices);
  mesh.update(PRIMITIVE_TRIANGLES, false);
  mesh.aabb = before.aabb;
  mesh.skin = before.skin;
  // Load models with the option `morphPreserveData`, or normals do not follow morph targets.
  const split = (deltas) => deltas && applySplit(Float32Array.from(deltas), 3, part);
  const targets = before.morph?.targets.map(({ name, defaultWeight, deltaPositions, options }) => {
    const deltas = { deltaPositions: split(deltaPositions), deltaNormals: split(options?.deltaNormals) };
    return new MorphTarget({ name, defaultWeight, preserveData: true, ...deltas });
  });
  if (targets) mesh.morph = new Morph(targets, device);
  instance.mesh = mesh;
  if (targets) instance.morphInstance = new MorphInstance(mesh.morph);
}

/** Mixes paint into the colour of a `StandardMaterial`, before it is lit. */
function paintMaterial(device, material, texture) {
  const chunks = material.getShaderChunks(SHADERLANGUAGE_GLSL);
  const diffuse = ShaderChunks.get(device, SHADERLANGUAGE_GLSL).get('diffusePS');
  chunks.set('litUserDeclarationVS', 'attribute vec3 cagecast; varying vec3 vCagecast;');
  chunks.set('litUserMainEndVS', 'vCagecast = cagecast;');
  chunks.set('litUserDeclarationPS', 'uniform sampler2D cagecastMap; varying vec3 vCagecast;');
  chunks.set(
    'diffusePS',
    diffuse.replace(
      /\}\s*$/,
      `vec4 paint = texture2D(cagecastMap, vCagecast.xy);
      dAlbedo = mix(dAlbedo, paint.rgb, paint.a * step(0.999, vCagecast.z));
      }`,
    ),
  );
  material.setAttribute('cagecast', SEMANTIC_ATTR8);
  material.setParameter('cagecastMap', texture);
  material.update();
}
