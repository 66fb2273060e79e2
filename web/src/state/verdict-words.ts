import type { KnownVerdict } from './verdict';

/** What there is to say of a painted model. */
interface Seen {
  /** The region that its cage covers, if not all of it. */
  region: string | undefined;
  /** The plain names of the parts that stay bare. */
  bare: readonly string[];
  /** How many things there are to look at. */
  findings: number;
  /** Whether its cage is another model's. */
  isForeign: boolean;
}

const kMaxNames = 4;

/** A verdict in plain words: a line for the stage, and the short of it for cards. */
export function verdictWords(
  verdict: KnownVerdict,
  { region, bare, findings, isForeign }: Seen,
): Record<'stage' | 'card', string> {
  if (verdict === 'unfit') return { stage: 'Does not look right', card: 'does not look right' };
  if (verdict === '' && isForeign) return { stage: 'Painted for another model', card: 'of another model' };
  if (verdict === 'usable') {
    const spots = `${findings} ${findings === 1 ? 'spot' : 'spots'}`;
    return { stage: `Looks off? ${spots}`, card: `looks off? ${spots}` };
  }
  const more = bare.length > kMaxNames ? [`${bare.length - kMaxNames + 1} more`] : [];
  const names = [...bare.slice(0, kMaxNames - more.length), ...more].join(', ');
  return { stage: `Painted${region ? `: ${region}` : ''}${names && ` · ${names} bare`}`, card: 'painted' };
}
