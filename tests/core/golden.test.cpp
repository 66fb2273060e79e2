#include <fstream>

#include "checks.hpp"
#include "hash.hpp"

using namespace cagecast;

// The same file is asserted in every build, so that equal hashes mean equal bits everywhere. It changes only when the
// method or the scenes do: write there what this test prints, and say why in the commit.
TEST_CASE("the answer on fixed scenes has the golden hash", "[golden]") {
  Hash hash;
  for (const scenes::Scene& scene : scenes::golden()) {
    hash.add(transferred(scene.cage.view(), scene.target.view()));
  }
  std::ifstream file(CAGECAST_GOLDEN);
  std::string expected;
  file >> expected;
  CHECK(hash.text() == expected);
}
