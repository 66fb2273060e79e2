import type { ClassifyOptions, Lock, Preset } from 'cagecast';
import { type Borders, bareGroups } from '#three';
import type { ExtractedMesh, Model } from './model';
import type { SplitProjection } from './transfers';

/** Options of the transfer. */
export interface Rules {
  preset: Preset;
  threshold: number;
  /** How close vertices of one mesh are that count as one: a share of the model's diagonal. */
  weldTolerance: number;
  /** Whether triangles are cut where the paint ends. */
  borders: Borders;
}

/** The largest weld tolerance. */
export const kMaxWeld = 0.01;

export const kFirstRules: Rules = { preset: 'default', threshold: 0.5, weldTolerance: 0, borders: 'triangle' };

/** A lock; or all of a part painted, whatever hides it; or the part left out: neither painted nor in the way. */
export type Choice = Lock | 'always' | 'out';

/** Choices by segment; all others are `auto`. */
export type Locks = Record<number, Choice>;

/** The nearest to a choice that is a lock. */
export const asLock = (choice: Choice): Lock => (choice === 'always' ? 'keep' : choice === 'out' ? 'exclude' : choice);

/** The choices for segments of a model, without those for others. */
export const knownLocks = (locks: Locks, { segmentStats }: Pick<SplitProjection, 'segmentStats'>): Locks =>
  Object.fromEntries(Object.entries(locks).filter(([segment]) => Number(segment) < segmentStats.length));

/** Parts that stay bare by default: clothes of a figure, and parts excluded when the cage was made. */
export const bareGroupsOf = (pair: Record<'target' | 'cage', { mesh: ExtractedMesh }> | undefined): number[] =>
  pair ? bareGroups(pair.cage.mesh, pair.target.mesh) : [];

/** The choice for a segment of a group: the user's, if there is one. */
export const choiceFor = (segment: number, group: number, chosen: Locks, bareGroups: readonly number[]): Choice =>
  chosen[segment] ?? (bareGroups.includes(group) ? 'exclude' : 'auto');

/** What choices come to. */
export type Choices = Pick<ClassifyOptions, 'parts' | 'locks' | 'masks'>;

/**
 * The parts, locks and masks that choices come to.
 * @param bareGroups Those that stay bare without a choice.
 * @param projection Of the model that they are for.
 * @param bare       Its triangles that stay bare, as `BareMarks` gives them.
 */
export function choicesOf(
  chosen: Locks,
  bareGroups: readonly number[],
  projection: Pick<SplitProjection, 'segments'> | undefined,
  bare?: Uint8Array,
): Choices {
  const entries = Object.entries(chosen);
  const always = new Set(entries.flatMap(([segment, choice]) => (choice === 'always' ? [Number(segment)] : [])));
  const locks = Object.fromEntries(entries.map(([s, choice]) => [s, asLock(choice)]));
  const parts = { exclude: bareGroups };
  const vertices =
    always.size > 0 && projection && Int8Array.from(projection.segments, (segment) => (always.has(segment) ? 1 : 0));
  const triangles = bare && Int8Array.from(bare, (mark) => -mark);
  return { parts, locks, ...((vertices || triangles) && { masks: { vertices: vertices || undefined, triangles } }) };
}

/** What stays bare of each target, by its file: it comes back with the target. */
export class BareMarks {
  readonly #marks = new WeakMap<File, Uint8Array>();

  /** 1 for each triangle that was marked to stay bare; undefined if there are none. @param files Of the model. */
  of([file]: readonly File[]): Uint8Array | undefined {
    return file && this.#marks.get(file);
  }

  /** Sets the same; marks for another number of triangles are ignored. @returns Whether they were taken. */
  set({ files: [file], mesh }: Model, marks: Uint8Array | undefined): boolean {
    if (!file || (marks && marks.length !== mesh.indices.length / 3)) return false;
    if (marks?.includes(1)) this.#marks.set(file, marks);
    else this.#marks.delete(file);
    return true;
  }
}
