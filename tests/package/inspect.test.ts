import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { before, describe, test } from 'node:test';
import { type FindingCode, type Inspection, init, inspect, type Mesh, project, transfer } from 'cagecast';
import { surestThreshold } from '../../wasm/src/inspect/surest-threshold.js';
import { ball, head, join3d, within } from './scenes.js';

before(init);

type Whole = { [K in keyof Omit<Mesh, 'poses' | 'names' | 'otherUvSets'>]-?: NonNullable<Mesh[K]> };
const { cage, target: unnamed } = head(1, 16) as { cage: Whole; target: Whole };
const target = { ...unnamed, names: ['skin', 'eye', 'tongue'] };
const look = (changed: Partial<Mesh>, on: Mesh = target): Inspection => inspect({ ...cage, ...changed }, on);
const codes = ({ findings }: Inspection): FindingCode[] => findings.map(({ code }) => code);
const find = ({ findings }: Inspection, code: FindingCode) => findings.find((finding) => finding.code === code)!;
const moved = (by: (p: [number, number, number]) => readonly number[]): Float32Array => {
  const out = cage.positions.slice();
  for (let v = 0; v < out.length; v += 3) out.set(by([out[v]!, out[v + 1]!, out[v + 2]!]), v);
  return out;
};
const diagonal = (() => {
  const extent = (k: number) => {
    const values = [...target.positions].filter((_, i) => i % 3 === k);
    return Math.max(...values) - Math.min(...values);
  };
  return Math.hypot(extent(0), extent(1), extent(2));
})();

