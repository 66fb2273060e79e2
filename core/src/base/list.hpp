#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <type_traits>

#include "cagecast/array.hpp"

namespace cagecast {

/// A growable array of plain values. Like `Array` it reports a lack of memory; what was added after that is lost.
template <typename T>
class List {
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes");

 public:
  List() noexcept = default;
  List(const List&) = delete;
  List& operator=(const List&) = delete;
  ~List() { std::free(data_); }

  void add(const T& value) noexcept {
    if (size_ == room_ && !grow()) return;
    data_[size_++] = value;
  }
  /// Removes one element; later ones move forward.
  void remove(std::size_t i) noexcept { std::memmove(data_ + i, data_ + i + 1, (--size_ - i) * sizeof(T)); }

  /// Removes the elements from `size` on.
  void truncate(std::size_t size) noexcept { size_ = std::min(size_, size); }

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }

  /// @return false if memory ran out, here or before.
  [[nodiscard]] bool copyTo(Array<T>& out) const noexcept {
    if (failed_ || !out.reset(size_)) return false;
    if (size_ > 0) std::memcpy(out.data(), data_, size_ * sizeof(T));
    return true;
  }

 private:
  /// Makes more room. @return false if there is no memory for it.
  bool grow() noexcept {
    const std::size_t room = room_ < 32 ? 64 : 2 * room_;
    auto* more = room > SIZE_MAX / sizeof(T) ? nullptr : static_cast<T*>(std::realloc(data_, room * sizeof(T)));
    if (more == nullptr) {
      failed_ = true;
      return false;
    }
    data_ = more;
    room_ = room;
    return true;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t room_ = 0;
  bool failed_ = false;
};

}  // namespace cagecast
