import type { Classification } from 'cagecast';
import { TransferClient } from '../loading/transfer-client';
import { element } from '../platform/page';
import { withoutParts } from '../state/left-out';
import type { Session } from '../state/session';
import type { SplitProjection } from '../state/transfers';
import { Superseded } from '../state/transfers';
import { reasonOf } from '../state/wording';
import type { Stage } from './stage';

const kPatience = 300; // milliseconds without a change before cutting

/** What a cut depends on. */
interface Basis {
  projection: SplitProjection;
  /** One digit per segment, 1 if culled; all else follows from the projection. */
  culled: string;
  /** The segments that are painted whatever hides them. */
  always: string;
  /** What the user marked to stay bare. */
  bare: Uint8Array | undefined;
}

/**
 * Shows exact borders if they are switched on: once nothing changes any more, a worker cuts the target, and the view shows the
 * cut target until the next change.
 */
export class ExactBorders {
  readonly #session: Session;
  readonly #stage: Stage;
  readonly #note = element('borders-note', HTMLElement);
  /** Started on demand. */
  #client: TransferClient | undefined;
  /** Of the cut that is shown or in progress. */
  #basis: Basis | undefined;
  #due: ReturnType<typeof setTimeout> | undefined;
  #cutting = false;

  constructor(session: Session, stage: Stage) {
    this.#session = session;
    this.#stage = stage;
    session.on('zones', ({ classification }) => this.#follow(classification));
    session.on('progress', ({ state }) => {
      if (state === 'working' && !this.#cutting && this.#due !== undefined) this.#clear();
      // Resume a cut that was superseded by something that does not affect it, such as another paint.
      else if (state === 'ready' && session.classification) this.#follow(session.classification);
    });
  }

  #follow(classification: Classification): void {
    const { shown, rules, locks, bare } = this.#session;
    const basis =
      rules.borders === 'cut'
        ? {
            projection: shown!.projection,
            culled: classification.segmentStats.map(({ culled }) => +culled).join(''),
            always: Object.keys(locks)
              .filter((segment) => locks[Number(segment)] === 'always')
              .join(),
            bare,
          }
        : undefined;
    const keys = ['projection', 'culled', 'always', 'bare'] as const;
    if (keys.every((key) => basis?.[key] === this.#basis?.[key])) return;
    this.#clear();
    if (!basis || this.#session.isMakingCage) return; // the cut waits until that is made
    this.#basis = basis;
    this.#due = setTimeout(() => void this.#cut(classification), kPatience);
  }

  /** Shows the target's own triangles again. */
  #clear(): void {
    clearTimeout(this.#due);
    this.#due = undefined;
    this.#basis = undefined;
    this.#client?.cancel();
    this.#note.textContent = '';
    void this.#stage.setCut(undefined);
  }

  async #cut({ zones, segmentStats }: Classification): Promise<void> {
    this.#due = undefined;
    const { shown, rules, choices } = this.#session;
    const { target, cage, projection } = shown!;
    this.#cutting = true;
    const done = this.#session.work('Cutting borders', 0.3, {
      abort: (why) => {
        this.#clear();
        if (why === 'cancelled') this.#session.setRules({ borders: 'triangle' });
      },
    });
    this.#cutting = false;
    try {
      this.#client ??= new TransferClient();
      const { preset, threshold, weldTolerance } = rules;
      const cut = await this.#client.ask('cut', cage, withoutParts(target, projection), {
        result: { zones, segments: projection.segments, segmentStats },
        rules: { preset, threshold, weldTolerance, ...choices },
      });
      await this.#stage.setCut(cut);
      const more = (cut.indices.length - target.mesh.indices.length) / 3;
      this.#note.textContent = `Adds ${more.toLocaleString('en')} triangles.`;
      done();
    } catch (error) {
      if (error instanceof Superseded) return done();
      this.#session.setRules({ borders: 'triangle' });
      this.#session.fail(new Error(`${target.name}: ${reasonOf(error)}`, { cause: error }));
    }
  }
}