describe('inspect', () => {
  test('UVs that go round the texture many times cost no more than others', () => {
    const cpu = (uvs: Float32Array) => {
      const from = process.cpuUsage();
      look({ uvs });
      const { user, system } = process.cpuUsage(from);
      return user + system;
    };
    cpu(cage.uvs); // compiles
    const usual = cpu(cage.uvs);
    // Each triangle covers the texture a hundred times, and from -8 to 9 they do not count as pixels.
    const vast = cpu(cage.uvs.map((_, i) => 17 * ((Math.floor(i / 2) * (i % 2 ? 0.618 : 0.382)) % 1) - 8));
    assert.ok(vast < 10 * usual, `${vast} µs, ${usual} for others`);
  });

  test('each segment says how sure its verdict is, as the transfer does, and the surest threshold is far from all coverages', () => {
    const { segmentStats } = transfer(cage, target);
    const { segments } = look({});
    assert.deepEqual(
      segments.map(({ confidence }) => confidence),
      segmentStats.map(({ confidence }) => confidence),
    );
    for (const { score, confidence } of segmentStats) assert.equal(confidence, 1 - Math.min(score, 1 / score) ** 4 / 2);
    const of = (...coverages: number[]) => coverages.map((coverage) => ({ coverage, exposedArea: 1 }));
    assert.equal(surestThreshold(of(0.1, 0.8, 0.9)), Math.sqrt(0.1 * 0.8));
    assert.equal(surestThreshold([...of(0.1, 0.8), { coverage: 0.3, exposedArea: 1e-5 }]), Math.sqrt(0.1 * 0.8));
    assert.equal(surestThreshold([]), 0.5);
    assert.equal(look({}).surestThreshold, surestThreshold(segmentStats));
  });

  test('a part that hides more than a third of the rest is named, with what leaves it out', () => {
    const visor = ball([0, 0, 0], () => 1.12, 12, 24);
    const on = { ...join3d(target, visor), names: ['head', 'Visor'] };
    const groups = Uint32Array.from({ length: on.positions.length / 3 }, (_, v) => +(v >= target.positions.length / 3));
    const { findings } = inspect(cage, { ...on, groups }, {});
    assert.ok(
      !inspect(cage, { ...on, groups }, { parts: { ignore: ['visor'] } }).findings.some(
        ({ code }) => code === 'muchHidden',
      ),
    );
    const { sentence, ignore } = findings.find(({ code }) => code === 'muchHidden')!;
    assert.deepEqual(
      [sentence.replace(/[\d.]+ %/, 'n %'), ignore],
      ['"Visor" hides n % of the rest, which could be painted without it', ['Visor']],
    );
  });

  test('loose pieces that hide the main one of their part are a finding, clothes over a body that shows are none', () => {
    const skin = ball([0, 0, 0], () => 1, 24, 48);
    const around = ball([0, 0, 0], () => 1.2, 16, 24);
    const hides = (...shells: Mesh[]) =>
      inspect(around, { ...join3d(skin, ...shells), groups: undefined, names: ['Human'] }).findings.find(
        ({ code }) => code === 'muchHidden',
      );
    const shell = ball([0, 0, 0], () => 1.06, 12, 16);
    const half = (isKept: (x: number, y: number, z: number) => boolean) => within(shell, isKept);
    // Two shells together, neither of which hides much by itself.
    for (const shells of [[shell], [half((_, y) => y > -0.1), half((_, y) => y < 0.1)]]) {
      const { sentence, advice, ignore, places } = hides(...shells)!;
      assert.match(
        sentence,
        /^Loose pieces of "Human" hide \d+\.\d % of its main piece, which could be painted without/,
      );
      assert.match(advice, /delete them in the file/);
      assert.deepEqual([ignore, places!.map(({ segment }) => segment)], [undefined, [0]]);
    }
    assert.equal(hides(half((_, y) => y < 0.1)), undefined);
    assert.equal(hides(), undefined);
  });

  test('a bare face is the first finding, if it is known where the eyes are', () => {
    const skin = ball([0, 0, 0], () => 1, 24, 48);
    const shell = ball([0, 0, 0], () => 1.1, 16, 24) as Whole;
    const landmarks = { eye_centre_left: [0.25, 0.1, 0.85], eye_centre_right: [-0.25, 0.1, 0.85] } as const;
    assert.equal(find(inspect(shell, skin, { landmarks }), 'faceBare'), undefined);
    const isFace = (i: number) => {
      const [x, y, z] = [0, 1, 2].map((k) => shell.positions[3 * shell.indices[i - (i % 3)]! + k]!);
      return Math.hypot(x!, y!) < 0.6 && z! > 0;
    };
    const open = { ...shell, indices: shell.indices.filter((_, i) => !isFace(i)) };
    const { verdict, findings } = inspect(open, skin, { landmarks });
    assert.deepEqual([verdict, findings[0]!.code], ['unfit', 'faceBare']);
    assert.match(findings[0]!.sentence, /^The face is left bare: \d+(\.\d+)? % of what is seen of "group 0" there$/);
    assert.equal(find(inspect(open, skin), 'faceBare'), undefined);
  });

  const eyes = { eye_centre_left: [0.25, 0.1, 0.85], eye_centre_right: [-0.25, 0.1, 0.85] } as const;
  const skin = ball([0, 0, 0], () => 1, 24, 48);
  /** A shell whose poles are above and below. @param side  Where its UVs meet: -1 is behind. */
  const shellTo = (side: number): Whole => {
    const shell = ball([0, 0, 0], () => 1.1, 32, 64) as Whole;
    const { positions: p } = shell;
    return {
      ...shell,
      positions: p.map((_, i) => [side * p[i + 1]!, p[i + 1]!, side * p[i - 2]!][i % 3]!),
    };
  };

  test('eyes that are painted, and those that nothing tells of, keep a figure from being good', () => {
    const shell = shellTo(-1);
    const painted = inspect(shell, skin, { landmarks: eyes });
    assert.deepEqual([painted.verdict, find(painted, 'eyesPainted').numbers], ['usable', { left: 1, right: 1 }]);
    assert.deepEqual(codes(inspect(shell, skin, { landmarks: { nose_tip: [0, 0, 1] } })), ['eyesUnknown']);
    assert.equal(inspect(shell, skin, { landmarks: { wheel_front_centre_left: [0, 0, 1] } }).verdict, 'good');
    // Two pieces before the skin are eyes, and can be kept bare.
    const one = ([x, y, z]: readonly number[]) => ball([x!, y!, z! + 0.08], () => 0.12, 12, 24);
    const eyed = join3d(skin, one(eyes.eye_centre_left), one(eyes.eye_centre_right));
    const { locks } = find(inspect(shell, eyed, { landmarks: eyes }), 'eyesPainted');
    assert.deepEqual(locks, { 1: 'exclude', 2: 'exclude' });
    assert.deepEqual(codes(inspect(shell, eyed, { landmarks: eyes, locks })), []);
    // What is one part with the skin cannot be kept bare by its name.
    const fused = { ...eyed, groups: new Uint32Array(eyed.groups!.length) };
    assert.equal(find(inspect(shell, fused, { landmarks: eyes }), 'eyesPainted').locks, undefined);
  });

  test('a car whose windows no part is called keeps a cage from being good', () => {
    const [shell, wheel] = [shellTo(-1), ball([0, 0, 0], () => 0.1, 4, 8)];
    const car = {
      ...join3d(skin, wheel, wheel, wheel, wheel),
      names: ['body', 'wheel-1', 'wheel-2', 'wheel-3', 'wheel-4'],
    };
    assert.deepEqual(find(inspect(shell, car), 'windowsUnknown').numbers, { wheels: 4 });
    assert.equal(
      find(inspect(shell, { ...car, names: ['body', 'wheel', 'wheel', 'wheel', 'glass'] }), 'windowsUnknown'),
      undefined,
    );
    assert.equal(
      find(inspect(shell, { ...car, names: ['body', 'wheel', 'wheel', 'bell', 'fork'] }), 'windowsUnknown'),
      undefined,
    );
  });

  test('a seam down the face keeps a cage from being good, one behind does not', () => {
    const look = (side: number) => codes(inspect(shellTo(side), skin, { landmarks: eyes }));
    assert.deepEqual(look(-1), ['eyesPainted']);
    assert.deepEqual(look(1), ['eyesPainted', 'faceSeam']);
    // What is not painted shows no seam.
    const bare = inspect(shellTo(1), skin, { landmarks: eyes, parts: { exclude: [0] } });
    assert.ok(!codes(bare).includes('faceSeam'));
  });

  test('a bare patch of the skin keeps a face from being good, but not where eyes and mouth are', () => {
    const around = shellTo(-1);
    const { positions: p } = around;
    const patched = (x: number, y: number) => {
      const isNear = (v: number) => Math.hypot(p[3 * v]! - x, p[3 * v + 1]! - y) < 0.1 && p[3 * v + 2]! > 0;
      const indices = around.indices.filter((_, i, all) => !isNear(all[i - (i % 3)]!));
      return inspect({ ...around, indices }, skin, { landmarks: eyes });
    };
    const { numbers, sentence } = find(patched(0.3, -0.3), 'skinBare');
    assert.ok((numbers['share'] as number) > 0.01 && (numbers['share'] as number) < 0.1, sentence);
    for (const [x, y] of [
      [0.25, 0.1],
      [0, -0.4],
    ] as const)
      assert.equal(find(patched(x, y), 'skinBare'), undefined);
  });

  test('so does a bare collar on a painted body, but not below the cage of a head', () => {
    const chest = ball([0, -1.8, 0], () => 1, 24, 48);
    const collar = ball([0, -0.95, 0.9], () => 0.12, 12, 24);
    const figure = join3d(skin, chest, collar);
    const whole = join3d(
      shellTo(-1),
      ball([0, -1.8, 0], () => 1.1, 16, 24),
    );
    const { sentence, places } = find(inspect(whole, figure, { landmarks: eyes }), 'skinBare');
    assert.match(sentence, /^Patches below the chin are left bare, though the chest is painted: .* most of "group 2"$/);
    assert.equal(places![0]!.segment, 2);
    const chosen = inspect(whole, figure, { landmarks: eyes, parts: { exclude: [2] } });
    assert.equal(find(chosen, 'skinBare'), undefined);
    assert.equal(find(inspect(shellTo(-1), figure, { landmarks: eyes }), 'skinBare'), undefined);
  });

  test('a hand or an ear that stays bare beside painted skin is named', () => {
    /** A ball stretched along x, around an arm from -4 to 4. */
    const along = (radius: number, rings: number): Whole => {
      const one = ball([0, 0, 0], () => 1, rings, rings) as Whole;
      return { ...one, positions: one.positions.map((x, i) => (i % 3 === 0 ? 4 * radius * x : 0.5 * radius * x)) };
    };
    const [arm, sleeve] = [along(1, 48), along(1.1, 32)];
    const joints = { joint_elbow_left: [0, 0, 0], joint_wrist_left: [2.5, 0, 0] } as const;
    const short = within(sleeve, (x) => x < 2.6);
    const { sentence } = find(inspect(short, arm, { landmarks: joints }), 'limbsBare');
    assert.equal(sentence, 'Bare beside what is painted: left hand');
    assert.equal(find(inspect(sleeve, arm, { landmarks: joints }), 'limbsBare'), undefined);
    assert.equal(find(inspect(short, arm, { landmarks: eyes }), 'limbsBare'), undefined);
    const chosen = inspect(short, arm, { landmarks: joints, parts: { exclude: [0] } });
    assert.equal(find(chosen, 'limbsBare'), undefined);
    const ear = { ear_top_left: [1.2, 0.2, 0], ear_lobe_left: [1.2, -0.2, 0] } as const;
    const both = join3d(
      skin,
      ball([1.2, 0, 0], () => 0.2, 12, 24),
    );
    assert.match(find(inspect(shellTo(-1), both, { landmarks: ear }), 'limbsBare').sentence, /: left ear$/);
  });

  test('pieces that almost touch are found, with the tolerance that joins them', () => {
    // Each triangle has corners of its own, off by noise.
    const torn: Mesh = {
      positions: Float32Array.from({ length: 3 * target.indices.length }, (_, i) => {
        const value = target.positions[3 * target.indices[Math.floor(i / 3)]! + (i % 3)]!;
        return value + 2e-7 * diagonal * Math.sin(i * i);
      }),
      indices: target.indices.map((_, i) => i),
      groups: Uint32Array.from(target.indices, (vertex) => target.groups[vertex]!),
    };
    const { sentence, numbers } = find(inspect(cage, torn), 'piecesApart');
    assert.match(sentence, /^The target is in [\d,]+ pieces that almost touch, .* 3 are left$/);
    assert.equal(numbers['weldTolerance'], 1e-6);
    const { weldTolerance } = numbers as { weldTolerance: number };
    assert.ok(!codes(inspect(cage, torn, { weldTolerance })).includes('piecesApart'));
    assert.equal(inspect(cage, torn, { weldTolerance }).verdict, 'good');
  });

  test('a cage that fits is good, and is described', () => {
    const inspection = look({});
    assert.equal(inspection.verdict, 'good', JSON.stringify(inspection.findings));
    assert.equal(inspection.topology.pieces, 1);
    assert.deepEqual(inspection.inward, { share: 0, triangles: [] });
    assert.equal(inspection.inside.vertices, 0);
    assert.equal(inspection.placement.outside.vertices, 0);
    const [hole, ...others] = inspection.holes;
    assert.equal(others.length, 0);
    assert.equal(hole!.kind, 'hole');
    assert.ok(
      hole!.beneath.some(({ part }) => part === 'eye'),
      JSON.stringify(hole),
    );
    assert.deepEqual(
      inspection.segments.map(({ part }) => part),
      ['skin', 'eye', 'tongue'],
    );
    // One chart round a ball, cut along a meridian; its poles are fans.
    assert.equal(inspection.uv.charts, 1);
    assert.ok(inspection.uv.seams.edges > 0);
    assert.ok(inspection.uv.used > 0.8 && inspection.uv.used <= 1);
    assert.equal(inspection.uv.overlap.share, 0);
  });

  test('takes an existing result, and gives plain data', () => {
    const result = transfer(cage, target);
    const again = inspect(cage, target, { result });
    assert.deepEqual(again, look({}));
    assert.deepEqual(structuredClone(again), again);
    assert.deepEqual(
      inspect(cage, unnamed).segments.map(({ part }) => part),
      ['group 0', 'group 1', 'group 2'],
    );
  });

  test('findings have a sentence, an advice and numbers, the most severe first', () => {
    const { findings, verdict } = look({
      positions: moved((p) => p.map((x) => 0.9 * x)),
      uvs: cage.uvs.map((x) => x + 0.5),
    });
    assert.equal(verdict, 'unfit');
    assert.ok(findings.length > 1);
    findings.forEach(({ weight, sentence, advice, numbers }, i) => {
      assert.ok(weight <= (findings[i - 1]?.weight ?? Infinity));
      assert.match(sentence, /^[A-Z0-9].*[^.]$/);
      assert.match(advice, /^[A-Z].*\.$/);
      for (const value of Object.values(numbers).flat()) assert.ok(Number.isFinite(value));
    });
  });
});

