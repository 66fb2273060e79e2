/** What is in some ranges but not in others, in order. */
export function subtract(ranges: readonly [number, number][], others: readonly [number, number][]): [number, number][] {
  const marks = [
    ...ranges.flatMap(([first, end]) => [
      { at: first, by: 1, of: 0 },
      { at: end, by: -1, of: 0 },
    ]),
    ...others.flatMap(([first, end]) => [
      { at: first, by: 1, of: 1 },
      { at: end, by: -1, of: 1 },
    ]),
  ].sort((a, b) => a.at - b.at);
  const depth = [0, 0];
  const found: [number, number][] = [];
  for (const [i, { at, by, of }] of marks.entries()) {
    depth[of]! += by;
    const end = marks[i + 1]?.at ?? at;
    if (end === at || depth[0] === 0 || depth[1]! > 0) continue;
    const last = found.at(-1);
    if (last?.[1] === at) last[1] = end;
    else found.push([at, end]);
  }
  return found;
}
