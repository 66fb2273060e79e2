#include "base/arena.hpp"

#include <algorithm>
#include <cstdlib>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CAGECAST_POISONS
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define CAGECAST_POISONS
#endif
#ifdef CAGECAST_POISONS
#include <sanitizer/asan_interface.h>
#endif

namespace cagecast {
namespace {

#ifdef CAGECAST_POISONS
/// Bytes between two arrays.
constexpr std::size_t kGap = 32;
void poison(const std::byte* begin, std::size_t size) { __asan_poison_memory_region(begin, size); }
void unpoison(const std::byte* begin, std::size_t size) { __asan_unpoison_memory_region(begin, size); }
#else
constexpr std::size_t kGap = 0;
void poison(const std::byte*, std::size_t) {}
void unpoison(const std::byte*, std::size_t) {}
#endif

}  // namespace

void Arena::restart() noexcept {
  rewind({0, 0});
  if (blockCount_ > 1) {
    const std::size_t all = peak_;
    release();
    addBlock(all);
  }
  failed_ = false;
  peak_ = 0;
}

void Arena::release() noexcept {
  for (std::size_t i = 0; i < blockCount_; ++i) {
    unpoison(blocks_[i].data, blocks_[i].size);
    std::free(blocks_[i].data);
  }
  blockCount_ = current_ = used_ = 0;
}

void Arena::rewind(Mark mark) noexcept {
  for (std::size_t i = mark.block; i < blockCount_ && i <= current_; ++i) {
    const std::size_t kept = i == mark.block ? mark.used : 0;
    poison(blocks_[i].data + kept, blocks_[i].size - kept);
  }
  current_ = mark.block;
  used_ = mark.used;
}

void* Arena::allocateBytes(std::size_t count, std::size_t size) noexcept {
  if (failed_) return nullptr;
  const bool isTooMuch = count > (SIZE_MAX - kAlign - kGap) / size;
  const std::size_t bytes = (count * size + kAlign - 1) / kAlign * kAlign + kGap;
  while (!isTooMuch && current_ < blockCount_ && blocks_[current_].size - used_ < bytes) {
    ++current_;
    used_ = 0;
  }
  if (isTooMuch || (current_ == blockCount_ && !addBlock(bytes))) {
    failed_ = true;
    return nullptr;
  }
  std::byte* const array = blocks_[current_].data + used_;
  unpoison(array, count * size);
  used_ += bytes;
  peak_ = std::max(peak_, bytesBefore(current_) + used_);
  return array;
}

void Arena::shrinkTo(const std::byte* end) noexcept {
  if (failed_) return;
  std::byte* const block = blocks_[current_].data;
  poison(end, static_cast<std::size_t>(block + used_ - end));
  used_ = (static_cast<std::size_t>(end - block) + kAlign - 1) / kAlign * kAlign + kGap;
}

bool Arena::addBlock(std::size_t size) noexcept {
  size = std::max(size, kMinBlock);
  if (blockCount_ == kMaxBlocks || size > limit_ - std::min(limit_, bytesBefore(blockCount_))) return false;
  auto* data = static_cast<std::byte*>(std::malloc(size));
  if (data == nullptr) return false;
  poison(data, size);
  blocks_[blockCount_++] = {data, size};
  return true;
}

std::size_t Arena::bytesBefore(std::size_t block) const noexcept {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < block; ++i) bytes += blocks_[i].size;
  return bytes;
}

}  // namespace cagecast