describe('a cage out of place', () => {
  test('moved: by how much, and back', () => {
    for (const axis of [0, 1, 2]) {
      const by = 0.08 * diagonal;
      const inspection = look({ positions: moved((p) => p.map((x, k) => (k === axis ? x + by : x))) });
      assert.equal(inspection.verdict, 'unfit');
      assert.equal(codes(inspection)[0], 'cageMisplaced');
      const { move } = inspection.placement.correction;
      assert.ok(Math.abs(move[axis]! + 0.08) < 0.02, `axis ${axis}: ${move.join()}`);
      for (const other of [0, 1, 2]) if (other !== axis) assert.ok(Math.abs(move[other]!) < 0.02, move.join());
    }
  });

  test('turned: the correction turns it back', () => {
    // A long head, so that a turn can be seen.
    const long = (mesh: Whole): Whole => ({
      ...mesh,
      positions: mesh.positions.map((x, i) => (i % 3 === 0 ? 2 * x : x)),
    });
    const [wide, around] = [long(target), long(cage)];
    const angle = (20 * Math.PI) / 180;
    const turned = around.positions.slice();
    for (let v = 0; v < turned.length; v += 3) {
      turned[v] = around.positions[v]! * Math.cos(angle) - around.positions[v + 1]! * Math.sin(angle);
      turned[v + 1] = around.positions[v]! * Math.sin(angle) + around.positions[v + 1]! * Math.cos(angle);
    }
    const inspection = inspect({ ...around, positions: turned }, wide);
    assert.equal(inspection.verdict, 'unfit');
    assert.equal(codes(inspection)[0], 'cageMisplaced');
    const { turn } = inspection.placement.correction;
    assert.ok(turn[2] < -10 && turn[2] > -30, turn.join());
  });

  test('too small, too large, elsewhere', () => {
    const scaled = (by: number) => look({ positions: moved((p) => p.map((x) => by * x)) });
    for (const [by, code] of [
      [0.8, 'cageTooSmall'],
      [3, 'cageTooFar'],
      [100, 'cageTooFar'],
    ] as const)
      assert.equal(codes(scaled(by))[0], code);
    assert.ok(scaled(0.8).inside.area > 0.5);
    assert.equal(scaled(1e-20).verdict, 'unfit', 'however tiny, it is no error');
    assert.equal(codes(look({ positions: moved(([x, y, z]) => [x + 50, y, z]) }))[0], 'cageElsewhere');
  });

  test('a cage may lie inside of what is never painted, however much that is', () => {
    const hood = within(
      ball([0, 0, 0], () => 1.2, 12, 24),
      (_x, _y, z) => z < 0.9,
    );
    const groups = Uint32Array.from({ length: (target.positions.length + hood.positions.length) / 3 }, (_, v) =>
      v < target.groups.length ? target.groups[v]! : 3,
    );
    const whole = { ...join3d(target, hood), groups, names: [...target.names, 'hood'] };
    const [all, bare] = [{}, { parts: { exclude: ['hood'] } }].map((options) => inspect(cage, whole, options));
    assert.ok(all!.inside.area > 0.5 && all!.placement.outside.exposedArea > 0.5);
    assert.deepEqual([bare!.inside.vertices, bare!.placement.outside.exposedArea], [0, 0]);
  });

  test('a ground that is part of the target is named, and that it makes lengths too coarse', () => {
    const onGround = (half: number): Whole => {
      const first = target.positions.length / 3;
      const [low, high] = [-half * diagonal, half * diagonal];
      const ground = [low, low, low, high, low, low, high, low, high, low, low, high];
      return {
        ...target,
        positions: Float32Array.of(...target.positions, ...ground),
        indices: Uint32Array.of(...target.indices, first, first + 2, first + 1, first, first + 3, first + 2),
        uvs: new Float32Array((2 * (target.positions.length + 12)) / 3),
        groups: Uint32Array.of(...target.groups, 7, 7, 7, 7),
      };
    };
    const names = [...target.names, ...Array(4).fill(''), 'Ground'];
    const look = (half: number) => inspect(cage, { ...onGround(half), names });
    assert.ok(!codes(look(1)).includes('targetTooLarge'));
    for (const [half, verdict] of [
      [15, 'usable'],
      [60, 'unfit'],
    ] as const) {
      const inspection = look(half);
      assert.equal(inspection.verdict, verdict, JSON.stringify(inspection.findings));
      assert.ok(!codes(inspection).includes('cageElsewhere'));
      const { sentence, places } = find(inspection, 'targetTooLarge');
      assert.match(sentence, /^The target is \d+ times as large as what is painted of it; "Ground" is farthest away$/);
      assert.deepEqual(places, [{ segment: 3, group: 7, part: 'Ground' }]);
    }
  });

  test('the verdict does not depend on the unit', () => {
    for (const scale of [1e-3, 1e3]) {
      const by = (mesh: Whole) => ({ ...mesh, positions: mesh.positions.map((x) => scale * x) });
      for (const shift of [0, 0.1]) {
        const there = { ...cage, positions: moved(([x, y, z]) => [x + shift * diagonal, y, z]) };
        assert.deepEqual(codes(inspect(by(there), by(target))), codes(inspect(there, target)));
      }
    }
  });
});

