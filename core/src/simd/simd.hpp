#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

/// Four floats at a time: one layer over SSE2, NEON, WebAssembly SIMD and plain C++, with the same bits from each. What
/// goes by `wide` takes two times four where there is AVX.
///
/// `min` and `max` are for numbers: what they make of NaN, and of 0 and −0, differs. `multiplyAdd` and
/// `subtractProduct` round once where the processor can, else twice: they are for filters, which have room for either.
/// Nothing else differs, and nothing is approximate.

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
/// Four numbers, not by way of memory: a load of what was just stored in parts waits.
inline f32x4 of(float a, float b, float c, float d) { return {_mm_setr_ps(a, b, c, d)}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {_mm_div_ps(a.v, b.v)}; }
/// a · b + c.
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) {
#if defined(__FMA__)
  return {_mm_fmadd_ps(a.v, b.v, c.v)};
#else
  return a * b + c;
#endif
}
/// c − a · b.
inline f32x4 subtractProduct(f32x4 c, f32x4 a, f32x4 b) {
#if defined(__FMA__)
  return {_mm_fnmadd_ps(a.v, b.v, c.v)};
#else
  return c - a * b;
#endif
}
inline f32x4 min(f32x4 a, f32x4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline f32x4 abs(f32x4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }
/// a, its sign turned where b is negative.
inline f32x4 turned(f32x4 a, f32x4 b) { return {_mm_xor_ps(a.v, _mm_and_ps(_mm_set1_ps(-0.0f), b.v))}; }
inline mask4 operator<(f32x4 a, f32x4 b) { return {_mm_cmplt_ps(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {_mm_cmple_ps(a.v, b.v)}; }
inline mask4 operator!=(f32x4 a, f32x4 b) { return {_mm_cmpneq_ps(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {_mm_and_ps(a.v, b.v)}; }
/// Numbers from 0 on with a tag of so many bits in place of their last ones, which makes them a little less or more.
template <int tagBits>
inline f32x4 withTag(f32x4 a, std::uint32_t tag) {
  const __m128i kept = _mm_and_si128(_mm_castps_si128(a.v), _mm_set1_epi32(-1 << tagBits));
  return {_mm_castsi128_ps(_mm_or_si128(kept, _mm_set1_epi32(static_cast<int>(tag))))};
}
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) {
#if defined(__SSE4_1__)
  return {_mm_blendv_ps(b.v, a.v, m.v)};
#else
  return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))};
#endif
}
/// What `choose` takes in place of a, where it is known beforehand that one of a and b will be chosen.
inline f32x4 toChoose(f32x4 a, f32x4) { return a; }
inline f32x4 choose(mask4 m, f32x4 a, f32x4 b) { return select(m, a, b); }
/// Lane `lane` of b, the others of a.
template <int lane>
inline f32x4 withLane(f32x4 a, f32x4 b) {
#if defined(__SSE4_1__)
  return {_mm_blend_ps(a.v, b.v, 1 << lane)};
#else
  return select({_mm_castsi128_ps(_mm_setr_epi32(-(lane == 0), -(lane == 1), -(lane == 2), -(lane == 3)))}, b, a);
#endif
}
/// Lane `lane` in all four lanes.
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {_mm_castsi128_ps(_mm_shuffle_epi32(_mm_castps_si128(a.v), lane * 0x55))};
}
/// The same, of four floats in memory.
template <int lane>
inline f32x4 splatAt(const float* p) {
  return splat(p[lane]);
}
/// The least of the four lanes, in all of them.
inline f32x4 lowest(f32x4 a) {
  a = min(a, {_mm_shuffle_ps(a.v, a.v, 0x4E)});
  return min(a, {_mm_shuffle_ps(a.v, a.v, 0xB1)});
}
/// The greatest.
inline f32x4 highest(f32x4 a) {
  a = max(a, {_mm_shuffle_ps(a.v, a.v, 0x4E)});
  return max(a, {_mm_shuffle_ps(a.v, a.v, 0xB1)});
}
/// Lane 0.
inline float first(f32x4 a) { return _mm_cvtss_f32(a.v); }
/// Bit i is lane i.
inline unsigned bits(mask4 m) { return static_cast<unsigned>(_mm_movemask_ps(m.v)); }
/// Bit i is lane i of 16.
inline unsigned bits(const mask4 (&m)[4]) {
  const auto pack = [](mask4 low, mask4 high) {
    return _mm_packs_epi32(_mm_castps_si128(low.v), _mm_castps_si128(high.v));
  };
  return static_cast<unsigned>(_mm_movemask_epi8(_mm_packs_epi16(pack(m[0], m[1]), pack(m[2], m[3]))));
}
/// Turns four rows into columns.
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }
/// Lanes 0 of both, lanes 1 of both.
inline f32x4 interleaveLow(f32x4 a, f32x4 b) { return {_mm_unpacklo_ps(a.v, b.v)}; }
/// Lanes 2 of both, lanes 3 of both.
inline f32x4 interleaveHigh(f32x4 a, f32x4 b) { return {_mm_unpackhi_ps(a.v, b.v)}; }
/// x, y, z, 0.
inline f32x4 load3(const float* p) {
  double xy;  // Two floats, which need not be aligned as a double.
  std::memcpy(&xy, p, sizeof xy);
  return {_mm_movelh_ps(_mm_castpd_ps(_mm_set_sd(xy)), _mm_load_ss(p + 2))};
}

