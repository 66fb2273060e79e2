// Checks regular expressions: with a repetition inside a repetition, such as (a+)*, some short text takes hours.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import ts from 'typescript';
import { isScript } from './files.mjs';

const isChecked = (path) => /^(wasm\/src|web\/src|examples)\//.test(path) && (isScript(path) || path.endsWith('.tsx'));

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong.
 */
export function checkPatterns(root, files) {
  return files
    .filter(isChecked)
    .flatMap((path) => patternsIn(path, readFileSync(join(root, path), 'utf8')))
    .filter(({ pattern }) => repeatsRepetition(pattern))
    .map(({ at, pattern }) => `${at} ${pattern} repeats what repeats itself; some text takes it hours`);
}

/**
 * @param {string} path  Of a script.
 * @param {string} text  Its content.
 * @return {{at: string, pattern: string, flags: string}[]}  Its regular expressions, and the lines they are in.
 */
export function patternsIn(path, text) {
  const source = ts.createSourceFile(path, text, ts.ScriptTarget.Latest);
  const found = [];
  const visit = (node) => {
    const { line } = source.getLineAndCharacterOfPosition(node.getStart(source));
    const [, pattern, flags] = /^\/(.*)\/(\w*)$/s.exec(literalOf(node) ?? '') ?? [];
    if (pattern !== undefined) found.push({ at: `${path}:${line + 1}`, pattern, flags });
    ts.forEachChild(node, visit);
  };
  visit(source);
  return found;
}

/** A literal, or what is given to RegExp as one. */
function literalOf(node) {
  if (ts.isRegularExpressionLiteral(node)) return node.text;
  const isMade = ts.isNewExpression(node) || ts.isCallExpression(node);
  if (!isMade || !ts.isIdentifier(node.expression) || node.expression.text !== 'RegExp') return undefined;
  const [given] = node.arguments ?? [];
  return given && ts.isStringLiteralLike(given) ? `/${given.text}/` : undefined;
}

/** Whether a group that may occur any number of times has something in it that may, too. */
export function repeatsRepetition(pattern) {
  /** For each group that is open, outermost first: whether something in it is repeated. */
  const open = [false];
  let isClass = false;
  for (let at = 0; at < pattern.length; ++at) {
    const letter = pattern[at];
    if (letter === '\\') ++at;
    else if (isClass) isClass = letter !== ']';
    else if (letter === '[') isClass = true;
    else if (letter === '(') open.push(false);
    else if (letter === ')') {
      const repeats = open.pop();
      const isRepeated = kUnbounded.test(pattern.slice(at + 1));
      if (repeats && isRepeated) return true;
      open[open.length - 1] ||= repeats || isRepeated;
    } else if (kUnbounded.test(pattern.slice(at))) open[open.length - 1] = true;
  }
  return false;
}

const kUnbounded = /^([*+]|\{\d+,\})/;
