#pragma once

#include <cstdint>

/// Four floats at a time: the operations are declared and documented here, and implemented for SSE2, NEON, WebAssembly
/// SIMD and plain C++ in a file each.
///
/// All four give the same bits, with two exceptions: `multiplyAdd` rounds once where the processor can, else twice, and
/// what `min` and `max` return for NaN, or for 0 and −0, differs. So decisions must not depend on them, only filters
/// may.

#if defined(CAGECAST_SCALAR)
#define CAGECAST_SIMD_SCALAR
#elif defined(__SSE2__)
#define CAGECAST_SIMD_SSE
#elif defined(__aarch64__)
#define CAGECAST_SIMD_NEON
#elif defined(__wasm_simd128__)
#define CAGECAST_SIMD_WASM
#else
#define CAGECAST_SIMD_SCALAR
#endif

namespace cagecast::simd {

/// Floats in a vector.
inline constexpr int kWidth = 4;

struct f32x4;  ///< Four floats.
struct mask4;  ///< Four truth values, the results of comparisons.
struct u32x4;  ///< Four counters.

/// Four floats from memory, which need not be aligned.
inline f32x4 load(const float* p);
/// Three floats from memory; lane 3 is 0.
inline f32x4 load3(const float* p);
/// Writes four floats to memory, which need not be aligned.
inline void store(float* p, f32x4 a);
/// x in all lanes.
inline f32x4 splat(float x);
/// Four numbers, without storing them to memory.
inline f32x4 of(float a, float b, float c, float d);
/// One lane as a number.
template <int i>
inline float lane(f32x4 a);
/// One lane in all lanes.
template <int i>
inline f32x4 splatLane(f32x4 a);

inline f32x4 operator+(f32x4 a, f32x4 b);
inline f32x4 operator-(f32x4 a, f32x4 b);
inline f32x4 operator*(f32x4 a, f32x4 b);
inline f32x4 operator/(f32x4 a, f32x4 b);
/// a · b + c, with one or two roundings.
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c);
inline f32x4 abs(f32x4 a);

inline f32x4 min(f32x4 a, f32x4 b);
inline f32x4 max(f32x4 a, f32x4 b);
/// The least of the four lanes, in all lanes.
inline f32x4 lowest(f32x4 a);
/// The greatest of the four lanes, in all lanes.
inline f32x4 highest(f32x4 a);

inline mask4 operator<(f32x4 a, f32x4 b);
inline mask4 operator<=(f32x4 a, f32x4 b);
inline mask4 operator&(mask4 a, mask4 b);
/// Lanes of a where the mask is true, else of b.
inline f32x4 select(mask4 m, f32x4 a, f32x4 b);
/// Bit i is lane i.
inline unsigned bits(mask4 m);

/// Transposes a matrix of four rows.
inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d);

/// Four counters.
inline u32x4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d);
/// Rounds numbers from 0 to 2^22 to the nearest integer, halves to even.
inline u32x4 rounded(f32x4 a);
/// Adds 1 where the mask is true.
inline u32x4 countTrue(u32x4 c, mask4 m);
/// One lane as a number.
template <int i>
inline std::uint32_t lane(u32x4 c);

}  // namespace cagecast::simd

#if defined(CAGECAST_SIMD_SSE)
#include "simd/sse.hpp"
#elif defined(CAGECAST_SIMD_NEON)
#include "simd/neon.hpp"
#elif defined(CAGECAST_SIMD_WASM)
#include "simd/wasm.hpp"
#else
#include "simd/scalar.hpp"
#endif
