import type { Color, Texture } from 'three';

/** What materials show of layers besides the colour of their texture. */
export interface Channels {
  /** The model's own colour is multiplied by it, where it is painted; undefined for white. */
  tint: Color | undefined;
  /**
   * Roughness (red) and metalness (blue), both multiplied by how much they cover what the material has, and how much that is (green
   * and alpha). Like the others in the UV space of the paint, and undefined if no layer has it.
   */
  surface: Texture | undefined;
  /** Light of its own, as a share of `strength`. */
  glow: Texture | undefined;
  /** By what the colours of `glow` are multiplied. */
  strength: number;
  /** x and y of unit vectors in tangent space: red and green, of which 128/255 is 0. */
  normals: Texture | undefined;
}

/** Those of a texture without any. */
export const noChannels: Channels = {
  tint: undefined,
  surface: undefined,
  glow: undefined,
  strength: 1,
  normals: undefined,
};

/** Who has to know when a texture has other channels. */
export interface Follower {
  texture: Texture | null | undefined;
  /** Called after the channels of `texture` have changed. */
  follow(): void;
}

interface Entry {
  channels: Channels;
  /** Weak, as layers may live longer than the models that show them. */
  followers: Set<WeakRef<Follower>>;
}

/** Where textures of layers have them: the entries of the package that are bundled share no variables. */
const kEntry = Symbol.for('cagecast channels');
type Carrier = Texture & { [kEntry]?: Entry };
const references = new WeakMap<Follower, WeakRef<Follower>>();

/** The channels of a texture. */
export const channelsOf = (texture: Texture | null | undefined): Channels =>
  (texture as Carrier | null | undefined)?.[kEntry]?.channels ?? noChannels;

/** Sets the channels of a texture, and tells all that show it. */
export function setChannels(texture: Texture, channels: Channels): void {
  const entry = ((texture as Carrier)[kEntry] ??= { channels, followers: new Set() });
  const before = entry.channels;
  if ((Object.keys(channels) as (keyof Channels)[]).every((key) => channels[key] === before[key])) return;
  entry.channels = channels;
  for (const reference of entry.followers) {
    const follower = reference.deref();
    if (follower?.texture === texture) follower.follow();
    else entry.followers.delete(reference);
  }
}

/** Has somebody told of changes of the channels of its texture, as long as it lives. */
export function followChannels(follower: Follower): void {
  const followers = (follower.texture as Carrier | null | undefined)?.[kEntry]?.followers;
  if (!followers) return;
  let reference = references.get(follower);
  if (!reference) references.set(follower, (reference = new WeakRef(follower)));
  followers.add(reference);
}

/** What of channels is a part of shaders: a word for each that there is. */
export const variantOf = ({ tint, surface, glow, normals }: Channels): string =>
  `${tint ? ' tint' : ''}${surface ? ' surface' : ''}${glow ? ' glow' : ''}${normals ? ' normals' : ''}`;
