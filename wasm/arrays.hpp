#pragma once

#include <emscripten/val.h>
#include <cagecast/array.hpp>
#include <cagecast/mesh.hpp>
#include <cagecast/status.hpp>

#include <string>
#include <type_traits>

/// How arrays and meshes cross from JavaScript to C++ and back.
namespace cagecast::bindings {

using emscripten::val;

/// The element type that a typed array has for T: the number behind an enumeration.
template <typename T, bool kIsEnum = std::is_enum_v<T>>
struct ElementOf {
  using type = T;
};
template <typename T>
struct ElementOf<T, true> {
  using type = std::underlying_type_t<T>;
};

/// A typed array that shows C++ memory. It is valid until the next call into C++.
template <typename T>
val view(const Array<T>& array) {
  return val(
      emscripten::typed_memory_view(array.size(), reinterpret_cast<const typename ElementOf<T>::type*>(array.data())));
}

/// Copies a typed array into C++ memory; an undefined one is empty.
/// @return false if there is not enough memory.
template <typename T>
bool copyArray(const val& source, Array<T>& out) {
  if (!out.reset(source.isUndefined() ? 0 : source["length"].as<std::size_t>())) return false;
  if (!out.empty()) view(out).template call<void>("set", source);
  return true;
}

/// Copies an array of records or enumeration values, one by one.
template <typename T>
bool copyRecords(const val& source, Array<T>& out) {
  if (!out.reset(source["length"].as<std::size_t>())) return false;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = source[i].as<T>();
  return true;
}

/// An array of records, names or enumeration values.
template <typename List>
val listed(const List& values) {
  val out = val::array();
  for (std::size_t i = 0; i < values.size(); ++i) out.set(i, values[i]);
  return out;
}

constexpr Status kOutOfMemory{Code::outOfMemory};

/// How a call ended: its `status`, to which results are added.
/// @param message  `describe`; empty if all went well.
inline val ending(const Status& status, const std::string& message) {
  val fields = val::object(), out = val::object();
  fields.set("code", std::string(codeName(status.code)));
  fields.set("message", message);
  fields.set("argument", std::string(argumentName(status.argument)));
  fields.set("at", status.at);
  out.set("status", fields);
  return out;
}

/// The arrays of a mesh, copied from JavaScript.
struct Mesh {
  Array<float> positions;
  Array<std::uint32_t> indices;
  Array<float> uvs;
  Array<std::uint32_t> groups;
  Array<float> poses;

  bool copy(const val& mesh) {
    return copyArray(mesh["positions"], positions) && copyArray(mesh["indices"], indices) &&
           copyArray(mesh["uvs"], uvs) && copyArray(mesh["groups"], groups) && copyArray(mesh["poses"], poses);
  }
  [[nodiscard]] MeshView view() const { return {positions, indices, uvs, groups, poses}; }
};

/// Lists of groups, copied from JavaScript.
struct PartArrays {
  Array<std::uint32_t> ignore, keep, exclude;

  /// @param source  What is in it may be missing.
  bool copy(const val& source) {
    return copyArray(source["ignore"], ignore) && copyArray(source["keep"], keep) &&
           copyArray(source["exclude"], exclude);
  }
  [[nodiscard]] Parts view() const { return {ignore, keep, exclude}; }
};

}  // namespace cagecast::bindings