describe('a cage for a part of the target', () => {
  const tube = (x: number, length: number, radius: number): Whole => {
    const mesh = ball([0, 0, 0], () => 1, 24, 24) as Whole;
    return {
      ...mesh,
      positions: mesh.positions.map((value, i) =>
        i % 3 === 0 ? x + radius * value : i % 3 === 1 ? radius * value : length * value,
      ),
    };
  };

  test('a sleeve on an arm beside a body: the flank, which is near, does not count as outside', () => {
    const body = join3d(tube(0, 1.4, 0.5), tube(0.75, 0.8, 0.12));
    const around = tube(0.75, 0.8, 0.16);
    const sleeve = within(around, (_, __, z) => Math.abs(z) < 0.6);
    const inspection = inspect(sleeve, body);
    assert.ok(inspection.placement.outside.area < 0.1, 'the flank is beyond');
    assert.notEqual(inspection.verdict, 'unfit', JSON.stringify(inspection.findings));
    // The same sleeve, too thin.
    const thin = { ...sleeve, positions: tube(0.75, 0.8, 0.09).positions };
    assert.equal(codes(inspect(thin, body))[0], 'cageTooSmall');
  });

  test('a cap: what lies beyond its border does not count', () => {
    const cap = within(cage, (_, __, z) => z > 0.6);
    assert.notEqual(inspect(cap, target).verdict, 'unfit');
    // If it does: the segment does not pass, and the reason.
    const steps = { holes: false };
    const inspection = inspect(cap, target, { steps });
    assert.match(
      find(inspection, 'nothingToPaint').sentence,
      /covers \d+\.\d % of the exposed area of "skin", less than the threshold of 0\.5/,
    );
    // At a lower threshold it is the floor that it misses.
    assert.match(
      find(inspect(cap, target, { threshold: 0.05, steps }), 'nothingToPaint').sentence,
      /and it has 0\.\d+ times the required covered area/,
    );
    assert.notEqual(inspect(cap, target, { threshold: 0.05, steps: { ...steps, floor: false } }).verdict, 'unfit');
    const { locks } = find(inspection, 'nothingToPaint');
    assert.notEqual(inspect(cap, target, { steps, locks }).verdict, 'unfit', 'as the advice says');
  });
});

