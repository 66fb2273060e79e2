/** A text of the package in the page's words: parts instead of segments, and nothing that has to be typed. */
export function forPeople(text: string): string {
  return text
    .replace(/ \(--(keep|exclude) "[^"]*"\)/g, '')
    .replace(
      /, or call refineCage of cagecast\/cages|; if it is scaled, refineCage of cagecast\/cages scales it back/g,
      '',
    )
    .replace(
      /: make one for each, or raise the option closing/,
      ': open each as a model of its own, or switch off those that are not painted, in the options of Make a cage',
    )
    .replace(/\bsegment(s?)\b/g, 'part$1')
    .replace(/\ba lock excludes\b/g, 'you chose to exclude')
    .replace(/\block some of them\b/, 'keep or exclude some of them')
    .replace(/\boverride this\b/, 'choose otherwise');
}
