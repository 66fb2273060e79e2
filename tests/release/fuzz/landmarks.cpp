// Finds the landmarks of any model: a status with a sentence, or landmarks somewhere.

#include "cagecast/cages.hpp"
#include "fuzz/figure.hpp"

using namespace cagecast;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input(data, size);
  fuzz::Patience patience(input);
  const fuzz::Figure figure(input);
  cages::FoundLandmarks found;
  const Status status = findLandmarks(figure.model, patience.progress(), found);
  if (fuzz::isDone(status, patience, figure.model)) fuzz::check(found.landmarks);
  return 0;
}
