// WebAssembly that multiplies and adds in one go where an engine can, and in two everywhere else, from one module.

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';

/** a · b + c, of "relaxed SIMD"; the first is its name before it was finished. Its operands follow, each in parentheses. */
const fused = /\(f32x4\.relaxed_(?:fma|madd)\b/g;
/** Whatever else "relaxed SIMD" has, by all names: not every engine knows it. */
const relaxed = /\([a-z]\d+x\d+\.(?:relaxed_|laneselect|dot_i8x16)\w*/;
/** What a module needs besides. */
const features = [
  '--mvp-features',
  '--enable-simd',
  '--enable-nontrapping-float-to-int',
  '--enable-sign-ext',
  '--enable-mutable-globals',
  '--enable-bulk-memory',
];

/**
 * Takes all fused multiply-adds of a module apart into what every engine knows: a product and a sum, which lie where
 * wasm/src/fuse.ts can join them again, as the third operand comes between them.
 * @param module  A file of WebAssembly.
 * @param tool    Gives the path of one of Binaryen's tools.
 * @param out     Where to put `out.wasm` and `out.json`: where in it these products and sums are, each as bytes from the one before.
 */
export function takeApart(module, tool, out) {
  const text = execFileSync(tool('wasm-dis'), [module], { encoding: 'utf8', maxBuffer: 2 ** 28 });
  const other = relaxed.exec(text.replaceAll(fused, ''));
  if (other) throw new Error(`${module}: has ${other[0].slice(1)}, which not every engine knows`);
  const assemble = (product, sum) => {
    writeFileSync(`${out}.wat`, apart(text, product, sum));
    execFileSync(tool('wasm-as'), [...features, `${out}.wat`, '-o', `${out}.wasm`]);
    return readFileSync(`${out}.wasm`);
  };
  // Where two modules differ that have other operations there, of the same size, these operations are.
  const others = assemble('f32x4.div', 'f32x4.sub');
  const plain = assemble('f32x4.mul', 'f32x4.add');
  const sites = [];
  for (let i = 0; i < plain.length; ++i) {
    if (plain[i] !== others[i]) sites.push(i - 1); // of the three bytes of an operation, the second is another
  }
  const expected = 2 * (text.match(fused)?.length ?? 0);
  if (plain.length !== others.length || sites.length !== expected) {
    throw new Error(
      `${module}: ${sites.length} products and sums in ${plain.length} bytes, instead of ${expected} in ${others.length}`,
    );
  }
  writeFileSync(`${out}.json`, JSON.stringify(sites.map((site, i) => site - (sites[i - 1] ?? 0))));
}

function apart(text, product, sum) {
  // From the last on: what is an operand of another is then apart before that is.
  for (const { index, 0: head } of [...text.matchAll(fused)].reverse()) {
    const operands = index + head.length;
    const third = operandEnd(text, operandEnd(text, operands));
    text = `${text.slice(0, index)}(${sum} (${product}${text.slice(operands, third)})${text.slice(third)}`;
  }
  return text;
}

/** Where the first expression in parentheses ends that begins at `from` or later. */
function operandEnd(text, from) {
  let depth = 0;
  for (let i = text.indexOf('(', from); ; ++i) {
    if (text[i] === '(') ++depth;
    if (text[i] === ')' && --depth === 0) return i + 1;
  }
}
