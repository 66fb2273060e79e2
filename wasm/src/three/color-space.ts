import { NoColorSpace, type Texture, UnsignedByteType } from 'three';

const told = new WeakSet<Texture>();

/** Warns once of a texture of colours without a colour space: three.js takes it for linear light, so that it looks pale. */
export function checkColorSpace(texture: Texture): void {
  const { colorSpace, type, version, name } = texture;
  // What is not loaded yet may still get one. What is drawn is linear without one.
  const isMeant =
    colorSpace !== NoColorSpace || type !== UnsignedByteType || version === 0 || texture.isRenderTargetTexture;
  if (isMeant || told.has(texture)) return;
  told.add(texture);
  const which = name ? `texture "${name}"` : 'texture';
  console.warn(
    `cagecast/three: a ${which} has no colour space, so its colours look pale; before it is drawn, set texture.colorSpace = SRGBColorSpace`,
  );
}
