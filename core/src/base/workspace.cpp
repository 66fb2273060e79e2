#include <new>
#include <utility>

#include "base/arena.hpp"
#include "cagecast/transfer.hpp"

namespace cagecast {

Workspace::Workspace(Workspace&& other) noexcept : arena_(std::exchange(other.arena_, nullptr)), limit_(other.limit_) {}

Workspace& Workspace::operator=(Workspace&& other) noexcept {
  std::swap(arena_, other.arena_);
  std::swap(limit_, other.limit_);
  return *this;
}

Workspace::~Workspace() { release(); }

void Workspace::release() noexcept { delete std::exchange(arena_, nullptr); }

Arena* Workspace::restart() noexcept {
  if (arena_ == nullptr) {
    arena_ = new (std::nothrow) Arena(limit_);
  } else {
    arena_->restart();
  }
  return arena_;
}

}  // namespace cagecast
