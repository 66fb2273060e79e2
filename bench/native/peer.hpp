#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/timer.hpp"
#include "cagecast/transfer.hpp"
#include "model.hpp"

namespace cagecast::bench {

/// A way to do the work, or part of it.
class Contestant {
 public:
  virtual ~Contestant() = default;
  /// Does the work once, on valid input.
  /// @return CPU time of each step in milliseconds; 0 for steps that are not done.
  virtual Timings run(const Model& model) = 0;
  /// The zones of the last run, 1 per point; empty if there are none.
  [[nodiscard]] const std::vector<Zone>& zones() const { return zones_; }

 protected:
  std::vector<Zone> zones_;
};

// Peers only search. What the library does besides is done for them, and is not timed: they are given points, and make
// neither UVs nor segments. So ratios flatter the peers a little.

/// Steps 1 to 3 on Embree 3.
std::unique_ptr<Contestant> makeEmbreePeer();

/// The nearest cage vertex of each point, by nanoflann. Nothing is filtered.
std::unique_ptr<Contestant> makeNanoflannPeer();

}  // namespace cagecast::bench
