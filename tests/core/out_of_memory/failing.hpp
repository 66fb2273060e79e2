#pragma once

#include <cstddef>
#include <cstring>
#include <new>

/// Allocations that fail on demand. The linker hands every call of malloc and of operator new to the functions below
/// (`--wrap`), so one file of a program includes this, and no more.
namespace failing {

/// How many more allocations succeed; none is counted while this is not on.
inline thread_local bool isOn = false;
inline thread_local std::size_t left = 0;
inline thread_local bool ranOut = false;
/// Whether a single call of malloc fails, and nothing else.
inline thread_local bool isOneMalloc = false;
/// What new memory is filled with; negative: nothing.
inline thread_local int filling = -1;

/// Lets all allocations of this thread fail after the next `count`.
inline void start(std::size_t count) {
  left = count;
  ranOut = isOneMalloc = false;
  isOn = true;
}
/// Lets one call of malloc in this thread fail after the next `count`: not even operator new tells then that memory is
/// short.
inline void startOneMalloc(std::size_t count) {
  start(count);
  isOneMalloc = true;
}
/// @return whether any failed since `start`.
inline bool stop() {
  isOn = false;
  return ranOut;
}

/// @return false if this allocation has to fail.
inline bool mayTake() {
  if (!isOn) return true;
  if (left > 0) {
    --left;
    return true;
  }
  ranOut = true;
  if (isOneMalloc) isOn = false;
  return false;
}

}  // namespace failing

extern "C" {
void* __real_malloc(std::size_t size);                                      // NOLINT: the linker's names
void* __wrap_malloc(std::size_t size);                                      // NOLINT
void* __real__Znwm(std::size_t size);                                       // NOLINT: operator new
void* __wrap__Znwm(std::size_t size);                                       // NOLINT
void* __real__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t&);  // NOLINT
void* __wrap__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t&);  // NOLINT

void* __wrap_malloc(std::size_t size) {  // NOLINT
  void* const data = failing::mayTake() ? __real_malloc(size) : nullptr;
  return data == nullptr || failing::filling < 0 ? data : std::memset(data, failing::filling, size);
}
void* __wrap__Znwm(std::size_t size) {  // NOLINT
  if (!failing::isOneMalloc && !failing::mayTake()) throw std::bad_alloc();
  return __real__Znwm(size);
}
void* __wrap__ZnwmRKSt9nothrow_t(std::size_t size, const std::nothrow_t& tag) {  // NOLINT
  return failing::isOneMalloc || failing::mayTake() ? __real__ZnwmRKSt9nothrow_t(size, tag) : nullptr;
}
}
