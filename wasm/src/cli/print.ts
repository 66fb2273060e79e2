// What a terminal obeys instead of showing: control characters, and marks that turn the direction of text.
const commands = /(?![\n\t])[\p{Cc}\p{Bidi_Control}]/gu;

/** A text with names from files in it, harmless to print: "\u001b" for an escape character, as in JSON, where it means the same. */
export function harmless(text: string): string {
  return text.replace(commands, escaped);
}

/** The same for a text that has to stay on one line. */
export function oneLine(text: string): string {
  return harmless(text).replace(/[\t\n\u2028\u2029]/g, escaped);
}

const escaped = (character: string): string => `\\u${character.charCodeAt(0).toString(16).padStart(4, '0')}`;

/** Prints the result of a command. */
export function print(text: string): void {
  console.log(harmless(text));
}
