#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "cagecast/cagecast_c.h"
#include "cagecast/status.hpp"

/// What the C interfaces of both libraries share.
namespace cagecast::c {

template <typename T>
std::span<const T> listOf(const T* items, std::size_t count) noexcept {
  return {items, items == nullptr ? 0 : count};
}

inline std::span<const std::uint32_t> listOf(const CagecastList& list) noexcept {
  return listOf(list.items, list.count);
}

/// What a pointer points to; for NULL, nothing, which is checked as input like all else.
template <typename T>
T orEmpty(const T* value) noexcept {
  return value == nullptr ? T{} : *value;
}

inline MeshView viewOf(const CagecastMesh* mesh) noexcept {
  if (mesh == nullptr) return {};
  const std::size_t vertices = mesh->vertexCount, triangles = mesh->triangleCount;
  return {.positions = listOf(mesh->positions, 3 * vertices),
          .indices = listOf(mesh->indices, 3 * triangles),
          .uvs = listOf(mesh->uvs, 2 * vertices),
          .groups = listOf(mesh->groups, vertices),
          .poses = listOf(mesh->poses, 3 * vertices * mesh->poseCount)};
}

/// The value of a C field that counts: a number that no value of the type has stays one.
template <typename T>
T choiceOf(std::int32_t value) noexcept {
  return static_cast<T>(value >= 0 && value < 255 ? value : 255);
}

/// The values of an array, or null if it is empty.
template <typename List>
auto dataOf(const List& list) noexcept {
  return list.empty() ? nullptr : list.data();
}

inline CagecastError errorOf(const Status& status, std::string_view sentence) noexcept {
  CagecastError out{
      codeName(status.code), argumentName(status.argument), optionName(status.option), status.at, status.value, {}};
  std::size_t length = std::min(sentence.size(), sizeof out.message - 1);
  // Not within a character of UTF-8.
  if (length < sentence.size())
    while (length > 0 && (static_cast<unsigned char>(sentence[length]) & 0xc0) == 0x80) --length;
  std::memcpy(out.message, sentence.data(), length);
  return out;
}

/// Fills a result of C, or its error.
/// @param call  Gets the memory of the result and the place of a sentence about an error. It returns a status.
/// @param show  Lets the result point to what is in its memory.
template <typename Memory, typename Result, typename Call, typename Show>
std::int32_t fill(Result* out, const Call& call, const Show& show) noexcept {
  auto* memory = static_cast<Memory*>(out->memory);
  *out = {};
  Status status;
  std::string sentence;
  try {
    if (memory == nullptr) memory = new Memory;
    status = call(*memory, sentence);
  } catch (...) {  // Nothing but a lack of memory is thrown.
    status = {.code = Code::outOfMemory};
  }
  out->memory = memory;
  out->error = errorOf(status, status.code == Code::outOfMemory ? "not enough memory" : std::string_view(sentence));
  if (status.ok()) show(*memory);
  return status.ok() ? 0 : 1;
}

template <typename Memory, typename Result>
void release(Result* result) noexcept {
  if (result == nullptr) return;
  delete static_cast<Memory*>(result->memory);
  *result = {};
}

}  // namespace cagecast::c
