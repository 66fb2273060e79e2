import { add, clamp, dot, frame, length, type Mesh, scale, smoothstep, sub, type Vec3, type Vertex } from './mesh';

// One unit is the height of the head: the chin is at y = -0.5, the crown at 0.5. The face looks to +z, its left is +x.

/** Metres: how high the head is, and where its middle is in the figure. */
const kHead = { size: 0.228, centre: [0, 1.612, 0.022] as Vec3 };
export const onHead = (p: Vec3): Vec3 => add(kHead.centre, scale(p, kHead.size));
export const inHead = (p: Vec3): Vec3 => scale(sub(p, kHead.centre), 1 / kHead.size);

/** The left eye. */
export const kEye: Vec3 = [0.143, 0, 0.255];
export const kEyeRadius = 0.0655;
export const kLook = frame([0.06, 0, 1]);
const [eyeRight, eyeUp, eyeFront] = kLook;
const kLid = 0.075; // the lids' distance from the middle of the eye
const kCorner = 0.0635; // from the middle of the eye to its corners

/** The height of an arc from corner to corner of the eye. */
const arc = (height: number, x: number): number => {
  const centre = (kCorner ** 2 - height ** 2) / (2 * height);
  return Math.sqrt((centre + height) ** 2 - Math.min(x, kCorner) ** 2) - centre;
};
const steep = (u: number, v: number): number => Math.atan2(v, Math.sqrt(Math.max(kLid ** 2 - u * u - v * v, 4e-4)));
/** How high the edges of the lids are at a place between the corners of the eye, as angles about the axis through these. */
const lidsAt = (u: number): { upper: number; lower: number } => ({
  upper: steep(u, arc(0.0265, Math.abs(u))),
  lower: steep(u, -arc(0.0215, Math.abs(u))),
});

/** A point of the left eye by its place across, its angle about the axis through the corners, and its distance from that. */
export const onEye = (u: number, angle: number, far: number): Vec3 =>
  add(
    kEye,
    add(
      scale(eyeRight, u),
      add(scale(eyeUp, far * Math.sin(angle) + 0.07 * u), scale(eyeFront, far * Math.cos(angle))),
    ),
  );
/** The edge of the left upper lid. */
export const lidEdge = (u: number, far: number): Vec3 => onEye(u, lidsAt(u).upper, Math.sqrt(far ** 2 - u * u));

/** How the lids of the left eye move a point, each by a share of the way to the line where they meet; negative opens. */
function lids(p: Vec3, upper: number, lower: number): Vec3 {
  const q = sub(p, kEye);
  const [u, w] = [dot(q, eyeRight), dot(q, eyeFront)];
  const v = dot(q, eyeUp) - 0.07 * u;
  const near = smoothstep(0.13, 0.09, length(q)) * smoothstep(0, 0.02, w) * smoothstep(0.1, kCorner, Math.abs(u));
  if (near === 0) return [0, 0, 0];
  const edges = lidsAt(clamp(u, -kCorner, kCorner));
  const angle = Math.atan2(v, w);
  // They meet low, and a little past each other, so that nothing shows between them.
  const meet = edges.lower + 0.22 * (edges.upper - edges.lower);
  const past = 0.06 * smoothstep(kCorner, 0.04, Math.abs(u));
  const isUpper = angle > (edges.upper + edges.lower) / 2;
  const turn = isUpper
    ? upper * (meet - past - edges.upper) * smoothstep(1.3, edges.upper, angle)
    : lower * (meet - edges.lower) * smoothstep(-1.2, edges.lower, angle);
  const [sin, cos] = [Math.sin(turn * near), Math.cos(turn * near)];
  return add(scale(eyeUp, v * (cos - 1) + w * sin), scale(eyeFront, w * (cos - 1) - v * sin));
}

/** 1 near a spot, 0 away from it. */
const about = (p: Vec3, spot: Vec3, [x, y, z]: Vec3): number => {
  const q = sub(p, spot);
  return Math.exp(-((q[0] / x) ** 2 + (q[1] / y) ** 2 + (q[2] / z) ** 2));
};

/** The line where the lips meet. */
const lipLine = (x: number): number => -0.312 + 0.55 * Math.min(Math.abs(x), 0.12) ** 2;
/** 1 on all that hangs on the jaw, 0 on the skull: sharp between the lips, soft in the cheeks. */
function onJaw([x, y, z]: Vec3): number {
  const aside = Math.abs(x);
  const soft = 0.004 + 0.15 * smoothstep(0.07, 0.19, Math.hypot(aside, z < 0.2 ? 0.2 - z : 0));
  const below = smoothstep(soft, -soft, y - lipLine(x) + 0.4 * Math.max(0, aside - 0.11));
  return below * smoothstep(-0.12, 0.1, z) * smoothstep(-0.66, -0.47, y - 0.25 * Math.min(0, z - 0.1));
}
const kJaw: Vec3 = [0, -0.158, 0.013];
const kOpen = 0.27; // radians

