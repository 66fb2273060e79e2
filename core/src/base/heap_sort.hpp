#pragma once

#include <cstdint>

namespace cagecast {

/// Whether s goes before t, as `order` has it.
using GoesBefore = bool (*)(const void* order, std::uint64_t s, std::uint64_t t);
void heapSort(std::uint64_t* begin, std::uint64_t* end, const void* order, GoesBefore goesBefore) noexcept;

/// Heap sort, one function for all orders, for sorting that takes little of the time: each instance of std::sort would
/// add 5 KB to the WebAssembly module.
/// @param order  Takes two items, and tells whether the first goes before the second.
template <typename Order>
void heapSort(std::uint64_t* begin, std::uint64_t* end, const Order& order) noexcept {
  heapSort(begin, end, &order,
           [](const void* of, std::uint64_t s, std::uint64_t t) { return (*static_cast<const Order*>(of))(s, t); });
}

}  // namespace cagecast
