import type { GLTF } from '@gltf-transform/core';
import { InputError } from '../../scene/input-error.js';
import { isObject, requireList } from './check-geometry.js';

/**
 * Checks the shape of what a glTF has besides geometry, as far as it is read here: names, animations, materials, instances.
 * @throws {InputError} that names the element.
 */
export function checkRest(json: GLTF.IGLTF): void {
  for (const list of ['nodes', 'meshes', 'materials', 'textures', 'images'] as const)
    json[list]?.forEach(({ name }: { name?: unknown }, i) => {
      if (name !== undefined && typeof name !== 'string') throw new InputError(`${list}[${i}].name is not a string`);
    });
  requireList('animations', json.animations, isObject, 'objects');
  json.animations?.forEach((animation, a) => {
    for (const list of ['channels', 'samplers'] as const)
      requireList(`animations[${a}].${list}`, animation[list], isObject, 'objects');
  });
  json.materials?.forEach(({ pbrMetallicRoughness: pbr }, m) =>
    requireList(
      `materials[${m}].pbrMetallicRoughness.baseColorFactor`,
      pbr?.baseColorFactor,
      Number.isFinite,
      'numbers',
    ),
  );
  json.nodes?.forEach(({ extensions }, n) => objectIn(extensions, `nodes[${n}]`, 'EXT_mesh_gpu_instancing'));
  json.meshes?.forEach(({ primitives }, m) =>
    primitives.forEach(({ mode = 4, extensions }, p) => {
      const name = `meshes[${m}].primitives[${p}]`;
      if (!Number.isInteger(mode)) throw new InputError(`${name}.mode is not a whole number`);
      const variants = objectIn(extensions, name, 'KHR_materials_variants') as { mappings?: unknown } | undefined;
      requireList(`${name}: mappings of KHR_materials_variants`, variants?.mappings, isObject, 'objects');
    }),
  );
}

/** An extension of an element. @throws {InputError} if it is there, but no object. */
function objectIn(extensions: GLTF.IProperty['extensions'], element: string, name: string): object | undefined {
  const found = extensions?.[name];
  if (found !== undefined && !isObject(found)) throw new InputError(`${element}.extensions.${name} is not an object`);
  return found as object | undefined;
}
