import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { mutantsOf, mutated, shuffled } from './mutations.mjs';

const linesOf = (text: string): string[] => mutantsOf('file.cpp', text).map(({ mutant }) => mutant);

test('an operator becomes its neighbour at the bound, and its opposite', () => {
  assert.deepEqual(linesOf('if (a < b) c();'), ['if (a <= b) c();', 'if (a >= b) c();']);
  assert.deepEqual(linesOf('ok = a == b && c;'), ['ok = a != b && c;', 'ok = a == b || c;']);
  assert.deepEqual(linesOf('x = a +\n    b;'), ['x = a -']);
});

test('a minimum becomes a maximum, a number one more and one less, a length double and half', () => {
  assert.deepEqual(linesOf('std::min(a, b);'), ['std::max(a, b);']);
  assert.deepEqual(linesOf('simd::max(a, b);'), ['simd::min(a, b);']);
  assert.deepEqual(linesOf('i += 2;'), ['i += 3;', 'i += 1;']);
  assert.deepEqual(linesOf('i = 0u;'), ['i = 1u;']);
  assert.deepEqual(linesOf('k = 5e-6f;'), ['k = (2 * 5e-6f);', 'k = (0.5f * 5e-6f);']);
});

test('comments, texts, includes, pointers, templates and sizes of arrays stay as they are', () => {
  for (const line of [
    '// a < b and 2',
    '/* 1\n 2 */ f();',
    '#include <array2>',
    'f("1 < 2");',
    "f('2');",
    'List<float> x;',
    'const T* p; T&& q; --i; -x;',
    'float low[4];',
    'std::array<int, 3> x;',
    'static_assert(sizeof(x) == 4);',
    'simd::f32x4 x;',
  ])
    assert.deepEqual(linesOf(line), [], line);
});

test('a mutant differs in its own place alone', () => {
  const text = 'a = 1;\nb = c * 2;\n';
  const found = mutantsOf('file.cpp', text).map((mutant) => mutated(text, mutant));
  assert.deepEqual(found, [
    'a = 2;\nb = c * 2;\n',
    'a = 0;\nb = c * 2;\n',
    'a = 1;\nb = c / 2;\n',
    'a = 1;\nb = c * 3;\n',
    'a = 1;\nb = c * 1;\n',
  ]);
});

test('a seed stands for an order', () => {
  const values = Array.from({ length: 100 }, (_, i) => i);
  assert.deepEqual(shuffled(values, 1), shuffled(values, 1));
  assert.notDeepEqual(shuffled(values, 1), shuffled(values, 2));
  assert.deepEqual(
    shuffled(values, 1).sort((a, b) => a - b),
    values,
  );
});

test('each mutant that is explained can still be made', () => {
  const groups = JSON.parse(readFileSync(new URL('equivalent.json', import.meta.url), 'utf8'));
  for (const { reason, mutants } of groups) {
    assert.ok(reason.length > 20);
    for (const [file, line, mutant] of mutants) {
      const source = new URL(`../../core/src/${file}`, import.meta.url);
      assert.ok(existsSync(source), file);
      const all = mutantsOf(file, readFileSync(source, 'utf8'));
      assert.ok(
        all.some((one) => one.line === line && one.mutant === mutant),
        `${file}: ${line}`,
      );
    }
  }
});
