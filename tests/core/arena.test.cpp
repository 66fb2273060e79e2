#include "base/arena.hpp"

#include <catch2/catch.hpp>

#include <cstdint>

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

using cagecast::Arena;

TEST_CASE("arrays of an arena are aligned and do not overlap", "[arena]") {
  Arena arena;
  const char* end = nullptr;
  for (const std::size_t count : std::initializer_list<std::size_t>{1, 3, 16, 1000, 100000}) {
    const char* array = arena.allocate<char>(count);
    REQUIRE(array != nullptr);
    CHECK(reinterpret_cast<std::uintptr_t>(array) % 16 == 0);
    CHECK((end == nullptr || array >= end || array + count <= end));
    end = array + count;
  }
}

TEST_CASE("an arena has room for many large arrays in a first call", "[arena]") {
  Arena arena;
  for (int i = 0; i < 200; ++i) REQUIRE(arena.allocate<char>(std::size_t{1} << 16) != nullptr);
}

TEST_CASE("once memory has run out, an arena gives none until it is restarted", "[arena]") {
  Arena arena(std::size_t{1} << 17);
  CHECK(arena.allocate<char>(std::size_t{1} << 20) == nullptr);
  CHECK(arena.failed());
  CHECK(arena.allocate<char>(1) == nullptr);
  {
    const Arena::Scope scope(arena);
    CHECK(arena.allocate<char>(1) == nullptr);
  }
  CHECK(arena.failed());
  arena.restart();
  CHECK_FALSE(arena.failed());
  CHECK(arena.allocate<char>(1) != nullptr);
  CHECK(arena.allocate<double>(SIZE_MAX / 4) == nullptr);
  CHECK(arena.failed());
}

#ifndef CAGECAST_SANITIZED
TEST_CASE("the end of a scope gives its arrays back", "[arena]") {
  Arena arena;
  const auto* kept = arena.allocate<int>(10);
  const int* first = nullptr;
  {
    const Arena::Scope scope(arena);
    first = arena.allocate<int>(10);
    (void)arena.allocate<int>(1 << 20);  // In a block of its own.
  }
  CHECK(kept != first);
  CHECK(arena.allocate<int>(10) == first);
}

TEST_CASE("a shrunk array keeps its begin and gives back its end", "[arena]") {
  Arena arena;
  const auto* array = arena.allocate<int>(1000);
  const std::size_t peak = arena.peak();
  arena.shrink(array, 4);
  const auto* next = arena.allocate<int>(4);
  CHECK(next >= array + 4);
  CHECK(next < array + 100);
  CHECK(arena.peak() == peak);
}

TEST_CASE("after a failure, nothing that was kept is in the way", "[arena]") {
  constexpr std::size_t kUnit = std::size_t{1} << 17;
  Arena arena(8 * kUnit);
  (void)arena.allocate<char>(4 * kUnit);
  const auto twoArrays = [&] {
    arena.restart();
    (void)arena.allocate<char>(3 * kUnit);
    return arena.allocate<char>(5 * kUnit - 64);
  };
  CHECK(twoArrays() == nullptr);
  CHECK(twoArrays() != nullptr);
}

TEST_CASE("a restarted arena has one block of what it needed before", "[arena]") {
  Arena arena;
  for (int i = 0; i < 5; ++i) (void)arena.allocate<char>(std::size_t{1} << 16);
  arena.restart();
  CHECK(arena.peak() == 0);
  const char* first = arena.allocate<char>(std::size_t{1} << 16);
  const char* second = arena.allocate<char>(std::size_t{1} << 16);
  CHECK(second > first);
  CHECK(second < first + (std::size_t{1} << 17));
}
#endif

#ifdef CAGECAST_SANITIZED
TEST_CASE("with AddressSanitizer, every array is an allocation of its own", "[arena]") {
  Arena arena;
  const auto isPoisoned = [](const void* at) { return __asan_address_is_poisoned(at) != 0; };
  const auto* array = arena.allocate<char>(20);
  CHECK_FALSE(isPoisoned(array));
  CHECK_FALSE(isPoisoned(array + 19));
  CHECK(isPoisoned(array + 20));
  const char* other = nullptr;
  {
    const Arena::Scope scope(arena);
    other = arena.allocate<char>(20);
    CHECK_FALSE(isPoisoned(other));
  }
  CHECK(isPoisoned(other));
  CHECK(arena.allocate<char>(20) != other);
  CHECK(isPoisoned(other));
  CHECK_FALSE(isPoisoned(array));
  const auto* last = arena.allocate<char>(20);
  CHECK(isPoisoned(last - 1));
  arena.shrink(last, 8);
  CHECK(isPoisoned(last + 8));
  CHECK_FALSE(isPoisoned(last + 7));
  arena.restart();
  CHECK(isPoisoned(array));
  CHECK(isPoisoned(last));
}
#endif
