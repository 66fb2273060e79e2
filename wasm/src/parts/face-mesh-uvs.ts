// Where the points of MediaPipe's canonical face are in its UVs, v from the top; numbers are those of its points. Its left half mirrors its
// right one. Source: "canonical_face_model.obj" and the face mesh's connections, https://github.com/google-ai-edge/mediapipe.

export type Uv = readonly [u: number, v: number];

/** Landmarks on its mirror line, and those of its right half. */
export const kMiddle: Record<string, Uv> = {
  nose_tip: [0.5002, 0.5272], // 4, the furthest in front
  nasion: [0.4999, 0.3515], // 168
  glabella: [0.5, 0.2699], // 9
  lip_upper: [0.5, 0.6525], // 0
  lip_lower: [0.5, 0.7194], // 16
  chin: [0.4999, 0.8669], // 199
  menton: [0.5, 0.9545], // 152
};
export const kRight: Record<string, Uv> = {
  eye_inner: [0.4191, 0.3872], // 133
  eye_outer: [0.2801, 0.3756], // 33
  mouth_corner: [0.382, 0.6947], // 61
};
/** The edges of the lids: 33, then along the lower one, 7, 163 … 155, to 133, and back along the upper one, 173, 157 … 246. */
export const kEye: Uv[] = [
  [0.2801, 0.3756],
  [0.2897, 0.3808],
  [0.3014, 0.3874],
  [0.3188, 0.3962],
  [0.3434, 0.4006],
  [0.3662, 0.3988],
  [0.3932, 0.3955],
  [0.4104, 0.3911],
  [0.4191, 0.3872],
  [0.4088, 0.3739],
  [0.3887, 0.3623],
  [0.366, 0.356],
  [0.3434, 0.3554],
  [0.3188, 0.3583],
  [0.3014, 0.3632],
  [0.2897, 0.3683],
];
/** The right half of the line between the lips: 78, along the lower one, 95, 88 … 14, then along the upper one, 13, 82 … 191. */
export const kMouth: Uv[] = [
  [0.4036, 0.694],
  [0.403, 0.7065],
  [0.4265, 0.7035],
  [0.4487, 0.6953],
  [0.473, 0.6953],
  [0.5, 0.6953],
  [0.5, 0.6923],
  [0.4754, 0.6924],
  [0.4522, 0.6924],
  [0.4312, 0.6924],
  [0.4134, 0.6924],
];

/** Around the right eye: the fold of its lids. 130, along the lower one, 25, 110 … 243, and back along the upper one, 190 … 247. */
export const kLids: Uv[] = [
  [0.2665, 0.377],
  [0.2747, 0.3891],
  [0.289, 0.399],
  [0.3111, 0.4095],
  [0.3388, 0.413],
  [0.3659, 0.4096],
  [0.3934, 0.4037],
  [0.4128, 0.399],
  [0.4265, 0.3898],
  [0.4162, 0.3687],
  [0.3924, 0.3539],
  [0.3701, 0.3461],
  [0.3452, 0.344],
  [0.3193, 0.3473],
  [0.2979, 0.3536],
  [0.2767, 0.3634],
];
/** The right brow: 46, along its lower edge, 53, 52, 65, 55, and back, 107, 66, 105, 63, 70. */
export const kBrow: Uv[] = [
  [0.2578, 0.3145],
  [0.2964, 0.2932],
  [0.3372, 0.2829],
  [0.3859, 0.2814],
  [0.4476, 0.3026],
  [0.4417, 0.2617],
  [0.3831, 0.2558],
  [0.3273, 0.2565],
  [0.2771, 0.2719],
  [0.2296, 0.2995],
];
/** The right half of the outline of the lips: 0, 37, 39, 40, 185, 61, 146, 91, 181, 84, 17. */
export const kLips: Uv[] = [
  [0.5, 0.6525],
  [0.4718, 0.6504],
  [0.4398, 0.6572],
  [0.4146, 0.6665],
  [0.3924, 0.6777],
  [0.382, 0.6947],
  [0.3961, 0.7102],
  [0.4183, 0.7201],
  [0.4448, 0.7308],
  [0.4723, 0.7362],
  [0.5, 0.737],
];
