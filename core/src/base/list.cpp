#include "base/list.hpp"

namespace cagecast {

void* AnyList::grown(void* data, std::size_t size) noexcept {
  const std::size_t room = room_ < 32 ? 64 : 2 * room_;
  void* more = room > SIZE_MAX / size ? nullptr : std::realloc(data, room * size);
  failed_ = failed_ || more == nullptr;
  if (more == nullptr) return data;
  room_ = room;
  return more;
}

}  // namespace cagecast