function jawOpen(p: Vec3): Vec3 {
  const [, y, z] = sub(p, kJaw);
  const turn = kOpen * onJaw(p);
  const [sin, cos] = [Math.sin(turn), Math.cos(turn)];
  // An open mouth is narrower.
  const narrow = -0.13 * p[0] * about(p, [0, -0.33, 0.33], [0.13, 0.09, 0.15]);
  return [narrow, y * (cos - 1) - z * sin, z * (cos - 1) + y * sin];
}

const kMouthCorner: Vec3 = [0.104, -0.305, 0.318];
const corner = (p: Vec3): number => about(p, kMouthCorner, [0.075, 0.06, 0.12]);
const cheek = (p: Vec3): number => about(p, [0.165, -0.14, 0.24], [0.08, 0.075, 0.13]);

const smile = (p: Vec3): Vec3 =>
  add(
    add(scale([0.034, 0.04, -0.022], corner(p)), scale([0.008, 0.03, 0.016], cheek(p))),
    add(scale([0.004, 0.008, -0.004], about(p, [0.045, -0.3, 0.36], [0.06, 0.05, 0.1])), lids(p, 0.06, 0.7)),
  );
const frown = (p: Vec3): Vec3 =>
  add(
    scale([0.002, -0.036, -0.006], corner(p)),
    scale([0, 0.008, 0.006], about(p, [0, -0.345, 0.38], [0.06, 0.03, 0.1])),
  );
const innerBrow = (p: Vec3): number => about(p, [0.05, 0.09, 0.31], [0.06, 0.06, 0.12]);
const brow = (p: Vec3): number => about(p, [0.11, 0.095, 0.3], [0.085, 0.05, 0.13]);

/** Moves of the left half of the face, of which there is one for each side. */
const paired: Record<string, (p: Vec3) => Vec3> = {
  eyeBlink: (p) => lids(p, 1, 1),
  eyeWide: (p) => lids(p, -0.3, -0.15),
  mouthSmile: smile,
  mouthFrown: frown,
  browDown: (p) => add(scale([-0.012, -0.03, 0.004], brow(p)), scale([-0.008, -0.012, 0.006], innerBrow(p))),
  browOuterUp: (p) => scale([0, 0.036, -0.002], about(p, [0.17, 0.1, 0.27], [0.08, 0.055, 0.13])),
};
/** Moves of both halves, given for the left one. */
const whole: Record<string, (p: Vec3) => Vec3> = {
  browInnerUp: (p) => scale([-0.004, 0.042, 0], innerBrow(p)),
  jawOpen,
  mouthPucker: (p) => {
    const near = about(p, [0, -0.313, 0.37], [0.14, 0.085, 0.13]) * smoothstep(0.24, 0.32, p[2]);
    const thick = 0.12 * (p[1] - lipLine(p[0])) * about(p, [0, -0.313, 0.39], [0.06, 0.05, 0.08]);
    return [-0.52 * p[0] * near, thick, 0.036 * near];
  },
};

const left = (move: (p: Vec3) => Vec3, [x, y, z]: Vec3): Vec3 => {
  const [dx, dy, dz] = move([Math.abs(x), y, z]);
  return [x < 0 ? -dx : dx, dy, dz];
};
type Move = (p: Vec3) => Vec3;
/** The morphs, named as by ARKit: how each moves a point of the head, in its own unit. */
export const morphs: ReadonlyMap<string, Move> = new Map([
  ...Object.entries(paired).flatMap(([name, move]): [string, Move][] =>
    ([1, -1] as const).map((side) => [
      `${name}${side > 0 ? 'Left' : 'Right'}`,
      // The middle of brows and mouth goes half of the way with each side.
      (p) => scale(left(move, p), smoothstep(-0.03, 0.03, side * p[0])),
    ]),
  ),
  ...Object.entries(whole).map(([name, move]): [string, Move] => [name, (p) => left(move, p)]),
]);

/** Almost closes the lips, which were modelled apart, and lifts the corners of the mouth a little. */
export function atEase(mesh: Mesh): Mesh {
  const ease = (vertex: Vertex): Vertex => {
    const p = inHead(vertex.base);
    const [x, y, z] = p;
    const apart = 0.0125 * Math.sqrt(Math.max(0, 1 - (x / 0.1) ** 2));
    const far = y - lipLine(x);
    const near = smoothstep(0.075, 0.014, Math.abs(far)) * smoothstep(0.28, 0.31, z);
    const closing: Vec3 = [0, -Math.sign(far) * Math.max(0, apart - 0.0015) * near, 0];
    return { ...vertex, at: onHead(add(p, add(closing, scale(left(smile, p), 0.18)))) };
  };
  return { ...mesh, vertices: mesh.vertices.map(ease) };
}

/** Where a vertex is in a morph. */
export const morphed = ({ at, base }: Vertex, move: Move): Vec3 => add(at, scale(move(inHead(base)), kHead.size));
/** What a part does that hangs on the jaw as a whole. */
export const withJaw = (vertex: Vertex): Vec3 => {
  const p = inHead(vertex.base);
  const [, y, z] = sub(p, kJaw);
  const [sin, cos] = [Math.sin(kOpen), Math.cos(kOpen)];
  return add(vertex.at, scale([0, y * (cos - 1) - z * sin, z * (cos - 1) + y * sin], kHead.size));
};
