#pragma once

#include <ctime>

namespace cagecast {

/// Milliseconds of CPU time of this thread; of wall time where there is no such clock (WebAssembly).
inline double cpuMilliseconds() noexcept {
  timespec now{};
#if defined(CLOCK_THREAD_CPUTIME_ID) && !defined(__EMSCRIPTEN__)
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
#else
  clock_gettime(CLOCK_MONOTONIC, &now);
#endif
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

/// Hands out the time since it was last asked.
class StopWatch {
 public:
  double lap() noexcept {
    const double before = last_;
    last_ = cpuMilliseconds();
    return last_ - before;
  }

 private:
  double last_ = cpuMilliseconds();
};

}  // namespace cagecast
