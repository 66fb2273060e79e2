import { CagecastError, type TransferResult } from 'cagecast';
import { cagecast, cageModel, cageTemplate } from 'cagecast/gltf';
import { fit } from './inspect.ts';
import type { Kind } from './kind.ts';
import { inputFailure, models, readModel } from './model.ts';

/** Paints a target, or gives it the UVs of a cage if there is no texture. For a cage that does not fit it writes nothing. */
export const transferKind: Kind = {
  version: 2,
  inputs: { target: 'required', cage: 'required', texture: 'optional' },
  ending: '.glb',
  async run(inputs, settings) {
    const document = await readModel('target', inputs['target']!);
    const cage = await readModel('cage', inputs['cage']!);
    try {
      const { borders, ...options } = settings;
      const [source, target] = [cageTemplate(cage), await cageModel(document)];
      let result: TransferResult | undefined;
      await document.transform(
        cagecast({ ...settings, cage: source, texture: inputs['texture'], onResult: (one) => (result = one) }),
      );
      const facts = fit(source, target, options, result);
      return facts.verdict === 'unfit' ? { facts } : { facts, output: await (await models()).writeBinary(document) };
    } catch (error) {
      throw error instanceof CagecastError ? inputFailure(error) : error;
    }
  },
};
