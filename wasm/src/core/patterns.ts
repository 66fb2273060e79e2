/** A name without regard to case and Unicode form. */
const folded = (name: string): string => name.normalize('NFKC').toLowerCase();

/**
 * Returns a test whether a whole name matches a pattern: case and Unicode form do not matter, and `*` is any text. Takes time in proportion
 * to name and pattern at most, times each other: a regular expression would try all ways to share a name among the stars.
 */
export function matcher(pattern: string): (name: string) => boolean {
  const [first = '', ...pieces] = folded(pattern).split('*');
  const last = pieces.pop();
  return (name) => {
    const text = folded(name);
    if (last === undefined) return text === first;
    if (text.length < first.length + last.length || !text.startsWith(first) || !text.endsWith(last)) return false;
    // Each piece where it first occurs: if a name matches at all, it matches so.
    let at = first.length;
    for (const piece of pieces) {
      const found = text.indexOf(piece, at);
      if (found < 0) return false;
      at = found + piece.length;
    }
    return at <= text.length - last.length;
  };
}
