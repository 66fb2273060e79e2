#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace cagecast {

/// The working memory of a call: a stack of arrays in a few large blocks, which are kept for the next call. It also
/// counts the work of the call, which may have a limit.
///
/// Running out of memory or of work is sticky: from then on `allocate` returns null and `failed()` stays true until
/// `restart`. A step allocates all its arrays, checks `failed()` once and returns; the steps after it do the same, so
/// only the end of a call has to report it.
///
/// With AddressSanitizer, every array is an allocation of its own: reading past an array, or an array that was given
/// back, ends the program.
class Arena {
 public:
  /// @param limit  Most bytes to take from the system.
  explicit Arena(std::size_t limit = SIZE_MAX) noexcept : limit_(limit) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() { release(); }

  /// @return `count` uninitialised values, aligned to 16 bytes; null if memory has run out.
  template <typename T>
  [[nodiscard]] T* allocate(std::size_t count) noexcept {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlign);
    return static_cast<T*>(allocateBytes(count, sizeof(T)));
  }

  /// Gives back the end of the array allocated last.
  /// @param count  Elements to keep.
  template <typename T>
  void shrink(const T* array, std::size_t count) noexcept {
    shrinkTo(reinterpret_cast<const std::byte*>(array + count));
  }

  /// How much of the stack is in use.
  struct Mark {
    std::size_t block, used;
  };
  [[nodiscard]] Mark mark() const noexcept { return {current_, used_}; }
  /// Gives back everything allocated since the mark.
  void rewind(Mark mark) noexcept;

  /// Gives back, at the end of a scope of the program, everything allocated in it.
  class Scope {
   public:
    [[nodiscard]] explicit Scope(Arena& arena) noexcept : arena_(arena), mark_(arena.mark()) {}
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    ~Scope() { arena_.rewind(mark_); }

   private:
    Arena& arena_;
    Mark mark_;
  };

  /// Empties the stack for a new call, and forgets that memory or work ran out. What the last call needed in several
  /// blocks becomes one.
  void restart() noexcept;
  /// Gives all memory back to the system.
  void release() noexcept;

  /// Limits the work from now on, in tests of a few triangles against a ray or a point. Default: no limit.
  void limitWork(std::uint64_t work) noexcept { workLeft_ = work; }
  [[nodiscard]] std::uint64_t workLeft() const noexcept { return workLeft_; }
  /// Counts work that was done. If it is more than what was left, the call has failed.
  void spend(std::uint64_t work) noexcept {
    isExhausted_ = isExhausted_ || work > workLeft_;
    failed_ = failed_ || isExhausted_;
    workLeft_ -= work < workLeft_ ? work : workLeft_;
  }
  /// Whether the work has run out since `restart`.
  [[nodiscard]] bool isExhausted() const noexcept { return isExhausted_; }

  /// Whether memory or work has run out since `restart`.
  [[nodiscard]] bool failed() const noexcept { return failed_; }
  /// Reports that memory ran out elsewhere: for arrays of the result, which are not in the arena.
  void fail() noexcept { failed_ = true; }
  /// Most memory in use at once since `restart`, in bytes.
  [[nodiscard]] std::size_t peak() const noexcept { return peak_; }

 private:
  static constexpr std::size_t kAlign = 16;
  static constexpr std::size_t kMinBlock = std::size_t{1} << 16;
  /// In a first call each array of `kMinBlock` and more is a block of its own: soups of triangles needed up to 71.
  static constexpr std::size_t kMaxBlocks = 256;
  struct Block {
    std::byte* data;
    std::size_t size;
  };

  void* allocateBytes(std::size_t count, std::size_t size) noexcept;
  void shrinkTo(const std::byte* end) noexcept;
  bool addBlock(std::size_t size) noexcept;
  /// Bytes in the blocks before one.
  [[nodiscard]] std::size_t bytesBefore(std::size_t block) const noexcept;

  Block blocks_[kMaxBlocks] = {};
  std::size_t blockCount_ = 0;
  std::size_t current_ = 0;      ///< The block in use. With AddressSanitizer, the number of arrays.
  std::size_t used_ = 0;         ///< Bytes used of it. With AddressSanitizer, of all arrays.
  std::byte* newest_ = nullptr;  ///< With AddressSanitizer, the array allocated last.
  std::size_t peak_ = 0;
  std::size_t limit_;
  std::uint64_t workLeft_ = UINT64_MAX;
  bool failed_ = false;
  bool isExhausted_ = false;
};

}  // namespace cagecast