/// Two doubles.
struct f64x2 {
  __m128d v;
};
inline void store(double* p, f64x2 a) { _mm_storeu_pd(p, a.v); }
inline f64x2 operator+(f64x2 a, f64x2 b) { return {_mm_add_pd(a.v, b.v)}; }
inline f64x2 operator-(f64x2 a, f64x2 b) { return {_mm_sub_pd(a.v, b.v)}; }
inline f64x2 operator*(f64x2 a, f64x2 b) { return {_mm_mul_pd(a.v, b.v)}; }
inline f64x2 operator/(f64x2 a, f64x2 b) { return {_mm_div_pd(a.v, b.v)}; }
inline f64x2 doubles(double a, double b) { return {_mm_set_pd(b, a)}; }
template <int lane>
inline double doubleOf(f64x2 a) {
  return _mm_cvtsd_f64(lane == 0 ? a.v : _mm_unpackhi_pd(a.v, a.v));
}
/// Two floats.
inline void storeRounded(float* p, f64x2 a) {
  const double both = _mm_cvtsd_f64(_mm_castps_pd(_mm_cvtpd_ps(a.v)));
  std::memcpy(p, &both, sizeof both);
}
inline f64x2 splatDouble(double x) { return {_mm_set1_pd(x)}; }
inline f64x2 min(f64x2 a, f64x2 b) { return {_mm_min_pd(a.v, b.v)}; }
inline f64x2 sqrt(f64x2 a) { return {_mm_sqrt_pd(a.v)}; }
/// Lanes 0 and 1.
inline f64x2 lowDoubles(f32x4 a) { return {_mm_cvtps_pd(a.v)}; }
/// Lanes 2 and 3.
inline f64x2 highDoubles(f32x4 a) { return {_mm_cvtps_pd(_mm_movehl_ps(a.v, a.v))}; }