describe('normals', () => {
  test('all turned inward: this is the only finding, and the rest is judged as if they were flipped', () => {
    const indices = cage.indices.map((_, i, all) => all[i % 3 === 0 ? i : i - (i % 3) + 3 - (i % 3)]!);
    const inspection = look({ indices });
    assert.equal(inspection.verdict, 'unfit');
    assert.equal(codes(inspection)[0], 'normalsInward');
    assert.ok(Math.abs(inspection.inward.share - 1) < 1e-9);
    assert.deepEqual(inspection.placement, look({}).placement);
  });

  test('a few turned inward are found, and which', () => {
    const indices = cage.indices.slice();
    for (const t of [20, 21, 22]) [indices[3 * t], indices[3 * t + 1]] = [indices[3 * t + 1]!, indices[3 * t]!];
    const inspection = look({ indices });
    assert.deepEqual(inspection.inward.triangles, [20, 21, 22]);
    assert.equal(find(inspection, 'normalsInward').numbers['triangles'], 3);
    assert.equal(inspection.verdict, 'usable');
  });

  test('flat pieces are judged by the target', () => {
    const plate = (z: number): Whole => {
      const [positions, uvs, indices]: [number[], number[], number[]] = [[], [], []];
      for (let i = 0; i < 81; ++i) {
        const [x, y] = [(i % 9) / 8, Math.floor(i / 9) / 8];
        positions.push(x, y, z);
        uvs.push(x, y);
      }
      for (let y = 0; y < 8; ++y)
        for (let x = 0; x < 8; ++x)
          indices.push(9 * y + x, 9 * y + x + 1, 9 * y + x + 10, 9 * y + x, 9 * y + x + 10, 9 * y + x + 9);
      return {
        positions: new Float32Array(positions),
        uvs: new Float32Array(uvs),
        indices: new Uint32Array(indices),
        groups: new Uint32Array(81),
      };
    };
    const above = plate(0.05);
    assert.equal(inspect(above, plate(0)).inward.share, 0);
    assert.ok(inspect({ ...above, indices: above.indices.slice().reverse() }, plate(0)).inward.share > 1 - 1e-9);
  });
});

