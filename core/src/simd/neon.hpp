#pragma once

#include <arm_neon.h>

/// `simd.hpp` by the instructions that every 64-bit ARM processor has.
namespace cagecast::simd {

struct f32x4 {
  float32x4_t v;
};
struct mask4 {
  uint32x4_t v;  ///< All bits of a lane are set where it is true.
};
struct u32x4 {
  uint32x4_t v;
};

inline f32x4 load(const float* p) { return {vld1q_f32(p)}; }
inline f32x4 load3(const float* p) { return {vcombine_f32(vld1_f32(p), vset_lane_f32(p[2], vdup_n_f32(0), 0))}; }
inline void store(float* p, f32x4 a) { vst1q_f32(p, a.v); }
inline f32x4 splat(float x) { return {vdupq_n_f32(x)}; }
inline f32x4 of(float a, float b, float c, float d) { return {float32x4_t{a, b, c, d}}; }
template <int i>
inline float lane(f32x4 a) {
  return vgetq_lane_f32(a.v, i);
}
template <int i>
inline f32x4 splatLane(f32x4 a) {
  return {vdupq_laneq_f32(a.v, i)};
}

inline f32x4 operator+(f32x4 a, f32x4 b) { return {vaddq_f32(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {vsubq_f32(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {vmulq_f32(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {vdivq_f32(a.v, b.v)}; }
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) { return {vfmaq_f32(c.v, a.v, b.v)}; }
inline f32x4 abs(f32x4 a) { return {vabsq_f32(a.v)}; }

inline f32x4 min(f32x4 a, f32x4 b) { return {vminq_f32(a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {vmaxq_f32(a.v, b.v)}; }
inline f32x4 lowest(f32x4 a) { return {vdupq_n_f32(vminvq_f32(a.v))}; }
inline f32x4 highest(f32x4 a) { return {vdupq_n_f32(vmaxvq_f32(a.v))}; }

inline mask4 operator<(f32x4 a, f32x4 b) { return {vcltq_f32(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {vcleq_f32(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {vandq_u32(a.v, b.v)}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {vbslq_f32(m.v, a.v, b.v)}; }
inline unsigned bits(mask4 m) {
  static const uint32_t kBit[4] = {1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(m.v, vld1q_u32(kBit)));
}

inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) {
  const float64x2_t evenAb = vreinterpretq_f64_f32(vtrn1q_f32(a.v, b.v));
  const float64x2_t evenCd = vreinterpretq_f64_f32(vtrn1q_f32(c.v, d.v));
  const float64x2_t oddAb = vreinterpretq_f64_f32(vtrn2q_f32(a.v, b.v));
  const float64x2_t oddCd = vreinterpretq_f64_f32(vtrn2q_f32(c.v, d.v));
  a.v = vreinterpretq_f32_f64(vtrn1q_f64(evenAb, evenCd));
  b.v = vreinterpretq_f32_f64(vtrn1q_f64(oddAb, oddCd));
  c.v = vreinterpretq_f32_f64(vtrn2q_f64(evenAb, evenCd));
  d.v = vreinterpretq_f32_f64(vtrn2q_f64(oddAb, oddCd));
}

inline u32x4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) { return {uint32x4_t{a, b, c, d}}; }
inline u32x4 rounded(f32x4 a) { return {vcvtnq_u32_f32(a.v)}; }
// A true lane is the number −1.
inline u32x4 countTrue(u32x4 c, mask4 m) { return {vsubq_u32(c.v, m.v)}; }
template <int i>
inline std::uint32_t lane(u32x4 c) {
  return vgetq_lane_u32(c.v, i);
}

}  // namespace cagecast::simd
