import { kVerdicts } from '../../inspect/finding.js';
import { InputError, naming } from '../../scene/input-error.js';
import { readBytes } from '../io/files.js';
import { isObject, parseObject } from '../model/json.js';
import { shown } from '../model/text.js';
import { kZoneNames } from '../model/zones.js';
import type { InspectionReport } from '../transfer/inspection.js';
import type { Report } from '../transfer/report.js';

/** What of a report is compared; reports of `transfer` and of `inspect --json` have some of it each. */
export type AnyReport = Pick<Report, 'target' | 'segments'> &
  Partial<Omit<Report, 'target' | 'segments'>> &
  Partial<Omit<InspectionReport, 'target' | 'segments' | 'cage' | 'options' | 'versions' | 'counts'>>;

/** Checks a value. @param place  Its name in messages. @throws {InputError} with the value and the expected kind. */
type Check = (value: unknown, place: string) => void;

/** Returns a check by a test. @param called  What passes it. */
const kind =
  (called: string, passes: (value: unknown) => boolean): Check =>
  (value, place) => {
    if (passes(value)) return;
    throw new InputError(`${place} is ${value === undefined ? 'missing' : `${shown(value)}, not ${called}`}`);
  };
const number = kind('a number from 0 on', (value) => Number.isFinite(value) && (value as number) >= 0);
const text = kind('a text', (value) => typeof value === 'string');
const flag = kind('true or false', (value) => typeof value === 'boolean');
const verdict = kind(`one of ${kVerdicts.join(', ')}`, (value) => (kVerdicts as readonly unknown[]).includes(value));
const anObject = kind('an object', isObject);
const anArray = kind('an array', Array.isArray);

const optional =
  (check: Check): Check =>
  (value, place) =>
    value === undefined ? undefined : check(value, place);
const orNull =
  (check: Check): Check =>
  (value, place) =>
    value === null ? undefined : check(value, place);
const arrayOf =
  (check: Check): Check =>
  (value, place) => {
    anArray(value, place);
    for (const [i, one] of (value as unknown[]).entries()) check(one, `${place}[${i}]`);
  };
const objectOf =
  (members: Record<string, Check>): Check =>
  (value, place) => {
    anObject(value, place);
    for (const [name, check] of Object.entries(members))
      check((value as Record<string, unknown>)[name], place === '' ? name : `${place}.${name}`);
  };

const zones = Object.fromEntries(kZoneNames.map((zone) => [zone, number]));
const triangles = objectOf({ total: number, cosmetic: number });
/** What is compared. */
const checkReport = objectOf({
  target: objectOf({ vertices: number, triangles: number, diagonal: number }),
  segments: arrayOf(objectOf({ part: text, area: number, exposedArea: number, coveredArea: number, culled: flag })),
  areas: optional(objectOf({ total: number, ...zones })),
  coverage: optional(objectOf(zones)),
  triangles: optional(triangles),
  stretch: optional(orNull(objectOf({ median: number, overTwice: number }))),
  parts: optional(arrayOf(objectOf({ splitVertices: orNull(number), cutTriangles: orNull(number) }))),
  regions: optional(arrayOf(objectOf({ counts: objectOf(zones), triangles }))),
  // JSON has null for a distance without end.
  placement: optional(
    objectOf({
      outside: objectOf({ area: number }),
      distances: objectOf({ p50: orNull(number), p99: orNull(number) }),
    }),
  ),
  uv: optional(objectOf({ used: number, charts: number, overlap: objectOf({ share: number }) })),
  holes: optional(anArray),
  verdict: optional(verdict),
});

/** Reads a report. @throws {InputError} that names the file and what of it cannot be compared. */
export function readReport(path: string): Promise<AnyReport> {
  return naming(path, async () => {
    const report = parseObject(new TextDecoder().decode(await readBytes(path)));
    naming('is no report of cagecast transfer (--report) or inspect (--json)', () => {
      checkReport(report, '');
      if (report['coverage'] === undefined) anObject(report['areas'], 'areas');
    });
    return report as unknown as AnyReport;
  });
}