describe('the surface', () => {
  const triangles = (...more: number[]) => ({ indices: Uint32Array.from([...cage.indices, ...more]) });
  const fin = {
    groups: undefined,
    positions: Float32Array.from([...cage.positions, 3, 3, 3]),
    uvs: Float32Array.from([...cage.uvs, 0.5, 0.5]),
    ...triangles(100, 101, cage.positions.length / 3),
  };
  // The meridian where the UVs meet: the last column of every ring is moved by a hair.
  const cracked = cage.positions.slice();
  for (let ring = 1; ring < 10; ++ring) cracked[3 * (19 * ring + 18) + 1]! += 1e-6;
  const [flat, doubled] = [triangles(5, 5, 6), triangles(...cage.indices.slice(60, 90))];
  const cases: Record<string, [Partial<Mesh>, verdict: string, FindingCode | undefined, topology: object]> = {
    'a triangle without area': [flat, 'good', undefined, { degenerateTriangles: 1 }],
    'doubled triangles': [doubled, 'usable', 'doubledTriangles', { doubledTriangles: 10, nonManifoldEdges: 0 }],
    'two-sided triangles': [triangles(...cage.indices.slice().reverse()), 'usable', 'doubledTriangles', { pieces: 1 }],
    'a fin: an edge of three triangles': [fin, 'usable', 'nonManifoldEdges', { nonManifoldEdges: 1 }],
    'a seam that does not meet': [{ positions: cracked }, 'usable', 'cracks', {}],
  };
  for (const [name, [change, verdict, code, topology]] of Object.entries(cases))
    test(name, () => {
      const inspection = look(change);
      assert.equal(inspection.verdict, verdict, JSON.stringify(inspection.findings));
      if (code) assert.ok(codes(inspection).includes(code), codes(inspection).join());
      assert.deepEqual({ ...inspection.topology, ...topology }, inspection.topology);
      assert.equal(inspection.topology.crackEdges >= 8, code === 'cracks');
      if (code !== 'nonManifoldEdges')
        assert.equal(inspection.holes.length, code === 'cracks' ? inspection.holes.length : 1);
      assert.ok(!codes(inspection).includes('normalsInward'));
    });

  test('a single open edge has nothing beneath it', () => {
    const corners = Array.from(
      { length: cage.indices.length / 3 },
      (_, t) => [...cage.indices.slice(3 * t, 3 * t + 3)] as [number, number, number],
    );
    let lone = 0; // the others meet the hole's border
    for (let t = 100; t < 110; ++t) {
      // Half of two triangles that share an edge, cut the other way: only the cut is new.
      const [a, b, c] = corners[t]!;
      const next = corners.find((other) => !other.includes(a) && other.includes(b) && other.includes(c))!;
      const { holes, topology } = look({
        indices: Uint32Array.from([...cage.indices, a, b, next.find((v) => v !== b && v !== c)!]),
      });
      lone += topology.slits;
      assert.ok(
        holes.every(({ beneath }) => beneath.every(({ share }) => share > 0 && share <= 1.001)),
        JSON.stringify(holes),
      );
    }
    assert.ok(lone > 0);
  });
});

