import type { TemplateName } from 'cagecast/cages';
import { maxLayers } from '#three';
import { type Choice, kMaxWeld, type Locks, type Rules } from '../state/choices';
import { type ChosenShape, kDeforms } from '../state/deform';
import type { Angle } from '../state/view-state';
import {
  type Half,
  kFirstView,
  kHalves,
  kLastStep,
  kLightNames,
  kModes,
  type LightName,
  type Mode,
  type View,
} from '../state/view-state';

/** What a half shows. */
const halfOf = (word: string | null, half: 'left' | 'right'): Half =>
  kHalves.find((known) => known === word) ?? kFirstView[half];

/** A link may name as many morphs, with weights up to so much, as projects. */
const [kMaxMorphs, kMaxWeight] = [10_000, 1e6];
const kChoices = ['keep', 'exclude', 'always', 'out'] as const;

/** A layer in a link. */
export interface LinkedLayer {
  /** A paint that comes with the page: its path in the folder of samples, its name, or `checker`; or strokes as a text. */
  paint: string;
  /** 0..1 */
  opacity: number;
  /** #rrggbb */
  tint: string;
  blend: string;
  visible: boolean;
}

/** The state that a link restores. */
export interface LinkState {
  sample: string;
  /** From the lowest to the uppermost; undefined for the sample's default. */
  layers: LinkedLayer[] | undefined;
  rules: Rules;
  locks: Locks;
  view: View;
  /** Absent at rest. */
  shape?: ChosenShape | undefined;
  /** Absent for the default camera. */
  angle?: Angle | undefined;
}

/** A look without its model: all that have the same template can wear it. */
export interface Look {
  template: TemplateName;
  layers: LinkedLayer[];
  light: LightName;
  /** #rrggbb; empty for none. */
  background: string;
}

/** The samples that looks are shown on. */
export const kStandIns: Record<TemplateName, string> = {
  'human-head': 'human',
  'human-body': 'avatar',
  'animal-head': 'lizard',
  car: 'car',
  'face-mask': 'human',
};

/** Encodes a look as a URL fragment, as `writeLink`. */
export function writeLook({ template, layers, light, background }: Look): string {
  const words = new URLSearchParams({ look: template });
  writeLayers(words, layers);
  writeLight(words, light, background);
  return textOf(words);
}

