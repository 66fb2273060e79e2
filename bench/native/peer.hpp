#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cagecast/transfer.hpp"

namespace cagecast::bench {

/// Another way to do the same work, for comparison: from raw arrays to zones each time, as the product does it.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Does the whole work once, on valid input.
  /// @return CPU time of each step, in milliseconds. Steps that a peer does not do are 0.
  virtual Timings run(const MeshView& cage, const MeshView& target) = 0;
  /// The answer of the last run, one zone and one nearest triangle per vertex; empty if the peer does not give one.
  [[nodiscard]] const std::vector<Zone>& zones() const { return zones_; }
  [[nodiscard]] const std::vector<std::uint32_t>& triangles() const { return triangles_; }

 protected:
  std::vector<Zone> zones_;
  std::vector<std::uint32_t> triangles_;
};

/// The whole pipeline on Embree 3, in the form in which it is fastest; null where the benchmark was built without
/// Embree.
std::unique_ptr<Peer> makeEmbreePeer();

/// The naive transfer on nanoflann: weld, and the nearest cage vertex of every point. Nothing is filtered.
std::unique_ptr<Peer> makeNanoflannPeer();

}  // namespace cagecast::bench
