#pragma once

#include <catch2/catch.hpp>

#include <limits>
#include <string>
#include <vector>

#include "reference/reference.hpp"
#include "scenes/scenes.hpp"
#include "seed.hpp"

/// What several tests ask.
namespace cagecast {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Of all tests: so that each of them also tests whether a call finds anything of the one before.
inline Workspace& testWorkspace() {
  static Workspace workspace;
  return workspace;
}

/// Transfers valid meshes.
inline TransferResult transferred(const MeshView& cage, const MeshView& target,
                                  const TransferOptions& options = TransferOptions::paper()) {
  TransferResult result;
  const Status status = transfer(cage, target, options, testWorkspace(), result);
  INFO(describe(status, cage, target));
  REQUIRE(status.ok());
  return result;
}

/// Requires the library to give the reference's answer at every vertex where that is stable.
/// @return How the two compare, for the share of unstable vertices.
inline reference::Differences requireSameAsReference(const std::string& name, const MeshView& cage,
                                                     const MeshView& target,
                                                     const TransferOptions& options = TransferOptions::paper()) {
  const TransferResult product = transferred(cage, target, options);
  const reference::Differences found = compare(reference::transfer(cage, target, options), product, target);
  INFO(name << ": " << found.vertices << " vertices, " << found.unstable << " unstable\n" << found.details);
  CHECK(found.zones == 0);
  CHECK(found.triangles == 0);
  CHECK(found.uvs == 0);
  CHECK(found.distances == 0);
  CHECK(found.segments == 0);
  CHECK(found.painted == 0);
  CHECK(found.corners == 0);
  CHECK(found.stats == 0);
  return found;
}

/// A copy as a vector, which Catch can print and compare.
template <typename T>
std::vector<T> copied(const Array<T>& values) {
  return {values.begin(), values.end()};
}

}  // namespace cagecast
