#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

/// Four floats at a time: one layer over SSE2, NEON, WebAssembly SIMD and plain C++, with the same bits from each.
///
/// `min(a, b)` is `a < b ? a : b` and `max(a, b)` is `a > b ? a : b`, lane by lane and for NaN too: that is what SSE does,
/// and the others are made to agree. Nothing here is approximate; no operation is fused.

#if !defined(CAGECAST_SCALAR)
#if defined(__SSE2__)
#define CAGECAST_SSE
#include <immintrin.h>
#elif defined(__aarch64__)
#define CAGECAST_NEON
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#define CAGECAST_WASM
#include <wasm_simd128.h>
#endif
#endif

namespace cagecast::simd {

inline constexpr int kWidth = 4;

#if defined(CAGECAST_SSE)

struct f32x4 {
  __m128 v;
};
/// All bits of a lane set where true.
struct mask4 {
  __m128 v;
};

inline f32x4 load(const float* p) { return {_mm_loadu_ps(p)}; }
inline void store(float* p, f32x4 a) { _mm_storeu_ps(p, a.v); }
inline f32x4 splat(float x) { return {_mm_set1_ps(x)}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline f32x4 min(f32x4 a, f32x4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline mask4 operator<(f32x4 a, f32x4 b) { return {_mm_cmplt_ps(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {_mm_cmple_ps(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {_mm_and_ps(a.v, b.v)}; }
inline mask4 operator|(mask4 a, mask4 b) { return {_mm_or_ps(a.v, b.v)}; }
/// a where the mask is set, else 0.
inline f32x4 keep(mask4 m, f32x4 a) { return {_mm_and_ps(m.v, a.v)}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) {
#if defined(__SSE4_1__)
  return {_mm_blendv_ps(b.v, a.v, m.v)};
#else
  return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))};
#endif
}
/// Lane `lane` in all four lanes.
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {_mm_castsi128_ps(_mm_shuffle_epi32(_mm_castps_si128(a.v), lane * 0x55))};
}
/// Lanes 2, 3, 0, 1.
inline f32x4 swapHalves(f32x4 a) { return {_mm_castsi128_ps(_mm_shuffle_epi32(_mm_castps_si128(a.v), 0x4E))}; }
/// Lanes 1, 0, 3, 2.
inline f32x4 swapPairs(f32x4 a) { return {_mm_castsi128_ps(_mm_shuffle_epi32(_mm_castps_si128(a.v), 0xB1))}; }
/// Lane 0.
inline float first(f32x4 a) { return _mm_cvtss_f32(a.v); }
/// Bit i is lane i.
inline unsigned bits(mask4 m) { return static_cast<unsigned>(_mm_movemask_ps(m.v)); }
/// Turns four rows into columns.
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }

#elif defined(CAGECAST_NEON)

struct f32x4 {
  float32x4_t v;
};
struct mask4 {
  uint32x4_t v;
};

inline f32x4 load(const float* p) { return {vld1q_f32(p)}; }
inline void store(float* p, f32x4 a) { vst1q_f32(p, a.v); }
inline f32x4 splat(float x) { return {vdupq_n_f32(x)}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {vaddq_f32(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {vsubq_f32(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {vmulq_f32(a.v, b.v)}; }
inline f32x4 min(f32x4 a, f32x4 b) { return {vbslq_f32(vcltq_f32(a.v, b.v), a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {vbslq_f32(vcgtq_f32(a.v, b.v), a.v, b.v)}; }
inline mask4 operator<(f32x4 a, f32x4 b) { return {vcltq_f32(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {vcleq_f32(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {vandq_u32(a.v, b.v)}; }
inline mask4 operator|(mask4 a, mask4 b) { return {vorrq_u32(a.v, b.v)}; }
inline f32x4 keep(mask4 m, f32x4 a) { return {vreinterpretq_f32_u32(vandq_u32(m.v, vreinterpretq_u32_f32(a.v)))}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {vbslq_f32(m.v, a.v, b.v)}; }
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {vdupq_laneq_f32(a.v, lane)};
}
inline f32x4 swapHalves(f32x4 a) { return {vextq_f32(a.v, a.v, 2)}; }
inline f32x4 swapPairs(f32x4 a) { return {vrev64q_f32(a.v)}; }
inline float first(f32x4 a) { return vgetq_lane_f32(a.v, 0); }
inline unsigned bits(mask4 m) {
  static const uint32_t kBit[4] = {1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(m.v, vld1q_u32(kBit)));
}
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) {
  const float32x4x2_t ab = vtrnq_f32(a.v, b.v);
  const float32x4x2_t cd = vtrnq_f32(c.v, d.v);
  a.v = vcombine_f32(vget_low_f32(ab.val[0]), vget_low_f32(cd.val[0]));
  b.v = vcombine_f32(vget_low_f32(ab.val[1]), vget_low_f32(cd.val[1]));
  c.v = vcombine_f32(vget_high_f32(ab.val[0]), vget_high_f32(cd.val[0]));
  d.v = vcombine_f32(vget_high_f32(ab.val[1]), vget_high_f32(cd.val[1]));
}

#elif defined(CAGECAST_WASM)

struct f32x4 {
  v128_t v;
};
struct mask4 {
  v128_t v;
};

inline f32x4 load(const float* p) { return {wasm_v128_load(p)}; }
inline void store(float* p, f32x4 a) { wasm_v128_store(p, a.v); }
inline f32x4 splat(float x) { return {wasm_f32x4_splat(x)}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {wasm_f32x4_add(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {wasm_f32x4_sub(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {wasm_f32x4_mul(a.v, b.v)}; }
inline f32x4 min(f32x4 a, f32x4 b) { return {wasm_f32x4_pmin(b.v, a.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {wasm_f32x4_pmax(b.v, a.v)}; }
inline mask4 operator<(f32x4 a, f32x4 b) { return {wasm_f32x4_lt(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {wasm_f32x4_le(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {wasm_v128_and(a.v, b.v)}; }
inline mask4 operator|(mask4 a, mask4 b) { return {wasm_v128_or(a.v, b.v)}; }
inline f32x4 keep(mask4 m, f32x4 a) { return {wasm_v128_and(m.v, a.v)}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {wasm_v128_bitselect(a.v, b.v, m.v)}; }
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {wasm_i32x4_shuffle(a.v, a.v, lane, lane, lane, lane)};
}
inline f32x4 swapHalves(f32x4 a) { return {wasm_i64x2_shuffle(a.v, a.v, 1, 0)}; }
inline f32x4 swapPairs(f32x4 a) { return {wasm_i32x4_shuffle(a.v, a.v, 1, 0, 3, 2)}; }
inline float first(f32x4 a) { return wasm_f32x4_extract_lane(a.v, 0); }
inline unsigned bits(mask4 m) { return wasm_i32x4_bitmask(m.v); }
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) {
  const v128_t abLow = wasm_i32x4_shuffle(a.v, b.v, 0, 4, 1, 5);
  const v128_t abHigh = wasm_i32x4_shuffle(a.v, b.v, 2, 6, 3, 7);
  const v128_t cdLow = wasm_i32x4_shuffle(c.v, d.v, 0, 4, 1, 5);
  const v128_t cdHigh = wasm_i32x4_shuffle(c.v, d.v, 2, 6, 3, 7);
  a.v = wasm_i64x2_shuffle(abLow, cdLow, 0, 2);
  b.v = wasm_i64x2_shuffle(abLow, cdLow, 1, 3);
  c.v = wasm_i64x2_shuffle(abHigh, cdHigh, 0, 2);
  d.v = wasm_i64x2_shuffle(abHigh, cdHigh, 1, 3);
}

#else

struct f32x4 {
  float v[4];
};
struct mask4 {
  bool v[4];
};

template <typename F>
inline f32x4 lanes(F f) {
  return {{f(0), f(1), f(2), f(3)}};
}
template <typename F>
inline mask4 test(F f) {
  return {{f(0), f(1), f(2), f(3)}};
}
inline f32x4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
inline void store(float* p, f32x4 a) { std::memcpy(p, a.v, sizeof a.v); }
inline f32x4 splat(float x) { return {{x, x, x, x}}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return lanes([&](int i) { return a.v[i] + b.v[i]; }); }
inline f32x4 operator-(f32x4 a, f32x4 b) { return lanes([&](int i) { return a.v[i] - b.v[i]; }); }
inline f32x4 operator*(f32x4 a, f32x4 b) { return lanes([&](int i) { return a.v[i] * b.v[i]; }); }
inline f32x4 min(f32x4 a, f32x4 b) { return lanes([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; }); }
inline f32x4 max(f32x4 a, f32x4 b) { return lanes([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; }); }
inline mask4 operator<(f32x4 a, f32x4 b) { return test([&](int i) { return a.v[i] < b.v[i]; }); }
inline mask4 operator<=(f32x4 a, f32x4 b) { return test([&](int i) { return a.v[i] <= b.v[i]; }); }
inline mask4 operator&(mask4 a, mask4 b) { return test([&](int i) { return a.v[i] && b.v[i]; }); }
inline mask4 operator|(mask4 a, mask4 b) { return test([&](int i) { return a.v[i] || b.v[i]; }); }
inline f32x4 keep(mask4 m, f32x4 a) { return lanes([&](int i) { return m.v[i] ? a.v[i] : 0.0f; }); }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return lanes([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; }); }
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return splat(a.v[lane]);
}
inline f32x4 swapHalves(f32x4 a) { return {{a.v[2], a.v[3], a.v[0], a.v[1]}}; }
inline f32x4 swapPairs(f32x4 a) { return {{a.v[1], a.v[0], a.v[3], a.v[2]}}; }
inline float first(f32x4 a) { return a.v[0]; }
inline unsigned bits(mask4 m) {
  return unsigned{m.v[0]} | unsigned{m.v[1]} << 1 | unsigned{m.v[2]} << 2 | unsigned{m.v[3]} << 3;
}
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) {
  f32x4* rows[4] = {&a, &b, &c, &d};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) {
      const float x = rows[i]->v[j];
      rows[i]->v[j] = rows[j]->v[i];
      rows[j]->v[i] = x;
    }
  }
}

#endif

/// The least and the greatest of the four lanes, in all of them.
inline f32x4 lowest(f32x4 a) {
  a = min(a, swapHalves(a));
  return min(a, swapPairs(a));
}
inline f32x4 highest(f32x4 a) {
  a = max(a, swapHalves(a));
  return max(a, swapPairs(a));
}

inline f32x4 clamp(f32x4 x, f32x4 low, f32x4 high) { return min(max(x, low), high); }

}  // namespace cagecast::simd
