#pragma once

#include <cstdint>

namespace cagecast {

/// Whether s goes before t, as `order` has it.
using GoesBefore = bool (*)(const void* order, std::uint64_t s, std::uint64_t t);
void heapSort(std::uint64_t* begin, std::uint64_t* end, const void* order, GoesBefore goesBefore) noexcept;

/// Sorts what is seldom sorted: by heap, and all by the same code. std::sort would be 5 KB of WebAssembly for each.
/// @param order  Takes two items, and tells whether the first goes before the other.
template <typename Order>
void heapSort(std::uint64_t* begin, std::uint64_t* end, const Order& order) noexcept {
  heapSort(begin, end, &order,
           [](const void* of, std::uint64_t s, std::uint64_t t) { return (*static_cast<const Order*>(of))(s, t); });
}

}  // namespace cagecast
