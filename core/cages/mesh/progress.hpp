#pragma once

#include "cagecast/cages.hpp"

namespace cagecast::cages {

/// How a call ends when `Progress` returned false.
inline Outcome cancelled() { return {Problem::cancelled, "cancelled"}; }

/// Reports a part of the work as going from one share of the whole to another.
/// @param progress  Must outlive the result; nothing is reported if it is empty.
inline Progress partOf(const Progress& progress, float from, float to) {
  if (!progress) return {};
  return [&progress, from, to](float share, const char* stage) { return progress(from + (to - from) * share, stage); };
}

}  // namespace cagecast::cages
