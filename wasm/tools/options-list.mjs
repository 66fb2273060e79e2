// Reads core/include/cagecast/options.def, the list of all options, and codes.def, the list of all errors.

import { readFileSync } from 'node:fs';
import { join } from 'node:path';

const kKinds = ['share', 'length', 'toggle', 'choice'];

/**
 * @typedef {object} Option
 * @property {string} name
 * @property {boolean} isStep  Whether it is a switch in `steps`.
 * @property {'project' | 'classify'} stage
 * @property {'share' | 'length' | 'toggle' | 'choice'} kind
 * @property {string | undefined} type  Of a choice: the name of its C++ enumeration.
 * @property {number | boolean | string} standard  In the preset `default`.
 * @property {number | boolean | string} paper  In the preset `paper`.
 * @property {(number | boolean | string)[]} range  Of a number: its least and largest value; else its values.
 * @property {string} text
 */

/** @return {Option[]}  @param {string} root  The repository, or a tree like it. */
export function readOptions(root) {
  const path = 'core/include/cagecast/options.def';
  return entriesOf(root, path, /^CAGECAST_(OPTION|STEP)\((.*)\)$/).map(({ match: [, macro, columns], line }) => {
    const fail = (what) => {
      throw new Error(`${path}:${line}: ${what}`);
    };
    const [stage, name, kindAndType, standard, paper, range, text, ...more] = splitColumns(columns);
    if (text === undefined || more.length > 0) fail('a line has 7 columns');
    const [, kind, type] = /^(\w+)(?:\((\w+)\))?$/.exec(kindAndType) ?? fail(`${kindAndType} is not a kind`);
    if (!kKinds.includes(kind)) fail(`the kind ${kind} is unknown; there are: ${kKinds.join(', ')}`);
    if (stage !== 'project' && stage !== 'classify')
      fail(`the stage ${stage} is unknown; there are: project, classify`);
    return {
      name,
      isStep: macro === 'STEP',
      stage,
      kind,
      type,
      standard: readValue(standard, fail),
      paper: readValue(paper, fail),
      range: splitColumns(range.slice(1, -1)).map((value) => readValue(value, fail)),
      text: textOf(text),
    };
  });
}

/** @return {{name: string, text: string}[]}  All codes but `ok`. */
export function readCodes(root) {
  return entriesOf(root, 'core/include/cagecast/codes.def', /^CAGECAST_CODE\((\w+), (.*)\)$/)
    .map(({ match: [, name, columns] }) => ({ name, text: textOf(splitColumns(columns)[0]) }))
    .filter(({ name }) => name !== 'ok');
}

/**
 * An enumeration of result.hpp.
 * @return {{text: string, values: {name: string, value: number, text: string}[]}}
 */
export function readEnum(root, type) {
  const source = readFileSync(join(root, 'core/include/cagecast/result.hpp'), 'utf8');
  const [, lines, body] = new RegExp(`((?:^///.*\\n)+)enum class ${type} [^{]*\\{([^}]*)\\}`, 'm').exec(source);
  const values = [...body.matchAll(/^\s*(\w+) = (\d+),\s*\/\/\/< (.*)$/gm)].map(([, name, value, text]) => ({
    name: name[0].toUpperCase() + name.slice(1),
    value: Number(value),
    text,
  }));
  return {
    text: lines
      .replace(/^\/\/\/ /gm, '')
      .trim()
      .replaceAll('\n', ' '),
    values,
  };
}

function entriesOf(root, path, pattern) {
  const lines = readFileSync(join(root, path), 'utf8').split('\n');
  return lines.flatMap((line, i) => {
    const match = pattern.exec(line.trim());
    return match ? [{ match, line: i + 1 }] : [];
  });
}

/** Splits at commas that are in no parentheses and no quotes. */
function splitColumns(text) {
  return (text.match(/(?:"(?:[^"\\]|\\.)*"|\((?:[^()]|\([^()]*\))*\)|[^,"(])+/g) ?? []).map((column) => column.trim());
}

/** A text as it is written in C++: one literal, or several that it joins. */
const textOf = (literals) => (literals.match(/"(?:[^"\\]|\\.)*"/g) ?? []).map((one) => JSON.parse(one)).join('');

function readValue(text, fail) {
  if (text === 'true' || text === 'false') return text === 'true';
  if (text === 'kInfinity') return Infinity;
  if (/^-?[\d.]+(e-?\d+)?f?$/.test(text)) return Number.parseFloat(text);
  const [, name] = /^(?:\w+::)?(\w+)$/.exec(text) ?? fail(`${text} is not a value`);
  return name;
}
