import { CagecastError, init, inspect, type Mesh, transfer } from 'cagecast';
import type { CageModel } from 'cagecast/cages';
import { cageModel, cageTemplate } from 'cagecast/gltf';
import type { Facts, Kind } from './kind.ts';
import { inputFailure, readModel } from './model.ts';

/** Whether a cage fits a target. Writes no file. */
export const inspectKind: Kind = {
  version: 2,
  inputs: { target: 'required', cage: 'required' },
  async run(inputs, settings) {
    const target = await readModel('target', inputs['target']!);
    const cage = await readModel('cage', inputs['cage']!);
    await init();
    try {
      return { facts: fit(cageTemplate(cage), await cageModel(target), settings) };
    } catch (error) {
      throw error instanceof CagecastError ? inputFailure(error) : error;
    }
  },
};

/**
 * The verdict on a cage.
 * @param result  That of `transfer` for the same meshes and settings, if it is there already.
 */
export function fit(cage: Mesh, target: CageModel, settings: object, result = transfer(cage, target, settings)): Facts {
  const { verdict, findings } = inspect(cage, target, { ...settings, result });
  const { cosmeticTriangles } = result;
  return {
    verdict,
    findings: findings.map(({ code }) => code),
    severity: findings[0] ? Number(findings[0].weight.toFixed(3)) : 0,
    painted: Number((cosmeticTriangles.filter(Boolean).length / cosmeticTriangles.length).toFixed(4)),
    ...(verdict === 'unfit' && { why: findings[0]!.sentence }),
  };
}
