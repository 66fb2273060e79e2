#include "base/arena.hpp"

#include <algorithm>
#include <cstdlib>

namespace cagecast {

void Arena::begin() noexcept {
  if (blockCount_ > 1) {
    const std::size_t all = peak_;
    release();
    addBlock(all);
  }
  failed_ = false;
  peak_ = 0;
  rewind({0, 0});
}

void Arena::release() noexcept {
  for (std::size_t i = 0; i < blockCount_; ++i) std::free(blocks_[i].data);
  blockCount_ = current_ = used_ = 0;
}

void* Arena::allocateBytes(std::size_t count, std::size_t size) noexcept {
  const bool tooMany = count > (SIZE_MAX - kAlign) / size;
  const std::size_t bytes = (count * size + kAlign - 1) / kAlign * kAlign;
  while (!tooMany && current_ < blockCount_ && blocks_[current_].size - used_ < bytes) {
    ++current_;
    used_ = 0;
  }
  if (tooMany || (current_ == blockCount_ && !addBlock(bytes))) {
    failed_ = true;
    return nullptr;
  }
  void* place = blocks_[current_].data + used_;
  used_ += bytes;
  std::size_t inUse = used_;
  for (std::size_t i = 0; i < current_; ++i) inUse += blocks_[i].size;
  peak_ = std::max(peak_, inUse);
  return place;
}

bool Arena::addBlock(std::size_t size) noexcept {
  if (blockCount_ == kMaxBlocks) return false;
  size = std::max(size, kMinBlock);
  auto* data = static_cast<std::byte*>(std::malloc(size));
  if (data == nullptr) return false;
  blocks_[blockCount_++] = {data, size};
  return true;
}

}  // namespace cagecast
