#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

/// `simd.hpp` in plain C++, lane by lane.
namespace cagecast::simd {

struct f32x4 {
  float v[4];
};
struct mask4 {
  bool v[4];
};
struct u32x4 {
  std::uint32_t v[4];
};

/// Calls a function with each lane's number.
template <typename Result, typename F>
inline Result eachLane(F f) {
  return {{f(0), f(1), f(2), f(3)}};
}

inline f32x4 load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
inline f32x4 load3(const float* p) { return {{p[0], p[1], p[2], 0}}; }
inline void store(float* p, f32x4 a) { std::memcpy(p, a.v, sizeof a.v); }
inline f32x4 splat(float x) { return {{x, x, x, x}}; }
inline f32x4 of(float a, float b, float c, float d) { return {{a, b, c, d}}; }
template <int i>
inline float lane(f32x4 a) {
  return a.v[i];
}
template <int i>
inline f32x4 splatLane(f32x4 a) {
  return splat(a.v[i]);
}

inline f32x4 operator+(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] + b.v[i]; });
}
inline f32x4 operator-(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] - b.v[i]; });
}
inline f32x4 operator*(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] * b.v[i]; });
}
inline f32x4 operator/(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] / b.v[i]; });
}
inline f32x4 multiplyAdd(f32x4 a, f32x4 b, f32x4 c) { return a * b + c; }
inline f32x4 abs(f32x4 a) {
  return eachLane<f32x4>([&](int i) { return std::abs(a.v[i]); });
}

inline f32x4 min(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] < b.v[i] ? a.v[i] : b.v[i]; });
}
inline f32x4 max(f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return a.v[i] > b.v[i] ? a.v[i] : b.v[i]; });
}
inline f32x4 lowest(f32x4 a) { return splat(std::min({a.v[0], a.v[1], a.v[2], a.v[3]})); }
inline f32x4 highest(f32x4 a) { return splat(std::max({a.v[0], a.v[1], a.v[2], a.v[3]})); }

inline mask4 operator<(f32x4 a, f32x4 b) {
  return eachLane<mask4>([&](int i) { return a.v[i] < b.v[i]; });
}
inline mask4 operator<=(f32x4 a, f32x4 b) {
  return eachLane<mask4>([&](int i) { return a.v[i] <= b.v[i]; });
}
inline mask4 operator&(mask4 a, mask4 b) {
  return eachLane<mask4>([&](int i) { return a.v[i] && b.v[i]; });
}
inline f32x4 select(mask4 m, f32x4 a, f32x4 b) {
  return eachLane<f32x4>([&](int i) { return m.v[i] ? a.v[i] : b.v[i]; });
}
inline unsigned bits(mask4 m) {
  return unsigned{m.v[0]} | unsigned{m.v[1]} << 1 | unsigned{m.v[2]} << 2 | unsigned{m.v[3]} << 3;
}

inline void transpose(f32x4& a, f32x4& b, f32x4& c, f32x4& d) {
  f32x4* const rows[4] = {&a, &b, &c, &d};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < i; ++j) std::swap(rows[i]->v[j], rows[j]->v[i]);
  }
}

inline u32x4 of(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) { return {{a, b, c, d}}; }
// Floats from 2^23 to 2^24 are integers, so the addition rounds.
inline u32x4 rounded(f32x4 a) {
  return eachLane<u32x4>([&](int i) { return static_cast<std::uint32_t>(a.v[i] + 0x1p23f) - 0x80'0000u; });
}
inline u32x4 countTrue(u32x4 c, mask4 m) {
  return eachLane<u32x4>([&](int i) { return c.v[i] + m.v[i]; });
}
template <int i>
inline std::uint32_t lane(u32x4 c) {
  return c.v[i];
}

}  // namespace cagecast::simd
