import type { GLTF } from '@gltf-transform/core';
import { toonExtension, toonProperties } from './toon.js';

type Expressions = Record<string, { textureTransformBinds?: { material?: number }[] } | undefined>;
interface Avatar {
  VRMC_vrm?: { expressions?: { preset?: Expressions; custom?: Expressions } };
  VRM?: {
    blendShapeMaster?: {
      blendShapeGroups?: { name?: string; materialValues?: { materialName?: string; propertyName?: string }[] }[];
    };
  };
}

/** What moves the textures of a material while it is shown, and what was drawn into them with it; empty for nearly all. */
export function movedBy(json: GLTF.IGLTF, number: number): string[] {
  const { name, extensions } = json.materials![number]!;
  const toon = { ...(extensions?.[toonExtension] as object), ...toonProperties(json, number)?.floatProperties };
  const scrolls = Object.entries(toon).some(
    ([key, speed]) => /^(uvAnimation\w+SpeedFactor|_UvAnim)/.test(key) && speed,
  );
  const { VRMC_vrm: vrm, VRM: old } = (json.extensions ?? {}) as Avatar;
  const { preset, custom } = vrm?.expressions ?? {};
  const expressions = Object.entries({ ...preset, ...custom }).flatMap(([expression, of]) =>
    of?.textureTransformBinds?.some(({ material }) => material === number) ? expression : [],
  );
  const groups = (old?.blendShapeMaster?.blendShapeGroups ?? []).flatMap((group) =>
    group.materialValues?.some((one) => one.materialName === name && /_ST(_[ST])?$/.test(one.propertyName ?? ''))
      ? (group.name ?? '')
      : [],
  );
  const animated = JSON.stringify(json.animations ?? []).includes(`"/materials/${number}/`);
  return [
    ...(scrolls ? ['its UVs scroll or turn'] : []),
    ...[...expressions, ...groups].map((expression) => `the expression "${expression}" moves its textures`),
    ...(animated ? ['an animation changes it'] : []),
  ];
}
