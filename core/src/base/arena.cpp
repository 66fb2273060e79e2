#include "base/arena.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CAGECAST_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define CAGECAST_SANITIZED
#endif
#ifdef CAGECAST_SANITIZED
#include <sanitizer/asan_interface.h>
#endif

namespace cagecast {

#ifdef CAGECAST_SANITIZED

namespace {

/// Before each array.
struct alignas(16) Header {
  std::byte* previous;
  std::size_t size;
};

Header* headerOf(std::byte* array) {
  __asan_unpoison_memory_region(array - sizeof(Header), sizeof(Header));
  return std::launder(reinterpret_cast<Header*>(array - sizeof(Header)));
}
void hide(const Header* header) { __asan_poison_memory_region(header, sizeof(Header)); }

}  // namespace

void Arena::restart() noexcept {
  rewind({0, 0});
  failed_ = isExhausted_ = false;
  workLeft_ = UINT64_MAX;
  peak_ = 0;
}

void Arena::release() noexcept { rewind({0, 0}); }

void Arena::rewind(Mark mark) noexcept {
  for (; current_ > mark.block; --current_) {
    Header* const header = headerOf(newest_);
    newest_ = header->previous;
    std::free(header);
  }
  used_ = mark.used;
}

void* Arena::allocateBytes(std::size_t count, std::size_t size) noexcept {
  if (failed_) return nullptr;
  const bool isTooMuch = count > (SIZE_MAX - sizeof(Header)) / size || count * size > limit_ - std::min(limit_, used_);
  void* const data = isTooMuch ? nullptr : std::malloc(sizeof(Header) + count * size);
  if (data == nullptr) {
    failed_ = true;
    return nullptr;
  }
  hide(new (data) Header{newest_, count * size});
  newest_ = static_cast<std::byte*>(data) + sizeof(Header);
  ++current_;
  used_ += count * size;
  peak_ = std::max(peak_, used_);
  return newest_;
}

void Arena::shrinkTo(const std::byte* end) noexcept {
  if (failed_) return;
  Header* const header = headerOf(newest_);
  const std::size_t given = static_cast<std::size_t>(newest_ + header->size - end);
  __asan_poison_memory_region(end, given);
  header->size -= given;
  used_ -= given;
  hide(header);
}

#else

void Arena::restart() noexcept {
  rewind({0, 0});
  if (failed_) release();  // Gaps in what was kept may have been in the way.
  if (blockCount_ > 1) {
    const std::size_t all = peak_;
    release();
    addBlock(all);
  }
  failed_ = isExhausted_ = false;
  workLeft_ = UINT64_MAX;
  peak_ = 0;
}

void Arena::release() noexcept {
  for (std::size_t i = 0; i < blockCount_; ++i) std::free(blocks_[i].data);
  blockCount_ = current_ = used_ = 0;
}

void Arena::rewind(Mark mark) noexcept {
  current_ = mark.block;
  used_ = mark.used;
}

void* Arena::allocateBytes(std::size_t count, std::size_t size) noexcept {
  if (failed_) return nullptr;
  const bool isTooMuch = count > (SIZE_MAX - kAlign) / size;
  const std::size_t bytes = (count * size + kAlign - 1) / kAlign * kAlign;
  while (!isTooMuch && current_ < blockCount_ && blocks_[current_].size - used_ < bytes) {
    ++current_;
    used_ = 0;
  }
  if (isTooMuch || (current_ == blockCount_ && !addBlock(bytes))) {
    failed_ = true;
    return nullptr;
  }
  std::byte* const array = blocks_[current_].data + used_;
  used_ += bytes;
  peak_ = std::max(peak_, bytesBefore(current_) + used_);
  return array;
}

void Arena::shrinkTo(const std::byte* end) noexcept {
  if (failed_) return;
  std::byte* const block = blocks_[current_].data;
  used_ = (static_cast<std::size_t>(end - block) + kAlign - 1) / kAlign * kAlign;
}

bool Arena::addBlock(std::size_t size) noexcept {
  size = std::max(size, kMinBlock);
  if (blockCount_ == kMaxBlocks || size > limit_ - std::min(limit_, bytesBefore(blockCount_))) return false;
  auto* data = static_cast<std::byte*>(std::malloc(size));
  if (data == nullptr) return false;
  blocks_[blockCount_++] = {data, size};
  return true;
}

std::size_t Arena::bytesBefore(std::size_t block) const noexcept {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < block; ++i) bytes += blocks_[i].size;
  return bytes;
}

#endif

}  // namespace cagecast
