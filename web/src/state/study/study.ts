import type { Preset } from 'cagecast';
import { Emitter } from '#three';
import { withoutParts } from '../left-out';
import type { Sample } from '../sample';
import type { Session } from '../session';
import { type SplitProjection, Superseded, type Transferer, type WorkerProjection } from '../transfers';
import { type Baseline, type Half, kBaselines } from '../view-state';
import { type Decision, decide } from './baselines';
import { type Labels, readLabels } from './labels';
import { type Score, scoreOf, vertexAreas } from './score';
import { kTimedRuns, sumUp, type Timed } from './timed';

const kRest = 300; // milliseconds without a change
const kLongest = 250; // milliseconds: longer transfers are timed only when that is asked for

/** What is found of a method. */
export interface Found {
  method: Half;
  /** How many vertices of the model it paints. */
  painted: number;
  /** Undefined without labels. */
  score: Score | undefined;
}

interface StudyEvents {
  /** What each way to transfer paints; undefined until that is known. */
  decided: Readonly<Record<Baseline, Decision>> | undefined;
  /** Undefined until transfers have been timed. */
  timed: Timed | undefined;
  /** The labels of the model came, or are gone. */
  labels: Labels | undefined;
}

/** Compares ways to transfer on what is shown, and times the transfer. Does nothing until it is active. */
export class Study extends Emitter<StudyEvents> {
  readonly #session: Session;
  readonly #transferer: Transferer;
  readonly #fetch: (sample: Sample) => Promise<string | undefined>;
  /** Given by the user, by the model's file. */
  readonly #given = new WeakMap<File, Labels>();
  #active = false;
  #runs = 0;
  #due: ReturnType<typeof setTimeout> | undefined;
  #decided: StudyEvents['decided'];
  #labels: Labels | undefined;
  #areas: Float64Array | undefined;

  /**
   * @param transferer One of its own, as the latest request to a transferer ends the one before.
   * @param fetch      Gives the text of a sample's labels, if it has any.
   */
  constructor(session: Session, transferer: Transferer, fetch: (sample: Sample) => Promise<string | undefined>) {
    super();
    this.#session = session;
    this.#transferer = transferer;
    this.#fetch = fetch;
    for (const event of ['transfer', 'frame'] as const) session.on(event, () => this.#restart());
  }

  get decided(): StudyEvents['decided'] {
    return this.#decided;
  }

  /** Begins, or ends what it does. */
  set active(on: boolean) {
    if (on === this.#active) return;
    this.#active = on;
    if (!on) this.#transferer.cancel();
    if (on && !this.#decided && this.#session.shown) this.#restart();
  }

  /** Takes labels of the shown model. @throws Error that says what is wrong with them. */
  async label(file: File): Promise<void> {
    const { target } = this.#session.shown!;
    this.#given.set(target.files[0]!, readLabels(await file.text(), file.name, target.mesh));
    this.#takeLabels(this.#given.get(this.#session.shown!.target.files[0]!));
  }

  /** What is known of all methods; empty until it is. */
  get found(): Found[] {
    const { shown, classification } = this.#session;
    if (!this.#decided || !shown || !classification) return [];
    const [labels, mesh] = [this.#labels, shown.target.mesh];
    const score = (zones: Uint8Array): Score | undefined =>
      labels && scoreOf(labels, (this.#areas ??= vertexAreas(mesh)), zones);
    const found = (method: Half, { zones }: { zones: Uint8Array }): Found => ({
      method,
      painted: zones.reduce((sum, zone) => sum + Number(zone === 0), 0),
      score: score(zones),
    });
    return [...kBaselines.map((name) => found(name, this.#decided![name])), found('result', classification)];
  }

  /** Times transfers of what is shown. @throws Superseded if something else is shown meanwhile. */
  async time(): Promise<void> {
    const { shown, rules } = this.#session;
    if (!shown) return;
    const { preset, weldTolerance, threshold } = rules;
    const target = withoutParts(shown.target, shown.projection);
    const options = { rules: { preset, weldTolerance, threshold }, runs: kTimedRuns };
    const { runs } = await this.#transferer.ask('time', shown.cage, target, options);
    if (shown === this.#session.shown) this.emit('timed', sumUp(runs));
  }

  #restart(): void {
    this.#runs++;
    clearTimeout(this.#due);
    this.#areas = this.#decided = undefined;
    this.emit('decided', undefined);
    this.emit('timed', undefined);
    this.#transferer.cancel();
    if (this.#active && this.#session.shown) this.#due = setTimeout(() => void this.#begin(), kRest);
  }

  async #begin(): Promise<void> {
    const run = this.#runs;
    const { shown } = this.#session;
    const { target, projection } = shown!;
    void this.#findLabels(run);
    try {
      const projections = {
        paper: await this.#project('paper'),
        default: await this.#project('default'),
      };
      if (run !== this.#runs) return;
      this.#decided = decide(projections);
      this.emit('decided', this.#decided);
      if (projection.timings.total < kLongest) await this.time();
    } catch (error) {
      // What cannot be transferred by a preset has no methods to compare.
      if (!(error instanceof Superseded)) console.warn(`${target.name}: ${(error as Error).message}`);
    }
  }

  async #project(preset: Preset): Promise<SplitProjection | WorkerProjection> {
    const { cage, target, projection } = this.#session.shown!;
    if (projection.preset === preset) return projection;
    const { weldTolerance } = projection;
    return this.#transferer.ask('project', cage, withoutParts(target, projection), { preset, weldTolerance });
  }

  async #findLabels(run: number): Promise<void> {
    const { files, mesh, sample } = this.#session.shown!.target;
    let labels = this.#given.get(files[0]!);
    if (!labels && sample) {
      const text = await this.#fetch(sample);
      if (run !== this.#runs) return;
      labels = text ? readLabels(text, sample.title, mesh) : undefined;
    }
    this.#takeLabels(labels);
  }

  #takeLabels(labels: Labels | undefined): void {
    this.#labels = labels;
    this.emit('labels', labels);
  }
}