/** Decodes a fragment, as `readLink`. @returns Undefined if it has no look for a template of the page, or is cut off before its layers. */
export function readLook(fragment: string): Look | undefined {
  const words = new URLSearchParams(fragment.replace(/^#/, ''));
  const template = words.get('look') as TemplateName;
  if (!Object.hasOwn(kStandIns, template)) return undefined;
  const layers = readLayers(words);
  return layers && { template, layers, ...readLight(words) };
}

/** Encodes a state as a URL fragment, without `#`. The format is public: people save links. */
export function writeLink({ sample, layers, rules, locks, view, shape, angle }: LinkState): string {
  const words = new URLSearchParams({ sample });
  if (layers) writeLayers(words, layers);
  words.set('rules', rules.preset);
  words.set('threshold', String(rules.threshold));
  if (rules.borders !== 'triangle') words.set('borders', rules.borders);
  if (rules.weldTolerance > 0) words.set('weld', String(rules.weldTolerance));
  for (const lock of kChoices) {
    const segments = Object.keys(locks).filter((segment) => locks[Number(segment)] === lock);
    if (segments.length > 0) words.set(lock, segments.join(','));
  }
  words.set('view', view.mode);
  if (view.mode === 'compare') {
    words.set('split', view.split.toFixed(3));
    for (const half of ['left', 'right'] as const) if (view[half] !== kFirstView[half]) words.set(half, view[half]);
  }
  if (view.mode === 'steps') words.set('step', view.step.toFixed(2));
  if (!view.paint) words.set('paint', 'off');
  if (view.cage) words.set('cage', 'on');
  if (view.seeThrough) words.set('through', 'on');
  writeLight(words, view.light, view.background);
  if (shape && shape.amount !== 0)
    words.set('deform', [shape.deform, Number(shape.amount.toFixed(3)), ...(shape.cage ? [] : ['alone'])].join(','));
  for (const [name, weight] of shape?.morphs ?? []) words.append('morph', `${Number(weight.toFixed(3))},${name}`);
  if (angle) {
    const at = angle.at?.map((value) => value.toFixed(4)) ?? [];
    const numbers = [angle.turn.toFixed(3), angle.tilt.toFixed(3), angle.near.toFixed(4), ...at].map(Number);
    words.set('angle', numbers.join(','));
  }
  return textOf(words);
}

const textOf = (words: URLSearchParams): string =>
  words.toString().replaceAll('%2F', '/').replaceAll('%2C', ',').replaceAll('%3A', ':');

function writeLayers(words: URLSearchParams, layers: readonly LinkedLayer[]): void {
  for (const { paint, opacity, tint, blend, visible } of layers) {
    words.append(
      'layer',
      [paint, Number(opacity.toFixed(3)), tint.replace('#', ''), blend, ...(visible ? [] : ['hidden'])].join(','),
    );
  }
  if (layers.length === 0) words.set('layer', 'none');
}

function writeLight(words: URLSearchParams, light: LightName, background: string): void {
  if (light !== 'studio') words.set('light', light);
  if (background) words.set('background', background.replace('#', ''));
}

/**
 * Decodes a fragment. A link may be old, truncated or edited by hand: missing or invalid values get their defaults.
 * @returns Undefined if it names no sample.
 */
export function readLink(fragment: string): LinkState | undefined {
  const words = new URLSearchParams(fragment.replace(/^#/, ''));
  const sample = words.get('sample');
  if (!sample) return undefined;
  const mode = words.get('view') as Mode;
  return {
    sample,
    layers: readLayers(words),
    rules: {
      preset: words.get('rules') === 'paper' ? 'paper' : 'default',
      threshold: share(words.get('threshold'), 0.5),
      weldTolerance: share(words.get('weld'), 0, kMaxWeld),
      borders: words.get('borders') === 'cut' ? 'cut' : 'triangle',
    },
    locks: Object.assign({}, ...kChoices.map((choice) => readLocks(words, choice))),
    view: {
      mode: kModes.includes(mode) ? mode : 'compare',
      split: share(words.get('split'), 0.5),
      left: halfOf(words.get('left'), 'left'),
      right: halfOf(words.get('right'), 'right'),
      step: share(words.get('step'), 0, kLastStep),
      paint: words.get('paint') !== 'off',
      cage: words.get('cage') === 'on',
      seeThrough: words.get('through') === 'on',
      ...readLight(words),
    },
    shape: readShape(words),
    angle: readAngle(words.get('angle')),
  };
}

/** Undefined if the link says nothing of layers. */
function readLayers(words: URLSearchParams): LinkedLayer[] | undefined {
  const layers = words.getAll('layer').slice(0, maxLayers);
  return layers.length > 0 ? layers.filter((text) => text !== 'none').map(readLayer) : undefined;
}

const readLight = (words: URLSearchParams): Pick<View, 'light' | 'background'> => ({
  light: kLightNames.find((name) => name === words.get('light')) ?? 'studio',
  background: readColor(words.get('background') ?? '') ?? '',
});

function readLayer(text: string): LinkedLayer {
  const [paint = '', opacity = null, tint = '', blend = 'normal', hidden] = text.split(',');
  return {
    paint,
    opacity: share(opacity, 1),
    tint: readColor(tint) ?? '#ffffff',
    blend,
    visible: hidden !== 'hidden',
  };
}

function readShape(words: URLSearchParams): ChosenShape | undefined {
  const [deform = '', amount = '', alone] = (words.get('deform') ?? '').split(',');
  const known = kDeforms.find((name) => name === deform);
  const far = Math.abs(Number(amount)) <= 1 ? Number(amount) : 0;
  const given = words.getAll('morph').slice(0, kMaxMorphs);
  const morphs = given.flatMap((text): [string, number][] => {
    const [, weight, name] = /^([^,]+),(.+)$/s.exec(text) ?? [];
    return name !== undefined && Math.abs(Number(weight)) <= kMaxWeight ? [[name, Number(weight)]] : [];
  });
  return (known && far !== 0) || morphs.length > 0
    ? { deform: known ?? kDeforms[0], amount: known ? far : 0, cage: alone !== 'alone', morphs: new Map(morphs) }
    : undefined;
}

function readLocks(words: URLSearchParams, lock: Choice): Locks {
  const numbers = (words.get(lock) ?? '').split(',').filter((word) => /^\d{1,9}$/.test(word));
  return Object.fromEntries(numbers.map((number) => [number, lock]));
}

function readAngle(word: string | null): Angle | undefined {
  const [turn = NaN, tilt = NaN, near = NaN, x = NaN, y = NaN, z = NaN] = (word ?? '').split(',').map(Number);
  if (!(Math.abs(turn) <= 360 && tilt >= 0 && tilt <= 180 && near > 0 && near < Infinity)) return undefined;
  return { turn, tilt, near, ...([x, y, z].every((value) => Math.abs(value) <= 1) && { at: [x, y, z] as const }) };
}

const readColor = (word: string): string | undefined => (/^[0-9a-f]{6}$/i.test(word) ? `#${word}` : undefined);

/** A number from 0 to `most`, or the default. */
function share(word: string | null, otherwise: number, most = 1): number {
  const number = word === null || word === '' ? NaN : Number(word);
  return number >= 0 && number <= most ? number : otherwise;
}
