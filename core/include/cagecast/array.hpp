#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>
#include <utility>

namespace cagecast {

/// An owning, movable array of plain values. It reports a lack of memory without an exception.
///
/// Results use it because the core reports a lack of memory as `Code::outOfMemory` instead of ending the process, which
/// `std::vector` cannot do in a build without exceptions (WebAssembly).
template <typename T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>, "elements are copied as bytes");

 public:
  Array() noexcept = default;
  Array(Array&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  Array& operator=(Array&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { std::free(data_); }

  /// Sets the size to `count`. The values are unspecified: earlier ones are lost.
  /// @return false, with the array empty, if there is not enough memory.
  [[nodiscard]] bool reset(std::size_t count) noexcept {
    if (count == size_) return true;
    std::free(std::exchange(data_, nullptr));
    size_ = 0;
    if (count == 0) return true;
    if (count > SIZE_MAX / sizeof(T)) return false;
    data_ = static_cast<T*>(std::malloc(count * sizeof(T)));
    if (data_ == nullptr) return false;
    size_ = count;
    return true;
  }

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] T* data() noexcept { return data_; }
  [[nodiscard]] const T* data() const noexcept { return data_; }
  [[nodiscard]] T* begin() noexcept { return data_; }
  [[nodiscard]] T* end() noexcept { return data_ + size_; }
  [[nodiscard]] const T* begin() const noexcept { return data_; }
  [[nodiscard]] const T* end() const noexcept { return data_ + size_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace cagecast
