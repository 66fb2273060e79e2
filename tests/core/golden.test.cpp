#include <fstream>

#include "checks.hpp"
#include "hash.hpp"

using namespace cagecast;

// The same files are asserted in every build, so that equal hashes mean equal bits everywhere. They change only when
// the method or the scenes do: write there what this test prints, and say why in the commit.
TEST_CASE("the answers on fixed scenes have the golden hashes", "[golden]") {
  const GoldenHashes hashes = GoldenHashes::compute();
  const auto golden = [](const std::string& name) {
    std::ifstream file(CAGECAST_GOLDEN + name);
    std::string hash;
    file >> hash;
    return hash;
  };
  CHECK(hashes.paper == golden("/hash.txt"));
  CHECK(hashes.standard == golden("/hash-default.txt"));
  CHECK(hashes.borders == golden("/hash-borders.txt"));
}
