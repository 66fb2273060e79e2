import type { Classification } from 'cagecast';
import { element } from '../platform/page';
import type { Session } from '../scene/session';
import { Superseded, TransferClient } from '../scene/transfer-client';
import type { Placed } from '../scene/transfer-messages';
import type { Viewer } from './viewer';

const kPatience = 300; // milliseconds: while something is dragged, or moves by itself, nothing is cut

/** What a target is cut by. */
interface Basis {
  projection: Placed;
  /** Which segments are culled; all else follows from the projection. */
  culled: string;
}

/**
 * Shows exact borders where the rules ask for them: once the model rests, a worker cuts it by what was decided, and the picture
 * shows that until something else is decided.
 */
export class ExactBorders {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #note = element('borders-note', HTMLElement);
  /** Started when it is needed. */
  #client: TransferClient | undefined;
  /** Of what is shown as it was cut, or is about to be. */
  #basis: Basis | undefined;
  #due: ReturnType<typeof setTimeout> | undefined;
  #cutting = false;

  constructor(session: Session, viewer: Viewer) {
    this.#session = session;
    this.#viewer = viewer;
    session.on('zones', ({ classification }) => this.#follow(classification));
    session.on('progress', ({ state }) => {
      if (state === 'working' && !this.#cutting && this.#due !== undefined) this.#forget();
      // What gave way to something that did not change the decision, as another paint, is taken up again.
      else if (state === 'ready' && session.classification) this.#follow(session.classification);
    });
  }

  #follow(classification: Classification): void {
    const { shown, rules } = this.#session;
    const wanted =
      rules.borders === 'cut'
        ? { projection: shown!.projection, culled: classification.segmentStats.map(({ culled }) => +culled).join('') }
        : undefined;
    if (wanted?.projection === this.#basis?.projection && wanted?.culled === this.#basis?.culled) return;
    this.#forget();
    if (!wanted) return;
    this.#basis = wanted;
    this.#due = setTimeout(() => void this.#cut(classification), kPatience);
  }

  /** Goes back to the target's own triangles. */
  #forget(): void {
    clearTimeout(this.#due);
    this.#due = undefined;
    this.#basis = undefined;
    this.#client?.cancel();
    this.#note.textContent = '';
    void this.#viewer.setCut(undefined);
  }

  async #cut({ zones, segmentStats }: Classification): Promise<void> {
    this.#due = undefined;
    const { shown, rules } = this.#session;
    const { target, cage, projection } = shown!;
    this.#cutting = true;
    const done = this.#session.work('Cutting borders', 0.3, (why) => {
      this.#forget();
      if (why === 'cancelled') this.#session.setRules({ borders: 'triangle' });
    });
    this.#cutting = false;
    try {
      this.#client ??= new TransferClient();
      const { preset, threshold } = rules;
      const cut = await this.#client.ask('cut', cage, target, {
        result: { zones, segments: projection.segments, segmentStats },
        rules: { preset, threshold },
      });
      await this.#viewer.setCut(cut);
      const more = (cut.indices.length - target.mesh.indices.length) / 3;
      this.#note.textContent = `${more.toLocaleString('en')} triangles more.`;
      done();
    } catch (error) {
      if (error instanceof Superseded) return done();
      this.#session.setRules({ borders: 'triangle' });
      this.#session.fail(
        new Error(`${target.name}: ${error instanceof Error ? error.message.replace(/^\w+: /, '') : String(error)}`, {
          cause: error,
        }),
      );
    }
  }
}
