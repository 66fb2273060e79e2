#include <cstring>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "checks.hpp"

using namespace cagecast;

namespace {

/// FNV-1a, 64 bits, over the bytes of arrays.
class Hash {
 public:
  template <typename T>
  void add(const Array<T>& values) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    for (std::size_t i = 0; i < values.size() * sizeof(T); ++i) hash_ = (hash_ ^ bytes[i]) * 0x100000001b3u;
  }
  std::string text() const {
    std::ostringstream out;
    out << std::hex << std::setw(16) << std::setfill('0') << hash_;
    return out.str();
  }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace

// The same file is asserted in every build, so that equal hashes mean equal bits everywhere. It changes only when the
// method or the scenes do: write there what this test prints, and say why in the commit.
TEST_CASE("the answer on fixed scenes has the golden hash", "[golden]") {
  Hash hash;
  for (const scenes::Scene& scene : scenes::golden()) {
    const TransferResult result = transferred(scene.cage.view(), scene.target.view());
    hash.add(result.projection.uvs);
    hash.add(result.zones.zones);
    hash.add(result.projection.triangles);
    hash.add(result.projection.segments);
  }
  std::ifstream file(CAGECAST_GOLDEN);
  std::string expected;
  file >> expected;
  CHECK(hash.text() == expected);
}
