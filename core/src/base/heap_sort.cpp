#include "base/heap_sort.hpp"

#include <algorithm>

namespace cagecast {

void heapSort(std::uint64_t* begin, std::uint64_t* end, const void* order, GoesBefore goesBefore) noexcept {
  const auto before = [=](std::uint64_t s, std::uint64_t t) { return goesBefore(order, s, t); };
  std::make_heap(begin, end, before);
  std::sort_heap(begin, end, before);
}

}  // namespace cagecast
