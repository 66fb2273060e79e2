import type { Cage, Fit, TemplateName } from 'cagecast/cages';
import type { WebGLRenderer } from 'three';
import { download } from '../platform/download';
import { element } from '../platform/page';
import { loadModel } from './load-model';
import type { Session } from './session';

/** What the steps of the engine are called for people. */
const kStages: Record<string, string> = {
  hull: 'Wrapping the model',
  simplify: 'Simplifying the cage',
  holes: 'Cutting holes',
  unwrap: 'Unwrapping the cage',
  landmarks: 'Finding landmarks',
  fit: 'Fitting the template',
  enclose: 'Enclosing the model',
};

/** The files of cages that were made here. */
const made = new WeakSet<File>();

/**
 * Makes a cage for a model that has none, or fits a template to it, and saves the result. The engine and the templates load when
 * they are asked for.
 */
export class CageMaker {
  readonly #session: Session;
  readonly #renderer: WebGLRenderer | undefined;
  readonly #template = element('template-select', HTMLSelectElement);
  readonly #note = element('cage-note', HTMLElement);
  readonly #save = element('save-cage', HTMLButtonElement);

  /** @param renderer Undefined without WebGL. */
  constructor(session: Session, renderer: WebGLRenderer | undefined) {
    this.#session = session;
    this.#renderer = renderer;
    element('make-cage', HTMLButtonElement).addEventListener('click', () => this.#run('Making a cage', this.#make));
    element('fit-cage', HTMLButtonElement).addEventListener('click', () => this.#run('Fitting a template', this.#fit));
    this.#save.addEventListener('click', () => {
      const [file] = session.shown!.cage.files;
      download(file!, file!.name);
    });
    session.on('transfer', ({ target, cage }) => {
      element('no-cage', HTMLElement).hidden = target.sample !== undefined;
      const isMade = made.has(cage.files[0]!);
      this.#save.hidden = !isMade;
      if (!isMade) this.#note.textContent = '';
    });
  }

  /** Does cancellable work on the current target, and shows the cage that it comes to. */
  async #run(title: string, work: (context: Context) => Promise<Result>): Promise<void> {
    const { target } = this.#session.shown!;
    const abort = new AbortController();
    const giveUp = (): void => abort.abort();
    const tell = (stage: string, share: number): unknown => this.#session.work(stage, share, giveUp);
    const done = this.#session.work(title, 0, giveUp);
    try {
      const [engine, { cageModel }, read] = await Promise.all([
        import('cagecast/cages'),
        import('cagecast/three'),
        // The model on the stage may be deformed.
        loadModel(target.files[0]!, this.#renderer, target.files.slice(1)),
      ]);
      if (abort.signal.aborted) return;
      const onProgress = (share: number, step: string): unknown => tell(kStages[step] ?? title, share);
      const options = { signal: abort.signal, onProgress };
      const { cage, note } = await work.call(this, { engine, model: cageModel(read.loaded), options });
      if (abort.signal.aborted) return;
      const file = new File([engine.cageGlb(cage)], target.name.replace(/(\.\w+)?$/, '-cage.glb'));
      made.add(file);
      this.#note.textContent = note;
      done();
      this.#session.want({ cage: loadModel(file, this.#renderer) });
    } catch (error) {
      if (abort.signal.aborted) return;
      const message = (error as Error).message.replace(/^\w+: /, '');
      this.#session.fail(new Error(`${target.name}: ${message}`, { cause: error }));
    }
  }

  async #make({ engine, model, options }: Context): Promise<Result> {
    const cage = await engine.makeCage(model, options);
    return {
      cage,
      note: `A cage of ${cage.indices.length / 3} triangles was made. Save it with the paint that you draw for it.`,
    };
  }

  async #fit({ engine, model, options }: Context): Promise<Result> {
    const template = await engine.loadTemplate(this.#template.value as TemplateName);
    const { cage, missing }: Fit = await engine.fitCage(template, model, undefined, options);
    const left = missing.length > 0 ? ` Not found: ${missing.join(', ')}.` : '';
    return { cage, note: `The template was fitted: a paint for it fits every model that it was fitted to.${left}` };
  }
}

interface Context {
  engine: typeof import('cagecast/cages');
  model: ReturnType<typeof import('cagecast/three').cageModel>;
  options: { signal: AbortSignal; onProgress(share: number, step: string): void };
}

interface Result {
  cage: Cage;
  /** What was made, for people. */
  note: string;
}
