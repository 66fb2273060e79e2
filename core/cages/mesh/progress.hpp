#pragma once

#include <cstddef>
#include <new>
#include <stdexcept>

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// How a call ends when `Progress` returned false.
inline constexpr Status kAborted{Code::aborted};

/// The status of a call, also if its memory runs out: inside, vectors throw `std::bad_alloc`, or `std::length_error`
/// for what no memory could hold.
template <typename Call>
Status guarded(const Call& call) {
#ifdef __cpp_exceptions
  try {
    return call();
  } catch (const std::bad_alloc&) {
    return {Code::outOfMemory};
  } catch (const std::length_error&) {
    return {Code::outOfMemory};
  }
#else
  return call();
#endif
}

/// Reports how far a call is. @return false if that cancels it.
inline bool report(const Progress& progress, double share, const char* stage) {
  return !progress || progress(static_cast<float>(share), stage);
}

/// The same for work of a known amount.
inline bool report(const Progress& progress, std::size_t done, std::size_t all, const char* stage) {
  return report(progress, static_cast<double>(done) / static_cast<double>(all), stage);
}

/// Reports a part of the work as going from one share of the whole to another.
/// @param progress  Must outlive the result; nothing is reported if it is empty.
inline Progress partOf(const Progress& progress, float from, float to) {
  if (!progress) return {};
  return [&progress, from, to](float share, const char* stage) { return progress(from + (to - from) * share, stage); };
}

}  // namespace cagecast::cages
