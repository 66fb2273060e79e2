#pragma once

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <type_traits>
#include <utility>

#include "cagecast/array.hpp"

namespace cagecast {

/// The part of a list that does not depend on its element type.
class AnyList {
 public:
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  /// Removes the elements from `size` on.
  void truncate(std::size_t size) noexcept { size_ = size < size_ ? size : size_; }

 protected:
  /// Makes more room, if there is memory for it.
  /// @param size  Of an element.
  /// @return The elements, where they are now.
  void* grown(void* data, std::size_t size) noexcept;

  std::size_t size_ = 0;
  std::size_t room_ = 0;
  bool failed_ = false;
};

/// A growable array of plain values. Like `Array` it reports a lack of memory; what was added after that is lost.
template <typename T>
class List : public AnyList {
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

  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }

  /// @return false if memory ran out, here or before.
  [[nodiscard]] bool copyTo(Array<T>& out) const noexcept {
    if (failed_ || !out.reset(size_)) return false;
    if (size_ > 0) std::memcpy(out.data(), data_, size_ * sizeof(T));
    return true;
  }

 private:
  bool grow() noexcept {
    data_ = static_cast<T*>(grown(data_, sizeof(T)));
    return size_ < room_;
  }

  T* data_ = nullptr;
};

}  // namespace cagecast