/// Four counters.
struct count4 {
  __m128i v;
};
inline count4 load(const std::uint32_t* p) { return {_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))}; }
inline count4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {_mm_setr_epi32(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d))};
}
/// Numbers from 0 to 2^22, rounded; halves to even ones.
inline count4 rounded(f32x4 a) { return {_mm_cvtps_epi32(a.v)}; }
inline void store(std::uint32_t* p, count4 c) { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), c.v); }
inline count4 splatCount(std::uint32_t x) { return {_mm_set1_epi32(static_cast<int>(x))}; }
inline count4 max(count4 a, count4 b) {
#if defined(__SSE4_1__)
  return {_mm_max_epu32(a.v, b.v)};
#else
  // As numbers with a sign, from half as low.
  const __m128i half = _mm_set1_epi32(INT32_MIN);
  const __m128i isMore = _mm_cmpgt_epi32(_mm_xor_si128(a.v, half), _mm_xor_si128(b.v, half));
  return {_mm_or_si128(_mm_and_si128(isMore, a.v), _mm_andnot_si128(isMore, b.v))};
#endif
}
inline count4 operator+(count4 a, count4 b) { return {_mm_add_epi32(a.v, b.v)}; }
inline count4 operator-(count4 a, count4 b) { return {_mm_sub_epi32(a.v, b.v)}; }
/// One more where the mask is set: all its bits are the number −1.
inline count4 countTrue(count4 c, mask4 m) { return {_mm_sub_epi32(c.v, _mm_castps_si128(m.v))}; }
/// c, and what of d is where the mask is set.
inline count4 with(count4 c, count4 d, mask4 m) {
  return {_mm_or_si128(c.v, _mm_and_si128(d.v, _mm_castps_si128(m.v)))};
}
template <int lane>
inline std::uint32_t countOf(count4 c) {
#if defined(__SSE4_1__)
  return static_cast<std::uint32_t>(_mm_extract_epi32(c.v, lane));
#else
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_shuffle_epi32(c.v, lane * 0x55)));
#endif
}

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
inline f32x4 of(float a, float b, float c, float d) { return {float32x4_t{a, b, c, d}}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {vaddq_f32(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {vsubq_f32(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {vmulq_f32(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {vdivq_f32(a.v, b.v)}; }
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) { return {vfmaq_f32(c.v, a.v, b.v)}; }
inline f32x4 subtractProduct(f32x4 c, f32x4 a, f32x4 b) { return {vfmsq_f32(c.v, a.v, b.v)}; }
inline f32x4 min(f32x4 a, f32x4 b) { return {vminq_f32(a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {vmaxq_f32(a.v, b.v)}; }
inline f32x4 abs(f32x4 a) { return {vabsq_f32(a.v)}; }
inline f32x4 turned(f32x4 a, f32x4 b) {
  const uint32x4_t sign = vandq_u32(vdupq_n_u32(0x8000'0000u), vreinterpretq_u32_f32(b.v));
  return {vreinterpretq_f32_u32(veorq_u32(vreinterpretq_u32_f32(a.v), sign))};
}
inline mask4 operator<(f32x4 a, f32x4 b) { return {vcltq_f32(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {vcleq_f32(a.v, b.v)}; }
inline mask4 operator!=(f32x4 a, f32x4 b) { return {vmvnq_u32(vceqq_f32(a.v, b.v))}; }
inline mask4 operator&(mask4 a, mask4 b) { return {vandq_u32(a.v, b.v)}; }
template <int tagBits>
inline f32x4 withTag(f32x4 a, std::uint32_t tag) {
  return {vbslq_f32(vdupq_n_u32((1u << tagBits) - 1), vreinterpretq_f32_u32(vdupq_n_u32(tag)), a.v)};
}
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {vbslq_f32(m.v, a.v, b.v)}; }
inline f32x4 toChoose(f32x4 a, f32x4) { return a; }
inline f32x4 choose(mask4 m, f32x4 a, f32x4 b) { return select(m, a, b); }
template <int lane>
inline f32x4 withLane(f32x4 a, f32x4 b) {
  return {vcopyq_laneq_f32(a.v, lane, b.v, lane)};
}
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {vdupq_laneq_f32(a.v, lane)};
}
template <int lane>
inline f32x4 splatAt(const float* p) {
  return splatLane<lane>(load(p));  // One load for all lanes, and products take a lane as it is.
}
inline f32x4 lowest(f32x4 a) { return {vdupq_n_f32(vminvq_f32(a.v))}; }
inline f32x4 highest(f32x4 a) { return {vdupq_n_f32(vmaxvq_f32(a.v))}; }
inline float first(f32x4 a) { return vgetq_lane_f32(a.v, 0); }
inline unsigned bits(mask4 m) {
  static const uint32_t kBit[4] = {1, 2, 4, 8};
  return vaddvq_u32(vandq_u32(m.v, vld1q_u32(kBit)));
}
inline unsigned bits(const mask4 (&m)[4]) {
  static const uint32_t kBit[4][4] = {{1, 2, 4, 8},
                                      {1 << 4, 2 << 4, 4 << 4, 8 << 4},
                                      {1 << 8, 2 << 8, 4 << 8, 8 << 8},
                                      {1 << 12, 2 << 12, 4 << 12, 8 << 12}};
  uint32x4_t sum = vandq_u32(m[0].v, vld1q_u32(kBit[0]));
  for (int i = 1; i < 4; ++i) sum = vmlsq_u32(sum, m[i].v, vld1q_u32(kBit[i]));  // All bits set are the number −1.
  return vaddvq_u32(sum);
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
inline f32x4 interleaveLow(f32x4 a, f32x4 b) { return {vzip1q_f32(a.v, b.v)}; }
inline f32x4 interleaveHigh(f32x4 a, f32x4 b) { return {vzip2q_f32(a.v, b.v)}; }
inline f32x4 load3(const float* p) { return {vcombine_f32(vld1_f32(p), vset_lane_f32(p[2], vdup_n_f32(0), 0))}; }

struct f64x2 {
  float64x2_t v;
};
inline void store(double* p, f64x2 a) { vst1q_f64(p, a.v); }
inline f64x2 operator+(f64x2 a, f64x2 b) { return {vaddq_f64(a.v, b.v)}; }
inline f64x2 operator-(f64x2 a, f64x2 b) { return {vsubq_f64(a.v, b.v)}; }
inline f64x2 operator*(f64x2 a, f64x2 b) { return {vmulq_f64(a.v, b.v)}; }
inline f64x2 operator/(f64x2 a, f64x2 b) { return {vdivq_f64(a.v, b.v)}; }
inline f64x2 doubles(double a, double b) { return {vsetq_lane_f64(b, vdupq_n_f64(a), 1)}; }
template <int lane>
inline double doubleOf(f64x2 a) {
  return vgetq_lane_f64(a.v, lane);
}
inline void storeRounded(float* p, f64x2 a) { vst1_f32(p, vcvt_f32_f64(a.v)); }
inline f64x2 splatDouble(double x) { return {vdupq_n_f64(x)}; }
inline f64x2 min(f64x2 a, f64x2 b) { return {vminq_f64(a.v, b.v)}; }
inline f64x2 sqrt(f64x2 a) { return {vsqrtq_f64(a.v)}; }
inline f64x2 lowDoubles(f32x4 a) { return {vcvt_f64_f32(vget_low_f32(a.v))}; }
inline f64x2 highDoubles(f32x4 a) { return {vcvt_high_f64_f32(a.v)}; }

struct count4 {
  uint32x4_t v;
};
inline count4 load(const std::uint32_t* p) { return {vld1q_u32(p)}; }
inline count4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {uint32x4_t{a, b, c, d}};
}
inline count4 rounded(f32x4 a) { return {vcvtnq_u32_f32(a.v)}; }
inline void store(std::uint32_t* p, count4 c) { vst1q_u32(p, c.v); }
inline count4 splatCount(std::uint32_t x) { return {vdupq_n_u32(x)}; }
inline count4 max(count4 a, count4 b) { return {vmaxq_u32(a.v, b.v)}; }
inline count4 operator+(count4 a, count4 b) { return {vaddq_u32(a.v, b.v)}; }
inline count4 operator-(count4 a, count4 b) { return {vsubq_u32(a.v, b.v)}; }
inline count4 countTrue(count4 c, mask4 m) { return {vsubq_u32(c.v, m.v)}; }
inline count4 with(count4 c, count4 d, mask4 m) { return {vorrq_u32(c.v, vandq_u32(d.v, m.v))}; }
template <int lane>
inline std::uint32_t countOf(count4 c) {
  return vgetq_lane_u32(c.v, lane);
}

#elif defined(CAGECAST_WASM)

struct f32x4 {
  v128_t v;
};
struct mask4 {
  v128_t v;
};
using FloatVector = float __attribute__((vector_size(16)));  // What clang's own names for instructions take.

inline f32x4 load(const float* p) { return {wasm_v128_load(p)}; }
inline void store(float* p, f32x4 a) { wasm_v128_store(p, a.v); }
inline f32x4 splat(float x) { return {wasm_f32x4_splat(x)}; }
inline f32x4 of(float a, float b, float c, float d) { return {wasm_f32x4_make(a, b, c, d)}; }
inline f32x4 operator+(f32x4 a, f32x4 b) { return {wasm_f32x4_add(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {wasm_f32x4_sub(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {wasm_f32x4_mul(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {wasm_f32x4_div(a.v, b.v)}; }
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) {
#if !defined(__wasm_relaxed_simd__)
  return a * b + c;
#elif __has_builtin(__builtin_wasm_relaxed_madd_f32x4)
  return {(v128_t)__builtin_wasm_relaxed_madd_f32x4((FloatVector)a.v, (FloatVector)b.v, (FloatVector)c.v)};
#else
  // The name in clang up to 15, and another instruction: wasm/tools/fused.mjs makes what engines know of either. Not
  // for three constants, of which tools of that time would work out a + b · c.
  return {(v128_t)__builtin_wasm_fma_f32x4((FloatVector)a.v, (FloatVector)b.v, (FloatVector)c.v)};
#endif
}
// Not fused: a sum would have to be subtracted from what comes before its product.
inline f32x4 subtractProduct(f32x4 c, f32x4 a, f32x4 b) { return c - a * b; }
inline f32x4 min(f32x4 a, f32x4 b) { return {wasm_f32x4_pmin(b.v, a.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {wasm_f32x4_pmax(b.v, a.v)}; }
inline f32x4 abs(f32x4 a) { return {wasm_f32x4_abs(a.v)}; }
inline f32x4 turned(f32x4 a, f32x4 b) { return {wasm_v128_xor(a.v, wasm_v128_and(wasm_f32x4_splat(-0.0f), b.v))}; }
inline mask4 operator<(f32x4 a, f32x4 b) { return {wasm_f32x4_lt(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {wasm_f32x4_le(a.v, b.v)}; }
inline mask4 operator!=(f32x4 a, f32x4 b) { return {wasm_f32x4_ne(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {wasm_v128_and(a.v, b.v)}; }
template <int tagBits>
inline f32x4 withTag(f32x4 a, std::uint32_t tag) {
  return {wasm_v128_or(wasm_v128_andnot(a.v, wasm_i32x4_splat((1 << tagBits) - 1)),
                       wasm_i32x4_splat(static_cast<int>(tag)))};
}
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {wasm_v128_bitselect(a.v, b.v, m.v)}; }
// A choice is three instructions where processors have none for it; from what the two differ by, two.
inline f32x4 toChoose(f32x4 a, f32x4 b) { return {wasm_v128_xor(a.v, b.v)}; }
inline f32x4 choose(mask4 m, f32x4 difference, f32x4 b) {
  return {wasm_v128_xor(b.v, wasm_v128_and(m.v, difference.v))};
}
template <int lane>
inline f32x4 withLane(f32x4 a, f32x4 b) {
  return {wasm_i32x4_shuffle(a.v, b.v, lane == 0 ? 4 : 0, lane == 1 ? 5 : 1, lane == 2 ? 6 : 2, lane == 3 ? 7 : 3)};
}
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return {wasm_i32x4_shuffle(a.v, a.v, lane, lane, lane, lane)};
}
template <int lane>
inline f32x4 splatAt(const float* p) {
  return {wasm_v128_load32_splat(p + lane)};  // To spread what is in a vector takes a unit that does arithmetic.
}
inline f32x4 lowest(f32x4 a) {
  a = min(a, {wasm_i64x2_shuffle(a.v, a.v, 1, 0)});
  return min(a, {wasm_i32x4_shuffle(a.v, a.v, 1, 0, 3, 2)});
}
inline f32x4 highest(f32x4 a) {
  a = max(a, {wasm_i64x2_shuffle(a.v, a.v, 1, 0)});
  return max(a, {wasm_i32x4_shuffle(a.v, a.v, 1, 0, 3, 2)});
}
inline float first(f32x4 a) { return wasm_f32x4_extract_lane(a.v, 0); }
inline unsigned bits(mask4 m) { return wasm_i32x4_bitmask(m.v); }
inline unsigned bits(const mask4 (&m)[4]) {
  return wasm_i8x16_bitmask(
      wasm_i8x16_narrow_i16x8(wasm_i16x8_narrow_i32x4(m[0].v, m[1].v), wasm_i16x8_narrow_i32x4(m[2].v, m[3].v)));
}
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
inline f32x4 interleaveLow(f32x4 a, f32x4 b) { return {wasm_i32x4_shuffle(a.v, b.v, 0, 4, 1, 5)}; }
inline f32x4 interleaveHigh(f32x4 a, f32x4 b) { return {wasm_i32x4_shuffle(a.v, b.v, 2, 6, 3, 7)}; }
inline f32x4 load3(const float* p) { return {wasm_v128_load32_lane(p + 2, wasm_v128_load64_zero(p), 2)}; }

struct f64x2 {
  v128_t v;
};
inline void store(double* p, f64x2 a) { wasm_v128_store(p, a.v); }
inline f64x2 operator+(f64x2 a, f64x2 b) { return {wasm_f64x2_add(a.v, b.v)}; }
inline f64x2 operator-(f64x2 a, f64x2 b) { return {wasm_f64x2_sub(a.v, b.v)}; }
inline f64x2 operator*(f64x2 a, f64x2 b) { return {wasm_f64x2_mul(a.v, b.v)}; }
inline f64x2 operator/(f64x2 a, f64x2 b) { return {wasm_f64x2_div(a.v, b.v)}; }
inline f64x2 doubles(double a, double b) { return {wasm_f64x2_make(a, b)}; }
template <int lane>
inline double doubleOf(f64x2 a) {
  return wasm_f64x2_extract_lane(a.v, lane);
}
inline void storeRounded(float* p, f64x2 a) { wasm_v128_store64_lane(p, wasm_f32x4_demote_f64x2_zero(a.v), 0); }
inline f64x2 splatDouble(double x) { return {wasm_f64x2_splat(x)}; }
inline f64x2 min(f64x2 a, f64x2 b) { return {wasm_f64x2_pmin(b.v, a.v)}; }
inline f64x2 sqrt(f64x2 a) { return {wasm_f64x2_sqrt(a.v)}; }
inline f64x2 lowDoubles(f32x4 a) { return {wasm_f64x2_promote_low_f32x4(a.v)}; }
inline f64x2 highDoubles(f32x4 a) { return {wasm_f64x2_promote_low_f32x4(wasm_i64x2_shuffle(a.v, a.v, 1, 1))}; }

struct count4 {
  v128_t v;
};
inline count4 load(const std::uint32_t* p) { return {wasm_v128_load(p)}; }
inline count4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {wasm_i32x4_make(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d))};
}
// From 2^23 on floats are whole, and what they are beyond it is in their last bits: to convert them takes five
// instructions.
inline count4 rounded(f32x4 a) {
  return {wasm_v128_and(wasm_f32x4_add(a.v, wasm_f32x4_splat(0x1p23f)), wasm_i32x4_splat(0x7F'FFFF))};
}
inline void store(std::uint32_t* p, count4 c) { wasm_v128_store(p, c.v); }
inline count4 splatCount(std::uint32_t x) { return {wasm_u32x4_splat(x)}; }
inline count4 max(count4 a, count4 b) { return {wasm_u32x4_max(a.v, b.v)}; }
inline count4 operator+(count4 a, count4 b) { return {wasm_i32x4_add(a.v, b.v)}; }
inline count4 operator-(count4 a, count4 b) { return {wasm_i32x4_sub(a.v, b.v)}; }
inline count4 countTrue(count4 c, mask4 m) { return {wasm_i32x4_sub(c.v, m.v)}; }
inline count4 with(count4 c, count4 d, mask4 m) { return {wasm_v128_or(c.v, wasm_v128_and(d.v, m.v))}; }
template <int lane>
inline std::uint32_t countOf(count4 c) {
  return static_cast<std::uint32_t>(wasm_i32x4_extract_lane(c.v, lane));
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
inline f32x4 of(float a, float b, float c, float d) { return {{a, b, c, d}}; }
inline f32x4 operator+(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] + b.v[i]; });
}
inline f32x4 operator-(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] - b.v[i]; });
}
inline f32x4 operator*(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] * b.v[i]; });
}
inline f32x4 operator/(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] / b.v[i]; });
}
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) { return a * b + c; }
inline f32x4 subtractProduct(f32x4 c, f32x4 a, f32x4 b) { return c - a * b; }
inline f32x4 min(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline f32x4 max(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline f32x4 abs(f32x4 a) {
  return lanes([&](int i) { return std::abs(a.v[i]); });
}
inline f32x4 turned(f32x4 a, f32x4 b) {
  return lanes([&](int i) { return std::signbit(b.v[i]) ? -a.v[i] : a.v[i]; });
}
inline mask4 operator<(f32x4 a, f32x4 b) {
  return test([&](int i) { return a.v[i] < b.v[i]; });
}
inline mask4 operator<=(f32x4 a, f32x4 b) {
  return test([&](int i) { return a.v[i] <= b.v[i]; });
}
inline mask4 operator!=(f32x4 a, f32x4 b) {
  return test([&](int i) { return a.v[i] != b.v[i]; });
}
inline mask4 operator&(mask4 a, mask4 b) {
  return test([&](int i) { return a.v[i] && b.v[i]; });
}
template <int tagBits>
inline f32x4 withTag(f32x4 a, std::uint32_t tag) {
  return lanes([&](int i) {
    std::uint32_t bits;
    std::memcpy(&bits, &a.v[i], sizeof bits);
    bits = (bits & ~0u << tagBits) | tag;
    float tagged;
    std::memcpy(&tagged, &bits, sizeof bits);
    return tagged;
  });
}
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) {
  return lanes([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; });
}
inline f32x4 toChoose(f32x4 a, f32x4) { return a; }
inline f32x4 choose(mask4 m, f32x4 a, f32x4 b) { return select(m, a, b); }
template <int lane>
inline f32x4 withLane(f32x4 a, f32x4 b) {
  a.v[lane] = b.v[lane];
  return a;
}
template <int lane>
inline f32x4 splatLane(f32x4 a) {
  return splat(a.v[lane]);
}
template <int lane>
inline f32x4 splatAt(const float* p) {
  return splat(p[lane]);
}
inline f32x4 lowest(f32x4 a) { return splat(std::min({a.v[0], a.v[1], a.v[2], a.v[3]})); }
inline f32x4 highest(f32x4 a) { return splat(std::max({a.v[0], a.v[1], a.v[2], a.v[3]})); }
inline float first(f32x4 a) { return a.v[0]; }
inline unsigned bits(mask4 m) {
  return unsigned{m.v[0]} | unsigned{m.v[1]} << 1 | unsigned{m.v[2]} << 2 | unsigned{m.v[3]} << 3;
}
inline unsigned bits(const mask4 (&m)[4]) { return bits(m[0]) | bits(m[1]) << 4 | bits(m[2]) << 8 | bits(m[3]) << 12; }
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
inline f32x4 interleaveLow(f32x4 a, f32x4 b) { return {{a.v[0], b.v[0], a.v[1], b.v[1]}}; }
inline f32x4 interleaveHigh(f32x4 a, f32x4 b) { return {{a.v[2], b.v[2], a.v[3], b.v[3]}}; }
inline f32x4 load3(const float* p) { return {{p[0], p[1], p[2], 0}}; }

struct f64x2 {
  double v[2];
};
inline void store(double* p, f64x2 a) { std::memcpy(p, a.v, sizeof a.v); }
inline f64x2 operator+(f64x2 a, f64x2 b) { return {{a.v[0] + b.v[0], a.v[1] + b.v[1]}}; }
inline f64x2 operator-(f64x2 a, f64x2 b) { return {{a.v[0] - b.v[0], a.v[1] - b.v[1]}}; }
inline f64x2 operator*(f64x2 a, f64x2 b) { return {{a.v[0] * b.v[0], a.v[1] * b.v[1]}}; }
inline f64x2 operator/(f64x2 a, f64x2 b) { return {{a.v[0] / b.v[0], a.v[1] / b.v[1]}}; }
inline f64x2 doubles(double a, double b) { return {{a, b}}; }
template <int lane>
inline double doubleOf(f64x2 a) {
  return a.v[lane];
}
inline void storeRounded(float* p, f64x2 a) {
  p[0] = static_cast<float>(a.v[0]);
  p[1] = static_cast<float>(a.v[1]);
}
inline f64x2 splatDouble(double x) { return {{x, x}}; }
inline f64x2 min(f64x2 a, f64x2 b) { return {{std::min(a.v[0], b.v[0]), std::min(a.v[1], b.v[1])}}; }
inline f64x2 sqrt(f64x2 a) { return {{std::sqrt(a.v[0]), std::sqrt(a.v[1])}}; }
inline f64x2 lowDoubles(f32x4 a) { return {{static_cast<double>(a.v[0]), static_cast<double>(a.v[1])}}; }
inline f64x2 highDoubles(f32x4 a) { return {{static_cast<double>(a.v[2]), static_cast<double>(a.v[3])}}; }

struct count4 {
  std::uint32_t v[4];
};
inline count4 load(const std::uint32_t* p) { return {{p[0], p[1], p[2], p[3]}}; }
inline count4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) { return {{a, b, c, d}}; }
inline count4 rounded(f32x4 a) {
  const auto one = [&](int i) { return static_cast<std::uint32_t>(a.v[i] + 0x1p23f) - 0x80'0000u; };
  return {{one(0), one(1), one(2), one(3)}};
}
inline void store(std::uint32_t* p, count4 c) { std::memcpy(p, c.v, sizeof c.v); }
inline count4 splatCount(std::uint32_t x) { return {{x, x, x, x}}; }
inline count4 max(count4 a, count4 b) {
  return {{std::max(a.v[0], b.v[0]), std::max(a.v[1], b.v[1]), std::max(a.v[2], b.v[2]), std::max(a.v[3], b.v[3])}};
}
inline count4 operator+(count4 a, count4 b) {
  return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline count4 operator-(count4 a, count4 b) {
  return {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2], a.v[3] - b.v[3]}};
}
inline count4 countTrue(count4 c, mask4 m) {
  return {{c.v[0] + m.v[0], c.v[1] + m.v[1], c.v[2] + m.v[2], c.v[3] + m.v[3]}};
}
inline count4 with(count4 c, count4 d, mask4 m) {
  const auto one = [&](int i) { return m.v[i] ? c.v[i] | d.v[i] : c.v[i]; };
  return {{one(0), one(1), one(2), one(3)}};
}
template <int lane>
inline std::uint32_t countOf(count4 c) {
  return c.v[lane];
}

#endif

#if defined(CAGECAST_SSE) && defined(__AVX__)

/// Two times four floats.
struct f32x8 {
  __m256 v;
};
struct mask8 {
  __m256 v;
};

/// As many floats as the processor takes at once, four or two times four.
using wide = f32x8;
using wideMask = mask8;

inline f32x8 loadWide(const float* p) { return {_mm256_loadu_ps(p)}; }
inline void store(float* p, f32x8 a) { _mm256_storeu_ps(p, a.v); }
inline f32x8 splatWide(float x) { return {_mm256_set1_ps(x)}; }
/// Float `lane` of four in memory, in all lanes.
template <int lane>
inline f32x8 splatWideAt(const float* p) {
  return splatWide(p[lane]);
}
/// The same four floats in each part.
inline f32x8 repeat(f32x4 a) { return {_mm256_set_m128(a.v, a.v)}; }
/// Four floats for each part.
/// @param at  Gives where those of part i are.
template <typename At>
inline f32x8 loadParts(At at) {
  return {_mm256_set_m128(load(at(1)).v, load(at(0)).v)};
}
/// Lane `lane` of each part of b, the others of a.
template <int lane>
inline f32x8 withLane(f32x8 a, f32x8 b) {
  return {_mm256_blend_ps(a.v, b.v, 0x11 << lane)};
}
/// Turns four rows of each part into columns.
inline void transpose(f32x8& a, f32x8& b, f32x8& c, f32x8& d) {
  const __m256 abLow = _mm256_unpacklo_ps(a.v, b.v);
  const __m256 abHigh = _mm256_unpackhi_ps(a.v, b.v);
  const __m256 cdLow = _mm256_unpacklo_ps(c.v, d.v);
  const __m256 cdHigh = _mm256_unpackhi_ps(c.v, d.v);
  a.v = _mm256_shuffle_ps(abLow, cdLow, 0x44);
  b.v = _mm256_shuffle_ps(abLow, cdLow, 0xEE);
  c.v = _mm256_shuffle_ps(abHigh, cdHigh, 0x44);
  d.v = _mm256_shuffle_ps(abHigh, cdHigh, 0xEE);
}
/// Lane `lane` of each part in all of that part.
template <int lane>
inline f32x8 splatLane(f32x8 a) {
  return {_mm256_permute_ps(a.v, lane * 0x55)};
}
/// The same, of four floats in memory for each part.
template <int lane, typename At>
inline f32x8 splatParts(At at) {
  return splatLane<lane>(loadParts(at));
}
inline f32x8 operator+(f32x8 a, f32x8 b) { return {_mm256_add_ps(a.v, b.v)}; }
inline f32x8 operator-(f32x8 a, f32x8 b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline f32x8 operator*(f32x8 a, f32x8 b) { return {_mm256_mul_ps(a.v, b.v)}; }
inline f32x8 multiplyAdd(f32x8 a, f32x8 b, f32x8 c) {
#if defined(__FMA__)
  return {_mm256_fmadd_ps(a.v, b.v, c.v)};
#else
  return {_mm256_add_ps(_mm256_mul_ps(a.v, b.v), c.v)};
#endif
}
inline f32x8 abs(f32x8 a) { return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)}; }
inline f32x8 min(f32x8 a, f32x8 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline f32x8 max(f32x8 a, f32x8 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline f32x8 subtractProduct(f32x8 c, f32x8 a, f32x8 b) {
#if defined(__FMA__)
  return {_mm256_fnmadd_ps(a.v, b.v, c.v)};
#else
  return {_mm256_sub_ps(c.v, _mm256_mul_ps(a.v, b.v))};
#endif
}
inline mask8 operator<(f32x8 a, f32x8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LT_OS)}; }
inline mask8 operator<=(f32x8 a, f32x8 b) { return {_mm256_cmp_ps(a.v, b.v, _CMP_LE_OS)}; }
inline f32x8 select(mask8 m, f32x8 a, f32x8 b) { return {_mm256_blendv_ps(b.v, a.v, m.v)}; }
inline f32x8 choose(mask8 m, f32x8 a, f32x8 b) { return select(m, a, b); }
inline mask8 operator&(mask8 a, mask8 b) { return {_mm256_and_ps(a.v, b.v)}; }
/// Bit i is lane i.
inline unsigned bits(mask8 m) { return static_cast<unsigned>(_mm256_movemask_ps(m.v)); }
template <int tagBits>
inline f32x8 withTag(f32x8 a, std::uint32_t tag) {
  const __m256 kept = _mm256_and_ps(a.v, _mm256_castsi256_ps(_mm256_set1_epi32(-1 << tagBits)));
  return {_mm256_or_ps(kept, _mm256_castsi256_ps(_mm256_set1_epi32(static_cast<int>(tag))))};
}
/// Bit i is lane i of 16.
inline unsigned bits(const mask8 (&m)[2]) {
  return static_cast<unsigned>(_mm256_movemask_ps(m[0].v)) | static_cast<unsigned>(_mm256_movemask_ps(m[1].v)) << 8;
}
/// Calls `take` with each part.
template <typename Take>
inline void forParts(mask8 m, Take take) {
  take(0, mask4{_mm256_castps256_ps128(m.v)});
  take(1, mask4{_mm256_extractf128_ps(m.v, 1)});
}

#else

using wide = f32x4;
using wideMask = mask4;

inline f32x4 loadWide(const float* p) { return load(p); }
inline f32x4 splatWide(float x) { return splat(x); }
template <int lane>
inline f32x4 splatWideAt(const float* p) {
  return splatAt<lane>(p);
}
inline f32x4 repeat(f32x4 a) { return a; }
template <typename At>
inline f32x4 loadParts(At at) {
  return load(at(0));
}
template <int lane, typename At>
inline f32x4 splatParts(At at) {
  return splatAt<lane>(at(0));
}
template <typename Take>
inline void forParts(mask4 m, Take take) {
  take(0, m);
}

#endif

/// As many zeros as there are lanes.
template <typename Floats>
inline Floats zeros() {
  if constexpr (sizeof(Floats) == sizeof(wide)) {
    return splatWide(0);
  } else {
    return splat(0);
  }
}

/// Lanes, and times four, of a `wide`.
inline constexpr int kWide = sizeof(wide) / sizeof(float);
inline constexpr int kParts = kWide / kWidth;

/// Of a table of four floats, the last where it is true, else the first; the last two are as `toChoose` has them.
inline wide outer(wideMask m, const float* table) {
#if defined(CAGECAST_SSE) && defined(__AVX__)
  return {_mm256_permutevar_ps(repeat(load(table)).v, _mm256_castps_si256(m.v))};  // By the lowest two bits.
#else
  return choose(m, splat(table[3]), splat(table[0]));
#endif
}
/// The third, else the second.
inline wide inner(wideMask m, const float* table) {
#if defined(CAGECAST_SSE) && defined(__AVX__)
  const __m256 one = _mm256_castsi256_ps(_mm256_set1_epi32(1));
  return {_mm256_permutevar_ps(repeat(load(table)).v, _mm256_castps_si256(_mm256_xor_ps(m.v, one)))};
#else
  return choose(m, splat(table[2]), splat(table[1]));
#endif
}

/// Whether a product with one lane of a vector costs no splat.
#if defined(CAGECAST_NEON)
inline constexpr bool kMultipliesByLane = true;
#else
inline constexpr bool kMultipliesByLane = false;
#endif

/// The tag that `withTag` gave.
template <int tagBits>
inline std::uint32_t tagOf(float tagged) {
  std::uint32_t bits;
  std::memcpy(&bits, &tagged, sizeof bits);
  return bits & ~(~0u << tagBits);
}

template <typename Floats>
inline Floats clamp(Floats x, Floats low, Floats high) {
  return min(max(x, low), high);
}

}  // namespace cagecast::simd
