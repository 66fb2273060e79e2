/**
 * Returns a test whether a name matches a pattern, in which `*` matches any text. Takes time in proportion to name and pattern at
 * most, times each other: a regular expression would try all ways to share a name among the stars.
 */
export function matcher(pattern: string): (name: string) => boolean {
  const [first = '', ...pieces] = pattern.split('*');
  const last = pieces.pop();
  return (text) => {
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
