#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

namespace cagecast {

/// The working memory of a call: a stack of arrays, freed all at once and kept for the next call.
///
/// Blocks are taken from the system as they are needed. Running out is an answer (`failed()`), not the end of the process:
/// `take` then returns null and the step that asked gives up.
class Scratch {
 public:
  Scratch() noexcept = default;
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() { release(); }

  /// `count` values, uninitialised, aligned to 16 bytes; null if there is no memory left.
  template <typename T>
  [[nodiscard]] T* take(std::size_t count) noexcept {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlign);
    if (count > (SIZE_MAX - kAlign) / sizeof(T)) return fail<T>();
    const std::size_t size = (count * sizeof(T) + kAlign - 1) / kAlign * kAlign;
    while (current_ < blockCount_ && blocks_[current_].size - used_ < size) {
      ++current_;
      used_ = 0;
    }
    if (current_ == blockCount_ && !addBlock(size)) return fail<T>();
    T* place = reinterpret_cast<T*>(blocks_[current_].data + used_);
    used_ += size;
    note();
    return place;
  }

  /// Gives back the end of the array taken last.
  /// @param count  Elements to keep.
  template <typename T>
  void shrink(const T* array, std::size_t count) noexcept {
    const auto* end = reinterpret_cast<const std::byte*>(array + count);
    used_ = (static_cast<std::size_t>(end - blocks_[current_].data) + kAlign - 1) / kAlign * kAlign;
  }

  /// Where the stack stands.
  struct Mark {
    std::size_t block, used;
  };
  [[nodiscard]] Mark mark() const noexcept { return {current_, used_}; }
  /// Gives back everything taken since the mark.
  void rewind(Mark m) noexcept {
    current_ = m.block;
    used_ = m.used;
  }

  /// Empties the stack for a new call. What the last call needed in several blocks is taken as one.
  void begin() noexcept {
    if (blockCount_ > 1) {
      const std::size_t all = peak_;
      release();
      addBlock(all);
    }
    failed_ = false;
    peak_ = 0;
    rewind({0, 0});
  }
  /// Gives all memory back to the system.
  void release() noexcept {
    for (std::size_t i = 0; i < blockCount_; ++i) std::free(blocks_[i].data);
    blockCount_ = current_ = used_ = 0;
  }

  [[nodiscard]] bool failed() const noexcept { return failed_; }
  /// Most memory in use at once since `begin`, in bytes.
  [[nodiscard]] std::size_t peak() const noexcept { return peak_; }

 private:
  static constexpr std::size_t kAlign = 16;
  static constexpr std::size_t kMinBlock = std::size_t{1} << 16;
  static constexpr std::size_t kMaxBlocks = 64;
  struct Block {
    std::byte* data;
    std::size_t size;
  };

  template <typename T>
  T* fail() noexcept {
    failed_ = true;
    return nullptr;
  }
  void note() noexcept {
    std::size_t inUse = used_;
    for (std::size_t i = 0; i < current_; ++i) inUse += blocks_[i].size;
    if (inUse > peak_) peak_ = inUse;
  }
  bool addBlock(std::size_t size) noexcept {
    if (blockCount_ == kMaxBlocks) return false;
    if (size < kMinBlock) size = kMinBlock;
    auto* data = static_cast<std::byte*>(std::malloc(size));
    if (data == nullptr) return false;
    blocks_[blockCount_++] = {data, size};
    return true;
  }

  Block blocks_[kMaxBlocks] = {};
  std::size_t blockCount_ = 0;
  std::size_t current_ = 0;  ///< The block in use.
  std::size_t used_ = 0;     ///< Bytes used of it.
  std::size_t peak_ = 0;
  bool failed_ = false;
};

}  // namespace cagecast
