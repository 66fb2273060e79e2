import { readFileSync } from 'node:fs';

/** A spot in the space of the model's scene. */
export type Spot = readonly [number, number, number];

/** Where eyes and mouth are, on the surface; left and right are the model's own. */
export interface Face {
  eyeL: Spot;
  eyeR: Spot;
  mouth: Spot;
  /** Who marked it: `net`, a learned detector that was sure, or `hand`, on a picture. */
  by: 'net' | 'hand';
  /** Spots that are not to be seen, marked where they would be. The mouth does not count then. */
  guessed?: 'mouth' | 'eyes and mouth';
}

/** A kind of part, as names of nodes, meshes or materials. */
export type Parts = Partial<Record<'skin' | 'clothes' | 'hair' | 'eyes', string[]>>;

/** An avatar of `avatars.json`: where it comes from, and what is true of it. */
export interface Avatar {
  file: string;
  repository: string;
  commit: string;
  path: string;
  sha256: string;
  licence: string;
  maker: string;
  style: string;
  kind: 'head' | 'figure' | 'animal' | 'thing';
  /** `held`: not looked at while rules are written. By the hash: an even first digit is open. */
  half: 'open' | 'held';
  /** The doors whose pictures could be put before users untouched, by eye. Default: nobody has looked. */
  ships?: Door[];
  face?: Face;
  parts?: Parts;
}

export const avatars = (): Avatar[] =>
  JSON.parse(readFileSync(new URL('avatars.json', import.meta.url), 'utf8')) as Avatar[];

/** The doors: a command, and the template of a fit; `auto` comes to one of the others. */
export const kDoors = ['fit human-head', 'fit human-body', 'make', 'fit auto'] as const;
export type Door = (typeof kDoors)[number];
