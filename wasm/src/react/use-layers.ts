import { useFrame, useThree } from '@react-three/fiber';
import { useEffect, useState } from 'react';
import type { Texture } from 'three';
import type { LoadedCage } from '../three/index.js';
import { createLayers, type Layer, type Layers, type LayersOptions, type NewLayer } from '../three/internals.js';

/** A layer of a list: its texture, and how it is blended. */
export interface LayerItem extends Omit<NewLayer, 'place' | 'undoable'> {
  texture: Texture;
}

/** Options of `useLayers`: those of `createLayers`, with the renderer of the canvas. */
export interface UseLayersOptions extends Omit<LayersOptions, 'renderer'> {
  /** By what the model's own colour is multiplied beneath all layers, #rrggbb. Default: that of the stack, white at first. */
  baseTint?: string | undefined;
}

/**
 * A stack of layers for models of the canvas, which is drawn before each frame where it has changed, also with `frameloop="demand"`.
 * @param items    The layers, from the lowest to the uppermost, as they are now: one that has changed since is changed, without a step of
 * the undo history. What is painted lies above them. After `layers.load` only textures that are new here are added.
 * @param options  `cage`, for layers within one of its regions, and `size`; another cage or size makes another stack. And `baseTint`.
 * @returns undefined the first time, and afterwards the stack, until the component leaves.
 * @throws {CagecastError} as `createLayers`, and `add` of `Layers`.
 *
 * @example
 * const layers = useLayers([{ texture: stripes }, { texture: cheeks, blend: 'multiply', opacity }]);
 * const { applied } = useCagecast(gltf, { template: 'human-head', layers });
 */
export function useLayers(
  items: readonly LayerItem[] = [],
  { cage, size, baseTint }: UseLayersOptions = {},
): Layers | undefined {
  const layers = useOwnLayers(items, cage, size);
  useEffect(() => {
    if (baseTint !== undefined) layers?.setBaseTint(baseTint, kSilent);
  }, [layers, baseTint]);
  return layers;
}

/** As `useLayers`; without items there is no stack. */
export function useOwnLayers(
  items: readonly LayerItem[] | undefined,
  cage: LoadedCage | undefined,
  size: LayersOptions['size'],
): Layers | undefined {
  const { gl, invalidate } = useThree();
  const [layers, setLayers] = useState<Layers>();
  const isWanted = items !== undefined;
  useEffect(() => {
    if (!isWanted) return undefined;
    const made = createLayers({ renderer: gl, cage, size });
    const unfollow = made.on('change', () => invalidate());
    setLayers(made);
    return () => {
      unfollow();
      made.dispose();
      setLayers(undefined);
    };
  }, [isWanted, gl, cage, size, invalidate]);
  useEffect(() => {
    if (layers && items) follow(layers, items);
  });
  useFrame(() => void layers?.update());
  return layers;
}

/** The layers that were made of the items of a list. */
const followed = new WeakMap<Layers, readonly Followed[]>();

interface Followed {
  id: Layer['id'];
  item: LayerItem;
}

const kSilent = { undoable: false } as const;

/** Makes the layers of a list what it says by now. */
function follow(layers: Layers, items: readonly LayerItem[]): void {
  const before = [...(followed.get(layers) ?? [])];
  const has = ({ id }: Followed): boolean => layers.list.some((layer) => layer.id === id);
  const now = items.map((item): { item: LayerItem; was: Followed | undefined } => {
    const at = before.findIndex((one) => one.item.texture === item.texture && one.item.name === item.name);
    return { item, was: at < 0 ? undefined : before.splice(at, 1)[0] };
  });
  for (const gone of before.filter(has)) layers.remove(gone, kSilent);
  let place = 0;
  const made = now.map(({ item, was }) => {
    const { texture, ...style } = item;
    if (!was) return { item, id: layers.add(texture, { ...style, place: place++, ...kSilent }).id };
    if (has(was)) {
      const changed = Object.entries(style).filter(([name, value]) => was.item[name as keyof LayerItem] !== value);
      if (changed.length > 0) layers.set(was, Object.fromEntries(changed), kSilent);
      if (layers.list[place]?.id !== was.id) layers.move(was, place, kSilent);
      ++place;
    }
    return { item, id: was.id };
  });
  followed.set(layers, made);
}
