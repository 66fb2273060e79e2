#pragma once

#include <wasm_simd128.h>

/// `simd.hpp` by WebAssembly's fixed-width SIMD.
namespace cagecast::simd {

struct f32x4 {
  v128_t v;
};
struct mask4 {
  v128_t v;  ///< All bits of a lane are set where it is true.
};
struct u32x4 {
  v128_t v;
};

inline f32x4 load(const float* p) { return {wasm_v128_load(p)}; }
inline f32x4 load3(const float* p) { return {wasm_v128_load32_lane(p + 2, wasm_v128_load64_zero(p), 2)}; }
inline void store(float* p, f32x4 a) { wasm_v128_store(p, a.v); }
inline f32x4 splat(float x) { return {wasm_f32x4_splat(x)}; }
inline f32x4 of(float a, float b, float c, float d) { return {wasm_f32x4_make(a, b, c, d)}; }
template <int i>
inline float lane(f32x4 a) {
  return wasm_f32x4_extract_lane(a.v, i);
}
template <int i>
inline f32x4 splatLane(f32x4 a) {
  return {wasm_i32x4_shuffle(a.v, a.v, i, i, i, i)};
}

inline f32x4 operator+(f32x4 a, f32x4 b) { return {wasm_f32x4_add(a.v, b.v)}; }
inline f32x4 operator-(f32x4 a, f32x4 b) { return {wasm_f32x4_sub(a.v, b.v)}; }
inline f32x4 operator*(f32x4 a, f32x4 b) { return {wasm_f32x4_mul(a.v, b.v)}; }
inline f32x4 operator/(f32x4 a, f32x4 b) { return {wasm_f32x4_div(a.v, b.v)}; }
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) { return a * b + c; }
inline f32x4 abs(f32x4 a) { return {wasm_f32x4_abs(a.v)}; }

// The pseudo-minimum and -maximum are one instruction on x86, the IEEE ones are several.
inline f32x4 min(f32x4 a, f32x4 b) { return {wasm_f32x4_pmin(b.v, a.v)}; }
inline f32x4 max(f32x4 a, f32x4 b) { return {wasm_f32x4_pmax(b.v, a.v)}; }
inline f32x4 lowest(f32x4 a) {
  a = min(a, {wasm_i64x2_shuffle(a.v, a.v, 1, 0)});
  return min(a, {wasm_i32x4_shuffle(a.v, a.v, 1, 0, 3, 2)});
}
inline f32x4 highest(f32x4 a) {
  a = max(a, {wasm_i64x2_shuffle(a.v, a.v, 1, 0)});
  return max(a, {wasm_i32x4_shuffle(a.v, a.v, 1, 0, 3, 2)});
}

inline mask4 operator<(f32x4 a, f32x4 b) { return {wasm_f32x4_lt(a.v, b.v)}; }
inline mask4 operator<=(f32x4 a, f32x4 b) { return {wasm_f32x4_le(a.v, b.v)}; }
inline mask4 operator&(mask4 a, mask4 b) { return {wasm_v128_and(a.v, b.v)}; }
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) { return {wasm_v128_bitselect(a.v, b.v, m.v)}; }
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

inline u32x4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return {wasm_i32x4_make(static_cast<int>(a), static_cast<int>(b), static_cast<int>(c), static_cast<int>(d))};
}
// Floats from 2^23 to 2^24 are integers, so the addition rounds; their lowest bits are what they exceed 2^23 by.
inline u32x4 rounded(f32x4 a) {
  return {wasm_v128_and(wasm_f32x4_add(a.v, wasm_f32x4_splat(0x1p23f)), wasm_i32x4_splat(0x7F'FFFF))};
}
// A true lane is the number −1.
inline u32x4 countTrue(u32x4 c, mask4 m) { return {wasm_i32x4_sub(c.v, m.v)}; }
template <int i>
inline std::uint32_t lane(u32x4 c) {
  return static_cast<std::uint32_t>(wasm_i32x4_extract_lane(c.v, i));
}

}  // namespace cagecast::simd
