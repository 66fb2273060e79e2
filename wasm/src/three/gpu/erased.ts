/**
 * What an eraser leaves of a premultiplied colour. It takes away as much alpha as a brush of the same shape adds, so that it removes
 * what that brush left, with its soft edge; multiplying would leave a rim there. Less than a step of 8 bits is what rounding left.
 */
export const kErased = /* glsl */ `
vec4 erased(vec4 color, float amount) {
  float rest = color.a - amount;
  return amount > 0.0 && rest < 0.004 ? vec4(0.0) : color * (rest / max(color.a, 1e-6));
}
`;
