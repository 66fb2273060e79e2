#pragma once

#include <immintrin.h>

#include <cstring>

/// `simd.hpp` by SSE2, and by the later instructions that the compiler may use.
namespace cagecast::simd {

struct f32x4 {
  __m128 v;
};
struct mask4 {
  __m128 v;  ///< All bits of a lane are set where it is true.
};
struct u32x4 {
  __m128i v;
};

inline f32x4 load(const float* p) { return {_mm_loadu_ps(p)}; }
inline f32x4 load3(const float* p) {
  double xy;  // Two floats, which need not be aligned as a double.
  std::memcpy(&xy, p, sizeof xy);
  return {_mm_movelh_ps(_mm_castpd_ps(_mm_set_sd(xy)), _mm_load_ss(p + 2))};
}
inline void store(float* p, f32x4 a) { _mm_storeu_ps(p, a.v); }
inline f32x4 splat(float x) { return {_mm_set1_ps(x)}; }
inline f32x4 of(float a, float b, float c, float d) { return {_mm_setr_ps(a, b, c, d)}; }
template <int i>
inline f32x4 splatLane(f32x4 a) {
  return {_mm_castsi128_ps(_mm_shuffle_epi32(_mm_castps_si128(a.v), i * 0x55))};
}
template <int i>
inline float lane(f32x4 a) {
  return _mm_cvtss_f32(i == 0 ? a.v : splatLane<i>(a).v);
}

inline f32x4 operator+(f32x4 a, f32x4 b) { return {_mm_add_ps(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {_mm_sub_ps(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {_mm_mul_ps(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {_mm_div_ps(a.v, b.v)}; }
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) {
#if defined(__FMA__)
  return {_mm_fmadd_ps(a.v, b.v, c.v)};
#else
  return a * b + c;
#endif
}
inline f32x4 abs(f32x4 a) { return {_mm_andnot_ps(_mm_set1_ps(-0.0f), a.v)}; }

inline f32x4 min(f32x4 a, f32x4 b) { return {_mm_min_ps(a.v, b.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {_mm_max_ps(a.v, b.v)}; }
inline f32x4 lowest(f32x4 a) {
  a = min(a, {_mm_shuffle_ps(a.v, a.v, 0x4E)});
  return min(a, {_mm_shuffle_ps(a.v, a.v, 0xB1)});
}
inline f32x4 highest(f32x4 a) {
  a = max(a, {_mm_shuffle_ps(a.v, a.v, 0x4E)});
  return max(a, {_mm_shuffle_ps(a.v, a.v, 0xB1)});
}

inline mask4 operator<(f32x4 a, f32x4 b) { return {_mm_cmplt_ps(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {_mm_cmple_ps(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {_mm_and_ps(a.v, b.v)}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) {
#if defined(__SSE4_1__)
  return {_mm_blendv_ps(b.v, a.v, m.v)};
#else
  return {_mm_or_ps(_mm_and_ps(m.v, a.v), _mm_andnot_ps(m.v, b.v))};
#endif
}
inline unsigned bits(mask4 m) { return static_cast<unsigned>(_mm_movemask_ps(m.v)); }

inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) { _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v); }

inline u32x4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {_mm_setr_epi32(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d))};
}
inline u32x4 rounded(f32x4 a) { return {_mm_cvtps_epi32(a.v)}; }
// A true lane is the number −1.
inline u32x4 countTrue(u32x4 c, mask4 m) { return {_mm_sub_epi32(c.v, _mm_castps_si128(m.v))}; }
template <int i>
inline std::uint32_t lane(u32x4 c) {
#if defined(__SSE4_1__)
  return static_cast<std::uint32_t>(_mm_extract_epi32(c.v, i));
#else
  return static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_shuffle_epi32(c.v, i * 0x55)));
#endif
}

}  // namespace cagecast::simd
