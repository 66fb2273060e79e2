import { callCore } from '../core/engine.js';
import { checkMesh, type Mesh } from './mesh.js';
import { checkOptions, type ProjectOptions, type TransferOptions } from './options.js';
import type { Projection, TransferResult } from './result.js';
import { checkReuse, handOver, type Reuse } from './reuse.js';

/**
 * Transfers the cage's UVs to the target and finds its Non-Cosmetic Zones, the vertices that must not be painted.
 *
 * @param cage     The mesh that the texture was drawn for; it must have UVs.
 * @param target   The mesh that receives the texture, in the same space and unit.
 * @param options  With `reuse`, an earlier result is overwritten and returned.
 * @throws {CagecastError} if a mesh or an option cannot be used, `weldToleranceTooLarge`, and `outOfMemory`.
 *
 * @example
 * await init();
 * const result = transfer(cage, target, { threshold: 0.5 });
 * // The target moves: for every frame
 * transfer(cage, target, { threshold: 0.5, reuse: result });
 */
export function transfer(cage: Mesh, target: Mesh, options?: TransferOptions & Reuse<TransferResult>): TransferResult {
  const { core, overrides } = checkOptions('transfer', options, undefined, target?.names);
  const arrays = checkReuse('transfer', options?.reuse);
  const [cageMesh, targetMesh] = [checkMesh('transfer', 'cage', cage), checkMesh('transfer', 'target', target)];
  const result = callCore(
    'transfer',
    ({ workspace }) => workspace.transfer(cageMesh, targetMesh, core, overrides),
    arrays,
  );
  return handOver(result, options?.reuse);
}

/**
 * Does the costly part of `transfer`: steps 1 to 4, 6, 7, 9, 10, 12 and 13 of the method. The result does not depend on threshold,
 * floor, locks, or which parts are kept or excluded. Pass it to `classify`, once for each threshold that you want to try.
 * @param options  With `reuse`, an earlier projection is overwritten and returned.
 * @throws {CagecastError} as `transfer` does.
 */
export function project(cage: Mesh, target: Mesh, options?: ProjectOptions & Reuse<Projection>): Projection {
  const { core, preset, overrides } = checkOptions('project', options, undefined, target?.names);
  const arrays = checkReuse('project', options?.reuse);
  const [cageMesh, targetMesh] = [checkMesh('project', 'cage', cage), checkMesh('project', 'target', target)];
  const result = callCore(
    'project',
    ({ workspace }) => workspace.project(cageMesh, targetMesh, core, overrides),
    arrays,
  );
  return handOver({ ...result, preset }, options?.reuse);
}
