// What any error means: of Redis, of BullMQ, of the system, and what else can be thrown.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { test } from 'node:test';
import { asFailure, Failure, meaningOf, reasonOf, reasons, redisTrouble } from '../../../examples/catalogue/failure.ts';

const bullmq = createRequire(new URL('../../../examples/catalogue/package.json', import.meta.url)).resolve('bullmq');
/** Makes the error of a code, as all of BullMQ does; it is not exported. */
const { finishedErrors } = createRequire(bullmq)('./classes/finished-errors.js') as {
  finishedErrors(of: { code: number; jobId: string; command: string; state: string; parentKey: string }): Error;
};
const { ErrorCode } = createRequire(bullmq)('./enums/error-code.js') as { ErrorCode: Record<string, number | string> };
const codes = Object.values(ErrorCode).filter((code) => typeof code === 'number');

test('each error of BullMQ, whose codes are numbers, is a failure; a lock that is lost may pass, a job that was removed does not', () => {
  assert.ok(codes.length > 5);
  const reasonOfCode = (code: number) =>
    asFailure(finishedErrors({ code, jobId: 'slow-1', command: 'moveToFinished', state: 'active', parentKey: 'k' }));
  for (const code of codes) {
    const { reason, message, mayPass } = reasonOfCode(code);
    const isLock = /Lock/.test(String(ErrorCode[code]));
    const expected = isLock ? 'crash' : ErrorCode[code] === 'JobNotExist' ? 'missing' : 'unexpected';
    assert.deepEqual([reason, mayPass], [expected, isLock], message);
    if (isLock) assert.match(message, /longer than its lock.*CATALOGUE_LOCK/);
  }
  const manager = readFileSync(createRequire(bullmq).resolve('./classes/lock-manager.js'), 'utf8');
  assert.match(manager, /could not renew lock for job /);
  assert.equal(asFailure(new Error('could not renew lock for job slow-1')).reason, 'crash');
  assert.equal(reasonOf('Missing lock for job slow-1. moveToFinished'), 'crash', 'as BullMQ keeps it');
});

test('whatever is thrown is a failure, with a reason and one line', () => {
  const own = (fields: object) => Object.assign(new Error('a text'), fields);
  const around = own({});
  around.cause = around;
  const thrown: unknown[] = [undefined, null, '', 'a text', 7, 7n, Symbol('a'), {}, [], Object.create(null), () => {}];
  thrown.push(new DOMException('a text', 'AbortError'), AbortSignal.abort().reason, around);
  for (const code of [-2, 0, 2 ** 40, NaN, null, {}, [], true, 1n, Symbol('a'), 'toString', '__proto__', 'constructor'])
    thrown.push(own({ code }), { code }, own({ code, message: code }), own({ cause: own({ code }) }));
  for (const error of thrown) {
    const failure = asFailure(error);
    assert.ok(failure instanceof Failure);
    assert.ok(Object.hasOwn(reasons, failure.reason));
    assert.doesNotMatch(failure.message, /\n/);
    assert.equal(redisTrouble(error), undefined);
    assert.equal(typeof meaningOf(error), 'string');
    if (error instanceof Error && error.message === 'a text') assert.equal(failure.message, 'unexpected: a text');
  }
});
