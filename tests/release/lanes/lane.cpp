/// Prints the hashes of the answers on fixed scenes: of the preset `paper`, of `default`, and of cut borders. Every
/// build prints the same.

#include <cstdio>

#include "hash.hpp"

int main() {
  const cagecast::GoldenHashes hashes = cagecast::GoldenHashes::compute();
  std::printf("%s %s %s\n", hashes.paper.c_str(), hashes.standard.c_str(), hashes.borders.c_str());
}