describe('UVs', () => {
  const laid = (change: (x: number, k: number) => number) => look({ uvs: cage.uvs.map((x, i) => change(x, i % 2)) });

  test('outside 0..1, without area, mirrored', () => {
    const tile = laid((x, k) => (k === 0 ? x + 1 : x));
    assert.equal(tile.verdict, 'usable');
    assert.ok(tile.uv.outside.share > 0.9);
    const [pixels, point] = [laid((x) => 1024 * x), laid(() => 0.5)];
    assert.deepEqual([pixels.verdict, codes(pixels)[0]], ['unfit', 'uvsOutside']);
    assert.deepEqual([point.verdict, codes(point)[0]], ['unfit', 'uvsWithoutArea']);
    assert.ok(point.uv.withoutArea.share > 0.999);
    const { verdict, uv } = laid((x, k) => (k === 0 ? Math.min(x, 1 - x) : x));
    assert.equal(verdict, 'usable');
    // All but the hole, which has no mirror image, and the serrations at the poles.
    assert.ok(uv.overlap.share > 0.75 && uv.overlap.layers === 2, JSON.stringify(uv.overlap));
  });

  test('every triangle a chart of its own', () => {
    const corners = [...cage.indices];
    const side = Math.ceil(Math.sqrt(corners.length / 3));
    const crumbs: Mesh = {
      positions: Float32Array.from(corners.flatMap((v) => [...cage.positions.subarray(3 * v, 3 * v + 3)])),
      indices: Uint32Array.from(corners.keys()),
      uvs: Float32Array.from(
        corners.flatMap((_, i) => {
          const t = Math.floor(i / 3);
          return [
            ((t % side) + [0.1, 0.9, 0.1][i % 3]!) / side,
            (Math.floor(t / side) + [0.1, 0.1, 0.9][i % 3]!) / side,
          ];
        }),
      ),
    };
    const inspection = inspect(crumbs, target);
    assert.equal(inspection.uv.charts, corners.length / 3);
    assert.equal(inspection.uv.overlap.share, 0);
    assert.equal(inspection.verdict, 'usable');
    assert.ok(codes(inspection).includes('uvsInPieces'));
  });
});

