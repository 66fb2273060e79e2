#pragma once

#if defined(__EMSCRIPTEN__)
#include <emscripten/emscripten.h>
#else
#include <chrono>
#include <ctime>
#endif

namespace cagecast {

/// Milliseconds of CPU time of this thread; of wall time where there is no such clock (WebAssembly, Windows).
inline double clockMilliseconds() noexcept {
#if defined(__EMSCRIPTEN__)
  return emscripten_get_now();
#elif defined(CLOCK_THREAD_CPUTIME_ID)
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
#else
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
#endif
}

/// Adds the time from its construction to its destruction.
class Timer {
 public:
  explicit Timer(double& milliseconds) noexcept : milliseconds_(milliseconds) {}
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;
  ~Timer() { milliseconds_ += clockMilliseconds() - start_; }

 private:
  double& milliseconds_;
  double start_ = clockMilliseconds();
};

/// Runs a step and adds the time that it takes.
/// @return What the step returns.
template <typename Step>
auto timed(double& milliseconds, Step step) noexcept {
  const Timer timer(milliseconds);
  return step();
}

}  // namespace cagecast
