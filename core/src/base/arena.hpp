#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace cagecast {

/// The working memory of a call: a stack of arrays, freed all at once and kept for the next call.
///
/// Blocks are taken from the system as they are needed. Running out is an answer (`failed()`), not the end of the
/// process: `take` then returns null and the step that asked gives up.
class Arena {
 public:
  Arena() noexcept = default;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() { release(); }

  /// `count` values, uninitialised, aligned to 16 bytes; null if there is no memory left.
  template <typename T>
  [[nodiscard]] T* allocate(std::size_t count) noexcept {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlign);
    return static_cast<T*>(allocateBytes(count, sizeof(T)));
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
  void begin() noexcept;
  /// Gives all memory back to the system.
  void release() noexcept;

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

  void* allocateBytes(std::size_t count, std::size_t size) noexcept;
  bool addBlock(std::size_t size) noexcept;

  Block blocks_[kMaxBlocks] = {};
  std::size_t blockCount_ = 0;
  std::size_t current_ = 0;  ///< The block in use.
  std::size_t used_ = 0;     ///< Bytes used of it.
  std::size_t peak_ = 0;
  bool failed_ = false;
};

}  // namespace cagecast
