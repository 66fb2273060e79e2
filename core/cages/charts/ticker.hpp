#pragma once

#include <algorithm>
#include <cstddef>

#include "mesh/progress.hpp"

namespace cagecast::cages {

/// Tells a caller how far an unwrap is, and remembers if it was cancelled; then everything returns early.
class Ticker {
 public:
  explicit Ticker(const Progress& progress) : progress_(progress) {}

  /// Sets the share that is done.
  void reach(double share) { share_ = std::max(share_, std::min(share, 1.0)); }

  /// Counts work, in triangles looked at, and asks the caller now and then.
  /// @return false if cancelled.
  bool work(std::size_t triangles) {
    work_ += triangles;
    if (work_ < kWorkPerReport || cancelled_) return !cancelled_;
    work_ = 0;
    cancelled_ = !report(progress_, share_, "unwrap");
    return !cancelled_;
  }
  [[nodiscard]] bool cancelled() const { return cancelled_; }

 private:
  /// Takes about 5 ms natively, 15 ms in WebAssembly.
  static constexpr std::size_t kWorkPerReport = 6000;
  const Progress& progress_;
  double share_ = 0;
  std::size_t work_ = kWorkPerReport;
  bool cancelled_ = false;
};

}  // namespace cagecast::cages
