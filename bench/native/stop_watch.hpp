#pragma once

#include "base/timer.hpp"

namespace cagecast::bench {

/// Hands out the time since it was last asked.
class StopWatch {
 public:
  double lap() noexcept {
    const double before = last_;
    last_ = clockMilliseconds();
    return last_ - before;
  }

 private:
  double last_ = clockMilliseconds();
};

}  // namespace cagecast::bench
