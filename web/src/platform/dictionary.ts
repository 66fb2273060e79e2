/** What {0} stands for may be any text, {n0} a number only. */
const kPlaceholder = /\{(n?\d)\}/g;
const kSentences = /(?<=[.!?…])\s+/;
const kNumber = /^[≥<]?\s?\d[\d,]*(\.\d+)?( ?[%×°])?$/;
const kKept = 2000; // answers

/** A text with placeholders. */
interface Pattern {
  /** Its longest piece, by which most texts are known not to be of it. */
  piece: string;
  form: RegExp;
  /** By the place in the text: the number of the placeholder, and whether it is in quotes, as names of files are. */
  slots: readonly { name: string; isQuoted: boolean }[];
  to: string;
}

/**
 * Translates English texts of the page. Keys are texts, in which {0}, {1} … stand for what varies, {n0} for a number; `" "`, `", "`, `": "` and `"."` say
 * what joins and ends sentences, items of a list and what is said of something, and `"1,234.5"` how numbers are written.
 */
export class Dictionary {
  readonly #texts: ReadonlyMap<string, string>;
  readonly #patterns: readonly Pattern[];
  readonly #answers = new Map<string, string | undefined>();
  readonly #onLeft: (words: string) => void;

  /** @param onLeft  Called with words within a text that are left as they are, such as names. */
  constructor(entries: Readonly<Record<string, string>>, onLeft: (words: string) => void = () => {}) {
    this.#texts = new Map(Object.entries(entries));
    this.#onLeft = onLeft;
    this.#patterns = [...this.#texts]
      .filter(([text]) => text.search(kPlaceholder) >= 0)
      .map(([text, to]) => patternOf(text, to))
      // Those that say more come first.
      .sort((a, b) => b.form.source.length - a.form.source.length);
  }

  /** The translation of a text; undefined if it is left as it is. White space around it stays. */
  translate(text: string): string | undefined {
    if (this.#answers.has(text)) return this.#answers.get(text);
    const [, before = '', words = '', after = ''] = /^(\s*)(.*?)(\s*)$/s.exec(text)!;
    const found = this.#texts.get(words.replace(/\s+/g, ' ')) ?? this.#lines(words);
    const answer = found === undefined ? undefined : before + found + after;
    if (this.#answers.size >= kKept) this.#answers.clear();
    this.#answers.set(text, answer);
    return answer;
  }

  #lines(text: string): string | undefined {
    const lines = text.split('\n');
    const said = lines.map((line) => this.#say(line.trim()));
    return said.some((line) => line !== undefined) ? lines.map((line, i) => said[i] ?? line).join('\n') : undefined;
  }

  #say(text: string): string | undefined {
    const exact = this.#texts.get(text) ?? this.#number(text);
    if (exact !== undefined || !/[a-z]{2}/i.test(text)) return exact;
    const sentences = text.split(kSentences);
    const said = sentences.length > 1 ? sentences.map((sentence) => this.#say(sentence)) : [];
    const join = (): string => sentences.map((sentence, i) => said[i] ?? sentence).join(this.#texts.get(' ') ?? ' ');
    if (said.length > 0 && !said.includes(undefined)) return join();
    return (
      this.#fill(text) ??
      this.#list(text) ??
      this.#afterColon(text) ??
      this.#withoutEnd(text) ??
      (said.some((one) => one !== undefined) ? join() : undefined)
    );
  }

  /** By the first pattern that fits. */
  #fill(text: string): string | undefined {
    for (const { piece, form, slots, to } of this.#patterns) {
      if (!text.includes(piece)) continue;
      const found = form.exec(text);
      if (!found) continue;
      const values = new Map(
        slots.map(({ name, isQuoted }, i) => [name, isQuoted ? found[i + 1]! : this.#value(found[i + 1]!)]),
      );
      return to.replace(kPlaceholder, (_, name: string) => values.get(name) ?? '');
    }
    return undefined;
  }

  /** Of words that a full stop or dots follow, as they do when they end a sentence or are still being done. */
  #withoutEnd(text: string): string | undefined {
    const [, words = '', end = ''] = /^(.+?)([.…])$/.exec(text) ?? [];
    const said = words === '' ? undefined : this.#say(words);
    return said === undefined ? undefined : said + (this.#texts.get(end) ?? end);
  }

  /** Of a file, or of something that has a name: what is said of it. */
  #afterColon(text: string): string | undefined {
    for (let at = text.indexOf(': '); at >= 0; at = text.indexOf(': ', at + 1)) {
      const said = this.#say(text.slice(at + 2));
      if (said !== undefined) return this.#value(text.slice(0, at)) + (this.#texts.get(': ') ?? ': ') + said;
    }
    return undefined;
  }

  /** A list of which every item is known. */
  #list(text: string): string | undefined {
    const items = text.split(', ');
    const said = items.length > 1 ? items.map((item) => this.#say(item)) : [undefined];
    return said.includes(undefined) ? undefined : said.join(this.#texts.get(', ') ?? ', ');
  }

  /** What a placeholder stands for: words of the page or a list of them, a number, or a name. */
  #value(words: string): string {
    const known = this.#list(words) ?? this.#say(words);
    if (known !== undefined) return known;
    const items = words.split(', ').map((item) => this.#say(item) ?? this.#leave(item));
    return items.join(this.#texts.get(', ') ?? ', ');
  }

  #leave(words: string): string {
    this.#onLeft(words);
    return words;
  }

  #number(text: string): string | undefined {
    const like = this.#texts.get('1,234.5');
    if (!like || !kNumber.test(text)) return undefined;
    return text.replace(/[,.]/g, (mark) => (mark === ',' ? like[1]! : like[5]!));
  }
}

function patternOf(text: string, to: string): Pattern {
  const slots = [...text.matchAll(kPlaceholder)].map(({ 1: name = '', index }) => ({
    name,
    isQuoted: /[“"]/.test(text[index - 1] ?? ''),
  }));
  // Every other one is a placeholder's name.
  const pieces = text.split(kPlaceholder);
  const form = pieces.map((piece, i) =>
    i % 2 === 0 ? piece.replace(/[.*+?^${}()|[\]\\]/g, '\\$&') : piece[0] === 'n' ? '([\\d.,]+)' : '(.+?)',
  );
  const words = pieces.filter((_, i) => i % 2 === 0);
  return {
    piece: words.reduce((longest, one) => (one.length > longest.length ? one : longest)),
    // A full stop that the key lacks is not part of what varies.
    form: new RegExp(`^${form.join('')}${pieces.at(-1) === '' ? '(?<![.…])' : ''}$`),
    slots,
    to,
  };
}