describe('holes and segments', () => {
  test('a hole over skin alone is reported', () => {
    const skin = ball([0, 0, 0], () => 1, 24, 48);
    const inspection = inspect(cage, skin);
    assert.ok(codes(inspection).includes('holeUnexplained'), JSON.stringify(inspection.holes));
    assert.equal(inspection.verdict, 'usable');
  });

  test('a border over nothing is an end of the cage', () => {
    // The lower half of both is gone.
    const upper = (mesh: Mesh): Mesh => within(mesh, (_, __, z) => z > -0.05);
    const shell = ball([0, 0, 0], () => 1.1, 16, 24);
    const { holes } = inspect(upper(shell), upper(ball([0, 0, 0], () => 1, 16, 24)));
    assert.deepEqual(
      holes.map(({ kind }) => kind),
      ['end'],
    );
  });
});

test('a target of one triangle, and one without area, can be looked at', () => {
  const tiny: Mesh = {
    positions: new Float32Array([0, 0, 0, 0.1, 0, 0, 0, 0.1, 0]),
    indices: new Uint32Array([0, 1, 2]),
  };
  assert.equal(inspect(cage, tiny).segments.length, 1);
  inspect(cage, { ...tiny, positions: new Float32Array(9) });
  inspect(cage, join3d(tiny, target));
});

test('inspect names itself, the argument and its value in errors, also of meshes whose result is given', () => {
  const result = transfer(cage, target);
  const other = transfer(
    cage,
    ball([0, 0, 0], () => 1, 8, 12),
  );
  const call = inspect as (...args: unknown[]) => unknown;
  const cases: [unknown[], RegExp, string?][] = [
    [[cage, target, null], /: options is null, not an object$/, 'badOption'],
    [[cage, undefined, { result }], /: target\.positions is undefined, not a typed array/],
    [[{}, target, { result }], /: cage\.positions is undefined, not a typed array/],
    [[cage, target, { result: 5 }], /: result is 5; pass what transfer\(\) returned$/],
    [
      [cage, target, { result: { ...result, segmentStats: 5 } }],
      /: result\.segmentStats is 5, not an array; pass what/,
    ],
    [
      [cage, target, { result: project(cage, target) }],
      /: result\.cosmeticTriangles is undefined, as in a projection that/,
    ],
    [[cage, target, { result: other }], /: result\.zones has \d+ entries, not 1 for each of the \d+/, 'resultMismatch'],
  ];
  for (const [args, message, code = 'badArgument'] of cases)
    assert.throws(() => call(...args), { name: 'CagecastError', code, fn: 'inspect', message });
});

test('the guide explains every finding, and none that does not exist', () => {
  const named = (file: string, pattern: RegExp) =>
    [...readFileSync(file, 'utf8').matchAll(pattern)].map(([, name]) => name).sort();
  const codesOfType = named('wasm/src/inspect/finding.ts', /^ {2}\| '(\w+)'/gm);
  assert.ok(codesOfType.length >= 20);
  assert.deepEqual(named('docs/tooling.md', /^\| `(\w+)` \|/gm), codesOfType);
});
